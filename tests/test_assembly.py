"""Patch test, rigid motions, mass, convergence orders, published frequencies, and what must be refused."""

from dataclasses import replace

import numpy as np
import pytest
from boxes import box, joined, mapped, mesh_of, steel, straightened
from scipy.optimize import brentq
from scipy.sparse import csr_array
from scipy.sparse.linalg import eigsh, spsolve
from skfem import BilinearForm, CellBasis, MeshHex, MeshTet
from skfem.element import ElementHex1, ElementTetP2
from skfem.helpers import dot

from precompute.arrays import Bools, Floats, Ints
from precompute.assembly import assemble
from precompute.elements import ELEMENTS
from precompute.errors import MeshError
from precompute.material import CellMaterial
from precompute.mesh import FAMILIES, Mesh
from precompute.system import System

SOLVED = 1e-10  # rounding of a small direct solve: condition number 1e4 … 1e5 times 1e-16, with a margin


def wavy(amount: float):
    """A smooth map that keeps the boundary planes of the unit cube but no cell a parallelepiped."""

    def f(p: Floats) -> Floats:
        bump = np.prod(np.sin(np.pi * p), axis=1)[:, None]
        return p + amount * bump * np.array([1.0, -0.7, 0.5])

    return f


def distorted(family: str) -> Mesh:
    """2 × 2 × 2 cubes of a family with the middle moved; straight edges where the rule needs them."""
    mesh = mapped(box(family, (2, 2, 2)), wavy(0.15))
    return straightened(mesh, family) if family in ("tet10", "hex20r") else mesh


def mixed() -> Mesh:
    hexahedra = box("hex8", (1, 2, 2), (0.5, 1.0, 1.0))
    wedges = mapped(box("wedge6", (1, 2, 2), (0.5, 1.0, 1.0)), lambda p: p + np.array([0.5, 0.0, 0.0]))
    return mapped(joined(hexahedra, wedges), wavy(0.15))


PATCHES = {**{family: distorted(family) for family in FAMILIES}, "hex8 and wedge6": mixed()}


def error_of_constant_strain(mesh: Mesh) -> float:
    """Largest error inside when the boundary of the unit cube follows u = A p, relative to the largest u."""
    K = assemble(mesh, steel(mesh)).K
    u = (mesh.points @ np.array([[1.0, 0.3, -0.2], [0.1, -0.4, 0.5], [0.6, 0.2, 0.7]])).ravel()
    inside = np.repeat(((mesh.points > 1e-9) & (mesh.points < 1 - 1e-9)).all(axis=1), 3)
    assert inside.any()
    found = spsolve(K[inside][:, inside].tocsc(), -(K[inside][:, ~inside] @ u[~inside]))
    return float(np.abs(found - u[inside]).max() / np.abs(u).max())


@pytest.mark.parametrize("name", PATCHES)
def test_patch_of_distorted_cells_keeps_constant_strain(name: str) -> None:
    assert error_of_constant_strain(PATCHES[name]) < SOLVED


def test_the_patch_test_sees_a_pair_of_exchanged_mid_edge_nodes() -> None:
    mesh = distorted("hex20")
    cells = mesh.cells["hex20"].copy()
    cells[0, [17, 18]] = cells[0, [18, 17]]
    try:
        assert error_of_constant_strain(mesh_of(mesh.points, {"hex20": cells})) > 1e-3
    except MeshError as error:
        assert "det J" in str(error)  # noqa: PT017, either way of seeing it is right


@pytest.mark.parametrize("name", PATCHES)
def test_rigid_motions_have_no_strain_energy_and_the_bodys_inertia(name: str) -> None:
    mesh = (
        straightened(PATCHES[name], name) if name == "hex20" else PATCHES[name]
    )  # curved: inertia not exact
    system = assemble(mesh, steel(mesh))
    # rounding of the sums of some 100 entries per row
    assert np.abs(system.K @ system.rigid).max() < 1e-14 * 100 * np.abs(system.K.data).max()
    # unit cube: mass ρ, moments of inertia ρ (1 + 1)/12 about its centre, moved to the mean of the points
    inertia = system.rigid.T @ (system.M @ system.rigid) / 7850.0
    away = 0.5 - mesh.points.mean(axis=0)
    steiner = np.eye(3) * (away @ away) - np.outer(away, away)
    np.testing.assert_allclose(inertia[:3, :3], np.eye(3), atol=1e-12)
    np.testing.assert_allclose(inertia[3:, 3:], np.eye(3) / 6 + steiner, atol=1e-12)
    assert system.M.sum() == pytest.approx(3 * 7850.0, rel=1e-12)


