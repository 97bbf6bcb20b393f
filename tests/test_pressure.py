"""Nodal forces of a pressure: resultants, curved faces, and the deformation that it causes."""

import numpy as np
import pytest
from boxes import box, mapped
from solids import system_of
from systems import hollow_sphere

from precompute.arrays import Floats, Ints
from precompute.dofs import Dofs, mesh_dofs
from precompute.errors import PartError
from precompute.mesh import FAMILIES, Mesh
from precompute.ports import port_nodes
from precompute.pressure import pressure_load
from precompute.statics import static_solver


def forces(mesh: Mesh, nodes: Ints) -> Floats:
    """Of 1 Pa on the whole faces between the nodes, (n, 3)."""
    port = port_nodes(mesh, nodes, "equal", "wall")
    return pressure_load(port, mesh, mesh_dofs(len(mesh.points))).reshape(-1, 3)


def bent(p: Floats) -> Floats:
    x, y, z = p.T
    return np.stack([x + 0.1 * np.sin(2 * y), y + 0.1 * z**2 + 0.1 * x * z, z + 0.1 * np.cos(2 * x)], axis=1)


@pytest.mark.parametrize("family", FAMILIES)
def test_on_a_flat_face_it_is_pressure_times_area_into_the_body(family: str) -> None:
    mesh = box(family, (2, 2, 2), (2.0, 3.0, 5.0))
    F = forces(mesh, np.flatnonzero(mesh.points[:, 2] == 5.0))
    np.testing.assert_allclose(F.sum(axis=0), [0, 0, -6.0], atol=1e-13)
    np.testing.assert_allclose(np.cross(mesh.points, F).sum(axis=0), [-9.0, 6.0, 0], atol=1e-12)  # x̄ × F
    assert not F[mesh.points[:, 2] < 5.0].any()


@pytest.mark.parametrize("family", FAMILIES)
def test_on_a_closed_surface_it_has_no_resultant_and_no_moment(family: str) -> None:
    mesh = mapped(box(family, (2, 1, 2)), bent)
    F = forces(mesh, np.arange(len(mesh.points)))
    np.testing.assert_allclose(F.sum(axis=0), 0, atol=1e-14)
    np.testing.assert_allclose(np.cross(mesh.points, F).sum(axis=0), 0, atol=1e-14)
    assert np.abs(F).max() > 0.01


def sphere(p: Floats) -> Floats:
    """The sixth of a ball's shell around z, radius 1 … 2."""
    t = np.tan(np.pi / 2 * (p[:, :2] - 0.5))
    direction = np.column_stack([t, np.ones(len(p))])
    return (1 + p[:, 2:]) * direction / np.linalg.norm(direction, axis=1)[:, None]


@pytest.mark.parametrize(("family", "order"), [("tet4", 2), ("hex8", 2), ("tet10", 4), ("hex20", 4)])
def test_on_a_sphere_its_virial_converges(family: str, order: int) -> None:
    """Σ x·F = −∮ x·n dA = −R A on a sixth of a sphere of radius 2."""
    exact = -2.0 * (4 * np.pi * 2.0**2 / 6)
    errors = []
    for count in (4, 8):
        shape = box(family, (count, count, 1))
        mesh = mapped(shape, sphere)
        F = forces(mesh, np.flatnonzero(shape.points[:, 2] == 1.0))
        errors.append(abs((mesh.points * F).sum() / exact - 1))
    assert np.log2(errors[0] / errors[1]) > order - 0.3
    assert errors[1] < (0.02 if order == 2 else 1e-4)


def slanted(p: Floats) -> Floats:
    return p @ np.array([[1, 0.2, 0], [0, 2, 0.1], [0.3, 0, 1]])


@pytest.mark.parametrize("family", FAMILIES)
def test_hydrostatic_pressure_compresses_exactly(family: str) -> None:
    """K u = F for u = −p (1 − 2ν)/E x: a patch test of the loads.

    On curved sides too where K is integrated exactly there (not by the rule of tet10, nor by reduced ones).
    """
    young, poisson = 2.0, 0.3
    for shape in (slanted, bent) if family in ("tet4", "wedge6", "hex8", "hex20") else (slanted,):
        mesh = mapped(box(family, (2, 2, 2)), shape)
        u = -(1 - 2 * poisson) / young * mesh.points
        F = forces(mesh, np.arange(len(mesh.points)))
        Ku = (system_of(mesh, young, poisson, 1.0).K @ u.ravel()).reshape(-1, 3)
        np.testing.assert_allclose(Ku, F, atol=1e-13)
        assert np.abs(F).max() > 0.01


def test_a_hollow_sphere_widens_as_lame_says() -> None:
    """u(r) = p a³ ((1 − 2ν) r + (1 + ν) b³/(2 r²)) / (E (b³ − a³)) under a pressure p inside."""
    a, b, young, poisson = 2.7, 3.0, 2.0, 0.3
    errors = []
    for cells in (2, 4):
        mesh = hollow_sphere(cells, a, b)
        r = np.linalg.norm(mesh.points, axis=1)
        system = system_of(mesh, young, poisson, 1.0)
        F = forces(mesh, np.flatnonzero(np.isclose(r, a)))
        with static_solver(system, np.zeros(0, dtype=np.int64)) as solve:
            u = solve(F.reshape(-1, 1)).reshape(-1, 3)
        radial = (u * mesh.points).sum(axis=1) / r
        exact = a**3 * ((1 - 2 * poisson) * r + (1 + poisson) * b**3 / (2 * r**2)) / (young * (b**3 - a**3))
        inside = np.isclose(r, a)
        errors.append(abs(radial[inside].mean() / exact[inside].mean() - 1))
    # (t/a)² = 1 % of one cell through the wall t is what more cells around cannot mend
    assert errors[1] < errors[0]
    assert errors[1] < 0.01


def test_a_port_without_a_whole_face_takes_no_pressure() -> None:
    mesh = box("hex8", (1, 1, 1))
    with pytest.raises(PartError, match="port wall: got a pressure, but its nodes cover no whole"):
        forces(mesh, np.array([0, 1, 2]))


def test_what_pushes_held_nodes_is_the_supports() -> None:
    """Matrices from which a support has taken the DOFs of the nodes at x = 0."""
    mesh = box("hex8", (1, 1, 1))
    top = port_nodes(mesh, np.flatnonzero(mesh.points[:, 2] == 1), "area", "top")
    all_dofs = mesh_dofs(len(mesh.points))
    left = mesh.points[all_dofs.node, 0] > 0
    F = pressure_load(top, mesh, Dofs(all_dofs.node[left], all_dofs.direction[left]))
    np.testing.assert_array_equal(F, pressure_load(top, mesh, all_dofs)[left])
    assert F.sum() == pytest.approx(-0.5, rel=1e-14)
