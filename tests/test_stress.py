"""Stress at ports: constant states on distorted meshes, bars and beams, convergence, two materials."""

import logging

import numpy as np
import pytest
from boxes import box, joined, mapped, steel, straightened
from scipy.sparse.linalg import spsolve

from precompute.arrays import Bools, Floats, Ints
from precompute.assembly import assemble
from precompute.cell_matrices import gradients
from precompute.elements import INTERPOLATIONS, Rule, shape_functions
from precompute.errors import ModalFmuError
from precompute.material import CellMaterial
from precompute.mesh import FAMILIES, Mesh
from precompute.nodal_recovery import RECOVERIES, Recovery
from precompute.notice import LOGGER_NAME
from precompute.stress import stress_rows

YOUNG, NU = 210e9, 0.3  # of boxes.steel
LAMBDA, MU = YOUNG * NU / ((1 + NU) * (1 - 2 * NU)), YOUNG / (2 * (1 + NU))
SOLVED = 1e-10  # rounding of a small direct solve: condition number 1e4 … 1e5 times 1e-16, with a margin
ROUNDING = 1e-12  # gradients of a metre's displacements over cells of a quarter of it


def wavy(p: Floats) -> Floats:
    """Keeps the boundary planes of the unit cube but no cell a parallelepiped."""
    return p + 0.15 * np.prod(np.sin(np.pi * p), axis=1)[:, None] * np.array([1.0, -0.7, 0.5])


def distorted(family: str) -> Mesh:
    return mapped(box(family, (2, 2, 2)), wavy)


def mixed() -> Mesh:
    hexahedra = box("hex8", (1, 2, 2), (0.5, 1.0, 1.0))
    wedges = mapped(box("wedge6", (1, 2, 2), (0.5, 1.0, 1.0)), lambda p: p + np.array([0.5, 0.0, 0.0]))
    return mapped(joined(hexahedra, wedges), wavy)


PATCHES = {**{family: distorted(family) for family in FAMILIES}, "hex8 and wedge6": mixed()}


def equal(nodes: Ints) -> Floats:
    return np.full(len(nodes), 1.0 / len(nodes))


def stress_at(mesh: Mesh, u: Floats, nodes: Ints) -> Floats:
    """xx yy zz xy yz zx of displacements u (n, 3), averaged over the nodes."""
    return stress_rows(mesh, steel(mesh), nodes, equal(nodes)) @ u.ravel()


def voigt(H: Floats) -> Floats:
    """Hooke's law, straight from σ = λ tr(ε) I + 2μ ε."""
    strain = (H + H.T) / 2
    sigma = LAMBDA * np.trace(strain) * np.eye(3) + 2 * MU * strain
    return np.array([sigma[0, 0], sigma[1, 1], sigma[2, 2], sigma[0, 1], sigma[1, 2], sigma[2, 0]])


def mises(s: Floats) -> float:
    xx, yy, zz, xy, yz, zx = s
    shear = xy**2 + yz**2 + zx**2
    return float(np.sqrt(0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) + 3 * shear))


def orders(errors: list[float]) -> Floats:
    """Observed orders between meshes each twice as fine as the one before."""
    return np.log2(np.array(errors[:-1]) / np.array(errors[1:]))


@pytest.mark.parametrize("name", PATCHES)
def test_linear_displacements_have_their_constant_stress_at_every_node_of_distorted_cells(name: str) -> None:
    mesh = PATCHES[name]
    H = np.array([[1.0, 0.3, -0.2], [0.1, -0.4, 0.5], [0.6, 0.2, 0.7]])  # not symmetric: it turns as well
    u = mesh.points @ H.T + np.array([5.0, -3.0, 2.0])
    for node in range(len(mesh.points)):
        found = stress_at(mesh, u, np.array([node]))
        np.testing.assert_allclose(found, voigt(H), atol=ROUNDING * np.abs(voigt(H)).max())


@pytest.mark.parametrize("name", PATCHES)
def test_rigid_motions_have_no_stress(name: str) -> None:
    mesh = PATCHES[name]
    u = np.cross(np.array([0.3, -0.5, 0.8]), mesh.points) + np.array([5.0, -3.0, 2.0])
    nodes = np.arange(len(mesh.points))
    assert np.abs(stress_at(mesh, u, nodes)).max() < ROUNDING * YOUNG