def oracle(basis: CellBasis, lam: float, mu: float, density: float) -> tuple[Floats, Floats]:
    """K and M by scikit-fem's own assembly, one pair of directions at a time: DOF 3·node + direction."""
    n = basis.N
    K, M = np.zeros((n, 3, n, 3)), np.zeros((n, 3, n, 3))
    for i in range(3):
        M[:, i, :, i] = BilinearForm(lambda u, v, w: density * u * v).assemble(basis).toarray()
        for j in range(3):

            @BilinearForm
            def form(u, v, w, i=i, j=j):  # test function v in direction i, u in direction j
                coupled = lam * v.grad[i] * u.grad[j] + mu * v.grad[j] * u.grad[i]
                return coupled + (i == j) * mu * dot(u.grad, v.grad)

            K[:, i, :, j] = form.assemble(basis).toarray()
    return K.reshape(3 * n, 3 * n), M.reshape(3 * n, 3 * n)


def skfem_mesh(kind: type[MeshTet] | type[MeshHex]) -> MeshTet | MeshHex:
    mesh = kind().refined(1)
    return replace(mesh, doflocs=wavy(0.1)(mesh.doflocs.T).T)


def assert_same_matrices(cells: dict[str, Ints], K_basis: CellBasis, M_basis: CellBasis) -> None:
    mesh = mesh_of(K_basis.doflocs.T, cells)
    material = steel(mesh)[0]
    system = assemble(mesh, [material])
    K, _ = oracle(K_basis, material.lam, material.mu, material.density)
    _, M = oracle(M_basis, material.lam, material.mu, material.density)
    np.testing.assert_allclose(system.K.toarray(), K, atol=1e-12 * np.abs(K).max())
    np.testing.assert_allclose(system.M.toarray(), M, atol=1e-12 * np.abs(M).max())


def test_tet10_has_the_matrices_of_scikit_fem() -> None:
    # every sufficient order is exact on straight tetrahedra: the oracle takes a higher one
    basis = CellBasis(skfem_mesh(MeshTet), ElementTetP2(), intorder=6)
    nodes = basis.element_dofs.T.astype(np.int64)
    edges = basis.doflocs.T[nodes[:, 1:4]] - basis.doflocs.T[nodes[:, :1]]
    mirrored = np.linalg.det(edges) < 0  # scikit-fem sorts the corners, whatever their turn
    nodes[mirrored] = nodes[mirrored][:, [0, 2, 1, 3, 6, 5, 4, 7, 9, 8]]
    assert_same_matrices({"tet10": nodes}, basis, basis)


def test_hex8_has_the_matrices_of_scikit_fem() -> None:
    # on distorted hexahedra K is defined by its 2 × 2 × 2 points (order 3)
    K_basis, M_basis = (CellBasis(skfem_mesh(MeshHex), ElementHex1(), intorder=order) for order in (3, 5))
    # corners of MeshHex(): 000 001 010 100 011 101 110 111
    nodes = K_basis.element_dofs[[0, 3, 6, 2, 1, 5, 7, 4]].T.astype(np.int64)
    assert_same_matrices({"hex8": nodes}, K_basis, M_basis)


def lowest(system: System, free: Bools, count: int = 1) -> Floats:
    """The lowest eigenvalues λ of K φ = λ M φ in the free DOFs, K definite."""
    K, M = (A[free][:, free].tocsc() for A in (system.K, system.M))
    start = np.ones(K.shape[0])
    return np.sort(eigsh(K, M=M, k=count, sigma=0.0, v0=start, return_eigenvectors=False))


def orders(errors: list[float]) -> Floats:
    """Observed orders between meshes each twice as fine as the one before."""
    return np.log2(np.array(errors[:-1]) / np.array(errors[1:]))


@pytest.mark.parametrize(
    ("family", "order", "counts"),
    [
        *((family, 2, (2, 4, 8)) for family in ("tet4", "wedge6", "hex8", "hex8r")),
        *((family, 4, (1, 2, 4)) for family in ("hex20", "hex20r")),
        ("tet10", 4, (2, 4, 8)),
    ],
)
def test_eigenvalue_of_a_bar_converges_with_twice_the_order_of_the_strain(
    family: str, order: int, counts: tuple[int, ...]
) -> None:
    """u = sin(πx/2) e_x with ν = 0: λ = E/ρ (π/2)². Its error is quadratic in that of the strain, h^p."""
    errors = []
    for count in counts:
        mesh = box(family, (count, count, count))
        free = np.zeros(mesh.points.shape, dtype=np.bool_)
        free[:, 0] = mesh.points[:, 0] > 0
        found = lowest(assemble(mesh, steel(mesh, poisson=0.0)), free.ravel())[0]
        errors.append(found / (210e9 / 7850.0 * (np.pi / 2) ** 2) - 1)
    assert errors[-1] > 0  # Rayleigh quotients over fewer functions are too high
    # these are not yet the finest meshes, but far from any other whole order
    assert orders(errors)[-1] == pytest.approx(order, abs=0.15)


