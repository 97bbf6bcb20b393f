"""Springs, masses and dashpots at ports: energies of known motions and closed-form frequencies."""

import logging
from typing import TypeAlias

import numpy as np
import pytest
from boxes import box, joined, mapped
from scipy.linalg import eigh
from scipy.sparse import csr_array
from solids import system_of

from precompute.arrays import Floats
from precompute.dofs import Dofs, mesh_dofs
from precompute.eigen import solve_modes
from precompute.mesh import Mesh
from precompute.node_table import NodeTable
from precompute.notice import LOGGER_NAME
from precompute.port_elements import element_motion, with_masses, with_springs
from precompute.ports import PortNodes, port_nodes
from precompute.system import System

STIFF = 1e6  # Pa: blocks of 1 m are rigid beside springs of 1 N/m, to 1e-6
DENSITY = 2.0
SIZE = (1.0, 2.0, 3.0)
Ports: TypeAlias = dict[str, PortNodes]


def block(family: str = "hex20") -> tuple[Mesh, System, Ports]:
    """A free stiff block of 12 kg with ports on two opposite faces."""
    mesh = box(family, (1, 1, 1), SIZE)
    return mesh, system_of(mesh, STIFF, 0.3, DENSITY), ends(mesh, 0.0, 1.0)


def ends(mesh: Mesh, a: float, b: float) -> Ports:
    return {
        name: port_nodes(mesh, np.flatnonzero(mesh.points[:, 0] == at), "area", name)
        for name, at in (("a", a), ("b", b))
    }


def row(
    mesh: Mesh, ports: dict[str, PortNodes], port: str, direction: str, to: str | None = None
) -> csr_array:
    return element_motion(ports, port, direction, to, mesh_dofs(len(mesh.points)))


def test_a_free_block_on_a_spring() -> None:
    """ω = √(k/m) along x through the centre of gravity; the other five motions stay rigid modes."""
    mesh, system, ports = block()
    sprung = with_springs(system, [(row(mesh, ports, "a", "x"), 3.0)])
    modes = solve_modes(sprung, np.zeros(0, dtype=np.int64), count=6)
    assert (modes.lam[:5] == 0).all()
    assert modes.lam[5] == pytest.approx(3.0 / 12.0, rel=1e-5)  # beside a block whose own λ is 1e6


def test_a_free_block_on_a_torsion_spring() -> None:
    """ω = √(k/J) about x, J = m (b² + c²)/12."""
    mesh, system, ports = block()
    sprung = with_springs(system, [(row(mesh, ports, "b", "rx"), 5.0)])
    lam = eigh(sprung.K.toarray(), sprung.M.toarray(), eigvals_only=True)
    assert lam[5] == pytest.approx(5.0 / (12.0 * (2.0**2 + 3.0**2) / 12), rel=1e-5)
    assert np.abs(lam[:5]).max() < 1e-7  # five rigid motions, to rounding of λ up to 1e8


def test_two_blocks_on_one_spring() -> None:
    """ω² = k (1/m₁ + 1/m₂) of free masses 12 kg and 24 kg; a port to port spring holds nothing to ground."""
    left, right = box("hex8", (1, 1, 1), SIZE), box("hex8", (2, 1, 1), (2.0, 2.0, 3.0))
    mesh = joined(left, mapped(right, lambda p: p + np.array([1.5, 0, 0])))
    system = system_of(mesh, STIFF, 0.3, DENSITY)
    ports = ends(mesh, 1.0, 1.5)
    sprung = with_springs(system, [(row(mesh, ports, "b", "x", "a"), 3.0)])
    lam = eigh(sprung.K.toarray(), sprung.M.toarray(), eigvals_only=True)
    assert lam[11] == pytest.approx(3.0 * (1 / 12 + 1 / 24), rel=1e-5)
    assert np.abs(lam[:11]).max() < 1e-7
    x = system.rigid[:, 0]
    assert x @ sprung.K @ x == pytest.approx(0, abs=1e-9)


def energy(A: csr_array, u: Floats) -> float:
    return float(u @ (A @ u))


def rigid(mesh: Mesh, t: list[float], theta: list[float]) -> Floats:
    return (np.array(t) + np.cross(theta, mesh.points)).ravel()