def test_pure_states() -> None:
    mesh = PATCHES["tet10"]
    nodes = np.flatnonzero(mesh.points[:, 0] == 1)
    hydrostatic = stress_at(mesh, 1e-3 * mesh.points, nodes)
    bulk = YOUNG / (3 * (1 - 2 * NU))
    np.testing.assert_allclose(hydrostatic[:3], 3e-3 * bulk, rtol=ROUNDING)
    assert mises(hydrostatic) < ROUNDING * hydrostatic[0]
    sheared = np.zeros(mesh.points.shape)
    sheared[:, 0] = 1e-3 * mesh.points[:, 1]
    shear = stress_at(mesh, sheared, nodes)
    assert shear[3] == pytest.approx(MU * 1e-3, rel=ROUNDING)
    assert mises(shear) == pytest.approx(np.sqrt(3) * MU * 1e-3, rel=ROUNDING)


def solved(mesh: Mesh, materials: list[CellMaterial], free: Bools, u: Floats, F: Floats) -> Floats:
    """K u = F in the free DOFs, u given in the others: (n, 3)."""
    K = assemble(mesh, materials).K
    free = free.ravel()
    x = u.ravel().copy()
    x[free] = spsolve(K[free][:, free].tocsc(), F.ravel()[free] - K[free][:, ~free] @ x[~free])
    return x.reshape(-1, 3)


@pytest.mark.parametrize("family", FAMILIES)
def test_bar_under_tension_has_f_over_a(family: str) -> None:
    """Held statically determinate, one end pulled: σ_xx = F/A = E ε everywhere."""
    mesh = mapped(box(family, (2, 2, 2)), wavy)
    if family in ("tet10", "hex20r"):
        mesh = straightened(mesh, family)  # exact only where the rule of K is
    mesh = mapped(mesh, lambda p: p * np.array([2.0, 0.5, 0.25]))
    x = mesh.points
    free = np.ones(x.shape, dtype=np.bool_)
    free[:, 0] = (x[:, 0] > 0) & (x[:, 0] < 2)
    free[(x == 0).all(axis=1)] = False
    free[np.argmin(np.abs(x - [0.0, 0.5, 0.0]).sum(axis=1)), 2] = False
    strain = 1e-4
    u = np.zeros(x.shape)
    u[x[:, 0] == 2, 0] = 2 * strain
    u = solved(mesh, steel(mesh), free, u, np.zeros(x.shape))
    for nodes in (np.flatnonzero(x[:, 0] == 2), np.array([3]), np.arange(len(x))):
        found = stress_at(mesh, u, nodes)
        np.testing.assert_allclose(found, [YOUNG * strain, 0, 0, 0, 0, 0], atol=SOLVED * YOUNG * strain)


LENGTH, CURVATURE = 4.0, 1e-3


def bending(p: Floats) -> Floats:
    """Saint-Venant's pure bending of the beam [0, 4] × [0, 1]²: σ_xx = E κ y from the middle, others 0."""
    x, y, z = (p - np.array([0.0, 0.5, 0.5])).T
    return CURVATURE * np.stack([x * y, -(x**2 + NU * (y**2 - z**2)) / 2, -NU * y * z], axis=1)


def top_of(mesh: Mesh) -> Ints:
    """The nodes in the middle of the upper fibre, y = ½ from the axis: M y / I = E κ / 2."""
    x, y = mesh.points[:, 0], mesh.points[:, 1]
    return np.flatnonzero((np.abs(x - LENGTH / 2) < 1e-9) & (y > 1 - 1e-9))


def beam_error(mesh: Mesh, components: slice) -> float:
    """Of the stress in the upper fibre, both ends bent by the exact displacements, relative to E κ / 2."""
    ends = (mesh.points[:, 0] < 1e-9) | (mesh.points[:, 0] > LENGTH - 1e-9)
    free = np.repeat(~ends[:, None], 3, axis=1)
    u = solved(mesh, steel(mesh), free, bending(mesh.points), np.zeros(mesh.points.shape))
    exact = np.array([YOUNG * CURVATURE / 2, 0, 0, 0, 0, 0])
    return float(np.abs(stress_at(mesh, u, top_of(mesh)) - exact)[components].max() / exact[0])