# NAFEMS FV42: radial modes of a thick hollow sphere
INNER, OUTER, YOUNG, NU, RHO = 1.8, 6.0, 200e9, 0.3, 8000.0


def sphere_sector(p: Floats) -> Floats:
    """The unit cube to a sector of the sphere, z along the radius; all cells are curved."""
    t = np.tan(np.pi / 4 * p)
    direction = np.stack([t[:, 0], t[:, 1], np.ones(len(p))], axis=1)
    radius = INNER + (OUTER - INNER) * p[:, 2]
    return radius[:, None] * direction / np.linalg.norm(direction, axis=1)[:, None]


def exact_radial_frequency(near: float) -> float:
    """u = ∂φ/∂r, φ = (A sin kr + B cos kr)/r, with σ_r = (λ+2μ) u' + 2λ u/r = 0 on both spheres."""
    steel_ball = CellMaterial("steel", YOUNG, NU, RHO, {})
    lam, mu = steel_ball.lam, steel_ball.mu

    def traction(k: float, r: float) -> list[float]:
        e = np.exp(1j * k * r)
        slope = (1j * k * r - 1) * e / r**2
        curvature = -(k**2) * e / r - 2 * slope / r
        sigma = (lam + 2 * mu) * curvature + 2 * lam * slope / r
        return [sigma.real, sigma.imag]

    def determinant(f: float) -> float:
        k = 2 * np.pi * f * np.sqrt(RHO / (lam + 2 * mu))
        return float(np.linalg.det([traction(k, INNER), traction(k, OUTER)]))

    return float(brentq(determinant, 0.99 * near, 1.01 * near))


def radial_frequency(mesh: Mesh, near: float) -> float:
    """Of purely radial motions u_a = s_a r̂_a: they hold the exact mode, and leave the sector's sides free."""
    system = assemble(mesh, [replace(steel(mesh)[0], young=YOUNG, poisson=NU, density=RHO)])
    n = len(mesh.points)
    r = mesh.points / np.linalg.norm(mesh.points, axis=1)[:, None]
    radial = csr_array((r.ravel(), np.repeat(np.arange(n), 3), np.arange(3 * n + 1)), shape=(3 * n, n))
    K, M = ((radial.T @ A @ radial).tocsc() for A in (system.K, system.M))
    lam = eigsh(K, M=M, k=1, sigma=(2 * np.pi * near) ** 2, v0=np.ones(n), return_eigenvectors=False)
    return float(np.sqrt(lam[0]) / (2 * np.pi))


@pytest.mark.parametrize("published", [369.94, 838.03])
def test_hollow_sphere_has_its_published_radial_frequencies(published: float) -> None:
    exact = exact_radial_frequency(published)
    assert exact == pytest.approx(published, abs=0.005)  # as many digits as are published
    found = radial_frequency(mapped(box("hex20", (4, 4, 8)), sphere_sector), published)
    assert found == pytest.approx(exact, rel=2e-4)