def test_strain_energy_of_a_rigid_motion_is_that_of_the_springs() -> None:
    """½ Σ k w² with w the motion of the face's centre (1, 1, 1.5)."""
    mesh, system, ports = block()
    u = rigid(mesh, [0.1, 0.2, 0.3], [0.4, -0.5, 0.6])
    at = np.array([0.1, 0.2, 0.3]) + np.cross([0.4, -0.5, 0.6], [1.0, 1.0, 1.5])
    elements = [("x", 2.0, at[0]), ("z", 3.0, at[2]), ("ry", 5.0, -0.5), ("rz", 7.0, 0.6)]
    sprung = with_springs(system, [(row(mesh, ports, "b", d), k) for d, k, _ in elements])
    wanted = sum(k * w**2 for _, k, w in elements)
    assert energy(sprung.K, u) - energy(system.K, u) == pytest.approx(wanted, rel=1e-6)
    # port to port: the far face's centre lies 1 m away along x
    across = with_springs(
        system, [(row(mesh, ports, "b", "y", "a"), 2.0), (row(mesh, ports, "b", "rz", "a"), 9.0)]
    )
    assert energy(across.K, u) - energy(system.K, u) == pytest.approx(2.0 * 0.6**2, rel=1e-6)


@pytest.mark.parametrize("family", ["hex20", "tet10", "hex8"])
def test_a_mass_moves_with_its_port(family: str) -> None:
    """uᵀMu rises by m |u_port|², and the total mass by m, also where corner weights are negative."""
    mesh, system, ports = block(family)
    heavier = with_masses(system, [(ports["b"], 2.5), (ports["a"], 0.5)], mesh_dofs(len(mesh.points)))
    u = rigid(mesh, [0.1, 0.2, 0.3], [0.4, -0.5, 0.6])
    at = [np.array([0.1, 0.2, 0.3]) + np.cross([0.4, -0.5, 0.6], [x, 1.0, 1.5]) for x in (0.0, 1.0)]
    wanted = 0.5 * at[0] @ at[0] + 2.5 * at[1] @ at[1]
    assert energy(heavier.M, u) - energy(system.M, u) == pytest.approx(wanted, rel=1e-11)
    for axis in range(3):
        assert energy(heavier.M, system.rigid[:, axis]) == pytest.approx(15.0, rel=1e-12)
    assert heavier.K is system.K


def test_sums_are_exactly_symmetric_and_sorted() -> None:
    mesh, system, ports = block()
    elements = [(row(mesh, ports, "b", "rz"), 1 / 3), (row(mesh, ports, "a", "y", "b"), 0.7)]
    sprung = with_springs(system, elements)
    heavier = with_masses(system, [(ports["b"], 1 / 3)], mesh_dofs(len(mesh.points)))
    for A in (sprung.K, heavier.M):
        assert (A != A.T).nnz == 0
        assert A.has_sorted_indices
        assert A.indices.dtype == np.int32
    assert with_springs(system, []).K is system.K


def test_a_mass_stays_where_its_nodes_have_no_dof() -> None:
    """A plane frame without z: the mass moves in x and y only."""
    body = NodeTable(np.array([[0.0, 0, 0], [1, 0, 0]]), np.array([1, 2]))
    plane = Dofs(np.repeat(np.arange(2), 3), np.tile([0, 1, 5], 2))
    empty = csr_array((6, 6))
    heavy = with_masses(
        System(empty, empty, np.zeros((6, 6))),
        [(port_nodes(body, np.array([1]), "equal", "tip"), 4.0)],
        plane,
    )
    np.testing.assert_array_equal(heavy.M.toarray(), np.diag([0, 0, 0, 4.0, 4.0, 0]))


def test_a_port_of_very_many_nodes_is_warned_of(caplog: pytest.LogCaptureFixture) -> None:
    n = 3001
    body = NodeTable(np.zeros((n, 3)), np.arange(n))
    dofs = Dofs(np.arange(n), np.zeros(n, dtype=np.int64))
    wide = port_nodes(body, np.arange(n), "equal", "wide")
    with caplog.at_level(logging.WARNING, LOGGER_NAME):
        w = element_motion({"wide": wide}, "wide", "x", None, dofs)
        with_springs(System(csr_array((n, n)), csr_array((n, n)), np.zeros((n, 6))), [(w, 1.0)])
    assert "couples its 3001 DOFs with each other" in caplog.text