@pytest.mark.parametrize("family", ["tet10", "hex20", "hex20r"])
def test_quadratic_cells_have_the_exact_stress_of_a_beam(family: str) -> None:
    assert beam_error(box(family, (4, 1, 1), (LENGTH, 1.0, 1.0)), slice(None)) < SOLVED


@pytest.mark.parametrize(
    ("family", "coarse"), [("tet4", 0.3), ("wedge6", 0.4), ("hex8", 0.1), ("hex8r", 0.1)]
)
def test_stress_of_a_beam_of_linear_cells_converges_with_order_1(family: str, coarse: float) -> None:
    """The linear part of the strain is not complete within a cell: O(h) at a surface."""
    errors = [beam_error(box(family, (4 * n, n, n), (LENGTH, 1.0, 1.0)), slice(0, 1)) for n in (2, 4, 8)]
    assert errors[0] < coarse  # two cells over the height; a mean per cell has 0.5 in hexahedra
    assert orders(errors)[-1] == pytest.approx(1.0, abs=0.1)


def at_nodes(family: str) -> Recovery:
    """The other choice: the gradients of the cells' own functions at the nodes."""
    base = family.removesuffix("r")
    nodes = INTERPOLATIONS[base].nodes
    N, dN = shape_functions(base, nodes)
    return Recovery(Rule(N, dN, np.full(len(nodes), 1.0)), np.eye(len(nodes)))


def potential(p: Floats) -> tuple[Floats, Floats]:
    """u = ∇φ with Δφ = 0: in equilibrium without loads for every λ, μ; and H at the points, (n, 3, 3)."""
    k = np.array([1.0, 1.0, np.sqrt(2.0)])
    x, y, z = (k * p).T
    c, d = (np.cos(x), -np.sin(x)), (np.cos(y), -np.sin(y))
    e = np.exp(z)
    first = np.stack([c[1] * d[0] * e, c[0] * d[1] * e, c[0] * d[0] * e], axis=1)
    second = np.array(
        [
            [-c[0] * d[0] * e, c[1] * d[1] * e, c[1] * d[0] * e],
            [c[1] * d[1] * e, -c[0] * d[0] * e, c[0] * d[1] * e],
            [c[1] * d[0] * e, c[0] * d[1] * e, c[0] * d[0] * e],
        ]
    )
    return k * first, np.moveaxis(second, 2, 0) * np.outer(k, k)


def mean_square_error(family: str, count: int) -> float:
    """Of the stress at all nodes of the distorted unit cube, whose surface follows `potential`."""
    mesh = mapped(box(family, (count, count, count)), lambda p: p + (wavy(p) - p) / 1.5)
    u, H = potential(mesh.points)
    inside = ((mesh.points > 1e-9) & (mesh.points < 1 - 1e-9)).all(axis=1)
    u = solved(mesh, steel(mesh), np.repeat(inside[:, None], 3, axis=1), u, np.zeros(u.shape))
    exact = np.array([voigt(h) for h in H])
    found = np.array([stress_at(mesh, u, np.array([node])) for node in range(len(u))])
    return float(np.sqrt(np.mean((found - exact) ** 2)) / np.abs(exact).max())


@pytest.mark.parametrize("family", ["tet10", "hex20", "hex20r"])
def test_stress_of_quadratic_cells_converges_with_order_2(family: str) -> None:
    assert orders([mean_square_error(family, count) for count in (2, 4)])[0] > 1.8  # towards 2