@pytest.mark.parametrize("family", ["tet10", "hex20"])
def test_curved_cells_keep_the_fourth_order_and_straight_ones_lose_it(family: str) -> None:
    exact = exact_radial_frequency(369.94)
    curved, straight = [], []
    for n in (2, 4, 8):
        mesh = mapped(box(family, (n // 2, n // 2, n)), sphere_sector)
        curved.append(radial_frequency(mesh, exact) / exact - 1)
        straight.append(radial_frequency(straightened(mesh, family), exact) / exact - 1)
    assert orders(curved)[-1] > 3.4  # towards 4
    assert orders(straight)[-1] < 2.3  # the polyhedron is wrong by h²


# CalculiX's test beamdy1: clamped, 1 × 1.5 × 8 mm, 32 C3D20R, E 210 GPa, ν 0.3, ρ 7800 kg/m³
BEAMDY1 = np.array([13096.03, 19319.52, 76839.71, 86955.23, 105963.6, 162998.5, 197645.0])


def beam_frequencies(family: str) -> Floats:
    mesh = box(family, (2, 2, 8), (1e-3, 1.5e-3, 8e-3))
    system = assemble(mesh, [replace(steel(mesh)[0], density=7800.0)])
    free = np.repeat(mesh.points[:, 2] > 0, 3)
    return np.sqrt(lowest(system, free, len(BEAMDY1))) / (2 * np.pi)


def test_frequencies_of_the_calculix_beam_with_reduced_integration() -> None:
    found = beam_frequencies("hex20r")
    np.testing.assert_allclose(found[:6], BEAMDY1[:6], rtol=1e-4)
    # CalculiX takes 2 × 2 × 2 points for M also, which matters more for higher modes (see the next test)
    np.testing.assert_allclose(found[6], BEAMDY1[6], rtol=1e-3)
    # K by all points is another, stiffer element: the agreement above tells them apart
    assert (beam_frequencies("hex20")[:6] > 1.001 * BEAMDY1[:6]).all()


def test_the_same_beam_to_all_printed_digits_by_its_own_rule(monkeypatch: pytest.MonkeyPatch) -> None:
    reduced = ELEMENTS["hex20r"]
    monkeypatch.setitem(ELEMENTS, "hex20r", replace(reduced, mass=reduced.stiffness))
    np.testing.assert_allclose(beam_frequencies("hex20r"), BEAMDY1, rtol=5e-7)  # seven digits are printed


def test_two_materials_in_series() -> None:
    """u = F/A (L₁/E₁ + L₂/E₂) at the end of a bar with ν = 0, linear in each part: exact."""
    mesh = box("hex8", (4, 1, 1), (1.0, 0.5, 0.5))
    middle = mesh.points[mesh.cells["hex8"]].mean(axis=1)[:, 0]
    soft = CellMaterial("soft", 1e9, 0.0, 1000.0, {"hex8": np.flatnonzero(middle < 0.5)})
    stiff = CellMaterial("stiff", 4e9, 0.0, 3000.0, {"hex8": np.flatnonzero(middle > 0.5)})
    system = assemble(mesh, [stiff, soft])
    x = mesh.points[:, 0]
    free = np.repeat(x > 0, 3)
    F = np.zeros((len(x), 3))
    F[x == 1, 0] = 1e6 * 0.25 / 4  # N: 1 MPa, shared by the four nodes of the one square face
    u = np.zeros(3 * len(x))
    u[free] = spsolve(system.K[free][:, free].tocsc(), F.ravel()[free])
    exact = 1e6 * (np.minimum(x, 0.5) / 1e9 + np.maximum(x - 0.5, 0) / 4e9)
    np.testing.assert_allclose(u.reshape(-1, 3)[:, 0], exact, atol=SOLVED * exact.max())
    assert system.M.sum() / 3 == pytest.approx(0.125 * 1000 + 0.125 * 3000, rel=1e-12)


def test_matrices_are_symmetric_to_the_last_bit_sorted_and_the_same_each_time() -> None:
    apart = mapped(box("tet4", (1, 1, 1)), lambda p: p + np.array([0.0, 0.0, 2.0]))
    mesh = joined(PATCHES["hex8 and wedge6"], apart)
    first, second = assemble(mesh, steel(mesh)), assemble(mesh, steel(mesh))
    for name in ("K", "M"):
        A, B = getattr(first, name), getattr(second, name)
        assert isinstance(A, csr_array)
        assert A.indices.dtype == A.indptr.dtype == np.int32
        assert A.has_canonical_format
        assert (A != A.T).nnz == 0
        np.testing.assert_array_equal(A.data, B.data)


def test_cells_and_nodes_may_be_numbered_in_any_order() -> None:
    mesh = distorted("tet10")
    n, c = len(mesh.points), len(mesh.cells["tet10"])
    rng = np.random.default_rng(5)
    node, cell = rng.permutation(n), rng.permutation(c)
    points = np.empty_like(mesh.points)
    points[node] = mesh.points
    other = mesh_of(points, {"tet10": node[mesh.cells["tet10"]][cell]})
    dof = (3 * node[:, None] + np.arange(3)).ravel()
    K, shuffled = (assemble(m, steel(m)).K for m in (mesh, other))
    difference = shuffled[dof][:, dof] - K
    assert np.abs(difference.data).max() < 1e-14 * np.abs(K.data).max()  # sums in another order


def test_progress_rises_to_one_in_at_most_a_hundred_calls() -> None:
    mesh = box("hex20", (5, 5, 5))
    # 125 materials of one cell each: no fewer blocks of cells than that
    materials = [replace(steel(mesh)[0], cells={"hex20": np.array([cell])}) for cell in range(125)]
    seen: list[float] = []
    assemble(mesh, materials, seen.append)
    assert 10 < len(seen) <= 100
    assert (np.diff(seen) > 0).all()
    assert seen[-1] == 1.0