@pytest.mark.parametrize("family", ["hex20", "hex20r"])
def test_the_recovery_is_more_accurate_than_the_cells_own_gradients(
    family: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    best = mean_square_error(family, 2)
    monkeypatch.setitem(RECOVERIES, family, at_nodes(family))
    assert mean_square_error(family, 2) > 1.3 * best


@pytest.mark.parametrize("family", [family for family in FAMILIES if not family.startswith("hex20")])
def test_elsewhere_it_is_the_gradient_of_the_cells_own_functions_where_edges_are_straight(
    family: str,
) -> None:
    mesh = mapped(
        box(family, (1, 1, 1)), lambda p: p @ np.array([[1.0, 0.1, 0.2], [0.3, 1.1, 0], [0, 0.2, 0.9]])
    )
    own, recovery = at_nodes(family), RECOVERIES[family]
    x = mesh.points[mesh.cells[family]]
    expected, _ = gradients(x, own.rule)
    G, _ = gradients(x, recovery.rule)
    found = np.einsum("as,csbi->cabi", recovery.extrapolation, G)
    np.testing.assert_allclose(found, expected, atol=ROUNDING * np.abs(expected).max())


def test_weights_average_over_the_nodes() -> None:
    """Bending is linear in y: with weights w the stress is that at Σ w y."""
    mesh = box("hex20", (4, 1, 1), (LENGTH, 1.0, 1.0))
    u = bending(mesh.points).ravel()
    nodes = np.flatnonzero(mesh.points[:, 0] == 0)
    weights = np.arange(1.0, len(nodes) + 1)
    weights /= weights.sum()
    found = stress_rows(mesh, steel(mesh), nodes, weights) @ u
    place = weights @ (mesh.points[nodes, 1] - 0.5)
    assert found[0] == pytest.approx(YOUNG * CURVATURE * place, rel=1e-10)


def two_materials() -> tuple[Mesh, list[CellMaterial]]:
    """A bar of two halves in series, nodes of both at x = ½."""
    mesh = box("hex8", (4, 1, 1), (1.0, 0.5, 0.5))
    middle = mesh.points[mesh.cells["hex8"]].mean(axis=1)[:, 0]
    return mesh, [
        CellMaterial("soft", 1e9, 0.0, 1000.0, {"hex8": np.flatnonzero(middle < 0.5)}),
        CellMaterial("stiff", 4e9, 0.0, 3000.0, {"hex8": np.flatnonzero(middle > 0.5)}),
    ]


def test_one_material_counts_where_two_meet(caplog: pytest.LogCaptureFixture) -> None:
    """Equal strain in both halves, so that the stress jumps from 1 to 4 MPa; the mean would be 2.5."""
    caplog.set_level(logging.INFO, logger=LOGGER_NAME)
    mesh, (soft, stiff) = two_materials()
    u = mesh.points * np.array([1e-3, 0.0, 0.0])
    x = mesh.points[:, 0]
    interface = np.flatnonzero(x == 0.5)

    def axial(nodes: Ints, materials: list[CellMaterial]) -> float:
        return float((stress_rows(mesh, materials, nodes, equal(nodes)) @ u.ravel())[0])

    assert axial(interface, [soft, stiff]) == pytest.approx(1e6, rel=ROUNDING)
    assert axial(interface, [stiff, soft]) == pytest.approx(4e6, rel=ROUNDING)
    assert caplog.text.count("the materials soft, stiff meet at a port") == 1
    caplog.clear()
    # more of the port's nodes are in the stiff half: it counts at the interface too, whatever the order
    mostly_stiff = np.flatnonzero((x >= 0.5) & (mesh.points[:, 1] == 0))
    for materials in ([soft, stiff], [stiff, soft]):
        assert axial(mostly_stiff, materials) == pytest.approx(4e6, rel=ROUNDING)
    caplog.clear()
    assert axial(np.flatnonzero(x < 0.4), [soft, stiff]) == pytest.approx(1e6, rel=ROUNDING)
    assert not caplog.records


def test_a_port_across_materials_takes_each_node_s_own() -> None:
    mesh, materials = two_materials()
    u = mesh.points * np.array([1e-3, 0.0, 0.0])
    nodes = np.flatnonzero((mesh.points[:, 0] == 0) | (mesh.points[:, 0] == 1))
    found = stress_rows(mesh, materials, nodes, equal(nodes)) @ u.ravel()
    assert found[0] == pytest.approx(2.5e6, rel=ROUNDING)


def test_rows_touch_the_cells_at_the_port_only() -> None:
    mesh = box("tet10", (6, 1, 1), (6.0, 1.0, 1.0))
    nodes = np.flatnonzero(mesh.points[:, 0] == 0)
    S = stress_rows(mesh, steel(mesh), nodes, equal(nodes))
    assert S.shape == (6, 3 * len(mesh.points))
    assert mesh.points[np.unique(S.indices) // 3, 0].max() == 1.0


def test_refuses_negative_weights() -> None:
    mesh = box("tet4", (1, 1, 1))
    with pytest.raises(ModalFmuError, match="expected weights ≥ 0"):
        stress_rows(mesh, steel(mesh), np.array([0, 1]), np.array([1.5, -0.5]))
