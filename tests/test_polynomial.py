"""Polynomial fields: which they are, what energy they have, which of them supports leave."""

from itertools import product

import numpy as np
import pytest
from bodies import BAR, MESH, SIZE, SUPPORTS, P
from boxes import box, mapped, steel
from systems import dofs_where, system_of

from precompute.arrays import Floats
from precompute.assembly import assemble
from precompute.dofs import Dofs, mesh_dofs
from precompute.errors import EigenError
from precompute.polynomial import polynomial_fields, vanishing_at_supports
from precompute.rigid import rigid_modes
from precompute.ritz import reduced_modes
from precompute.system import rigid_motions

DOFS = mesh_dofs(len(P))
NONE = SUPPORTS["free"]
POWERS = np.array([e for e in product(range(4), repeat=3) if sum(e) <= 3])
DEGREE = POWERS.sum(axis=1)


def field(p: Floats, coefficients: Floats, order: int) -> tuple[Floats, Floats]:
    """u_i = Σ cᵢₑ x^a y^b z^c with a + b + c ≤ order, (n, 3), and its gradient ∂u_i/∂x_j, (n, 3, 3)."""
    powers, c = POWERS[order >= DEGREE], coefficients[:, order >= DEGREE]
    value = np.prod(p[:, None] ** powers, axis=2)
    gradient = np.zeros((*value.shape, 3))
    for j in range(3):
        lower = np.maximum(powers - np.eye(3, dtype=int)[j], 0)
        gradient[..., j] = powers[:, j] * np.prod(p[:, None] ** lower, axis=2)
    return value @ c.T, np.einsum("nej,ie->nij", gradient, c)


def outside(V: Floats, u: Floats) -> float:
    """The part of u that the columns of V do not give, relative."""
    x = np.linalg.lstsq(V, u, rcond=None)[0]
    return float(np.linalg.norm(V @ x - u) / np.linalg.norm(u))


class TestFields:
    @pytest.mark.parametrize(("order", "fields"), [(0, 3), (1, 12), (2, 30)])
    def test_number(self, order: int, fields: int) -> None:
        V = polynomial_fields(P, DOFS, order)
        assert V.shape == (3 * len(P), fields)
        assert np.linalg.matrix_rank(V) == fields

    @pytest.mark.parametrize("order", [1, 2])
    def test_every_polynomial_of_the_order_is_there_and_no_higher_one(self, order: int) -> None:
        V = polynomial_fields(P, DOFS, order)
        c = np.random.default_rng(order).standard_normal((3, len(POWERS)))
        assert outside(V, field(P, c, order)[0].ravel()) < 1e-13  # rounding
        assert outside(V, field(P, c, order + 1)[0].ravel()) > 1e-3
        assert outside(V, rigid_motions(mesh_dofs(len(P)), P)[:, 4]) < 1e-13

    def test_neither_place_nor_size_matters(self) -> None:
        """A part of 1 mm, 1 km from the origin: coordinates keep 10 digits of their differences."""
        far = polynomial_fields(1e-3 * P + 1e3, DOFS, 2)
        np.testing.assert_allclose(far, polynomial_fields(P, DOFS, 2), atol=1e-9)
        assert np.abs(far).max() == pytest.approx(1.0, rel=1e-9)

    def test_rotations_are_half_the_curl(self) -> None:
        nodes = np.repeat(np.arange(len(P)), 6)
        V = polynomial_fields(P, Dofs(nodes, np.tile(np.arange(6), len(P))), 2)
        c = np.random.default_rng(5).standard_normal((3, len(POWERS)))
        u, g = field(P, c, 2)
        curl = np.stack([g[:, 2, 1] - g[:, 1, 2], g[:, 0, 2] - g[:, 2, 0], g[:, 1, 0] - g[:, 0, 1]], axis=1)
        assert outside(V, np.column_stack([u, curl / 2]).ravel()) < 1e-13
        assert outside(V, np.column_stack([u, curl]).ravel()) > 1e-2

    def test_nodes_without_coordinates(self) -> None:
        points = P.copy()
        points[3] = np.nan
        with pytest.raises(EigenError, match="coordinates of every node, 1 have none"):
            polynomial_fields(points, DOFS, 1)


@pytest.mark.parametrize("order", [1, 2])
def test_strain_energy_is_that_of_the_continuum(order: int) -> None:
    """½ uᵀKu = ½ ∫ λ (tr ε)² + 2μ ε:ε dV, a product of polynomials that 3 Gauss points integrate exactly."""
    c = np.random.default_rng(7).standard_normal((3, len(POWERS)))
    u = field(P, c, order)[0].ravel()
    g, w = np.polynomial.legendre.leggauss(3)
    gauss = np.array(list(product(g, repeat=3))) / 2 + 0.5
    weights = np.prod(np.array(list(product(w, repeat=3))) / 2, axis=1) * np.prod(SIZE)
    gradient = field(gauss * SIZE, c, order)[1]
    strain = (gradient + gradient.transpose(0, 2, 1)) / 2
    trace = np.trace(strain, axis1=1, axis2=2)
    lame, mu = 210e9 * 0.3 / (1.3 * 0.4), 210e9 / 2.6
    density = lame * trace**2 + 2 * mu * np.sum(strain**2, axis=(1, 2))
    V = polynomial_fields(P, DOFS, order)
    x = np.linalg.lstsq(V, u, rcond=None)[0]
    assert x @ (V.T @ (BAR.K @ V)) @ x == pytest.approx(float(weights @ density), rel=1e-11)


class TestSupports:
    @pytest.mark.parametrize(
        ("supports", "order", "left"),
        [
            ("free", 1, 12), ("free", 2, 30),
            ("clamped", 1, 3), ("clamped", 2, 12),  # x times the fields of an order less
            ("hinge", 0, 1), ("hinge", 1, 6),  # x and z times constants
        ],
    )  # fmt: skip  # a line per support
    def test_what_is_left_vanishes_there(self, supports: str, order: int, left: int) -> None:
        fixed = SUPPORTS[supports]
        V = polynomial_fields(P, DOFS, order) if order else BAR.rigid
        W = vanishing_at_supports(V, BAR, fixed)
        assert W.shape[1] == left
        assert not np.any(W[fixed])
        for w in W.T:
            assert outside(V, w) < 1e-12

    @pytest.mark.parametrize("order", [0, 1])
    def test_none_left(self, order: int) -> None:
        ends = dofs_where(MESH, (P[:, 0] == 0) | (P[:, 0] == SIZE[0]))
        V = polynomial_fields(P, DOFS, order) if order else BAR.rigid
        with pytest.raises(
            EigenError, match="none of whose combinations vanishes at the supports; raise order"
        ):
            vanishing_at_supports(V, BAR, ends)

    def test_a_flat_part_has_fewer(self) -> None:
        """z = 0 everywhere: no field with z moves it."""
        flat = polynomial_fields(P * (1, 1, 0), DOFS, 1)
        assert vanishing_at_supports(flat, BAR, NONE).shape[1] == 9


class TestPublishedBounds:
    """Rayleigh–Ritz with polynomials, by hand as in Meirovitch, Analytical Methods in Vibrations."""

    def test_clamped_bar(self) -> None:
        """u = a x + b x²: ω² ρL²/E = 2.486, 32.18 for π²/4 = 2.467 and 22.2 of the bar."""
        mesh = box("hex20", (2, 1, 1), (2.0, 0.1, 0.1))
        system = assemble(mesh, steel(mesh, poisson=0.0))
        fixed = dofs_where(mesh, mesh.points[:, 0] == 0)
        V = vanishing_at_supports(
            polynomial_fields(mesh.points, mesh_dofs(len(mesh.points)), 2), system, fixed
        )
        axial = np.roots([1 / 240, -13 / 90, 1 / 3])  # det(K − λM), K = [1 1; 1 4/3], M = [1/3 1/4; 1/4 1/5]
        lam = reduced_modes(V, system, np.zeros((len(V), 0)), "").lam * 7850 * 4 / 210e9
        np.testing.assert_allclose(np.sort(axial), [2.486, 32.18], rtol=1e-4)  # as published
        for expected in axial:
            assert np.min(np.abs(lam / expected - 1)) < 1e-9

    def test_slender_cantilever(self) -> None:
        """w = x²: ω² ρAL⁴/EI = 20, not below the 12.36 of the beam."""
        mesh = box("hex20", (8, 1, 1), (20.0, 0.1, 0.2))
        system = assemble(mesh, steel(mesh, poisson=0.0))
        fixed = dofs_where(mesh, mesh.points[:, 0] == 0)
        V = vanishing_at_supports(
            polynomial_fields(mesh.points, mesh_dofs(len(mesh.points)), 2), system, fixed
        )
        first = reduced_modes(V, system, np.zeros((len(V), 0)), "").lam[0]
        assert first * 7850 * 20**4 / (210e9 * 0.1**2 / 12) == pytest.approx(
            20.0, rel=2e-3
        )  # shear, rotation

    def test_rigid_motions_and_nothing_else_at_order_0(self) -> None:
        modes = reduced_modes(
            vanishing_at_supports(BAR.rigid, BAR, NONE), BAR, rigid_modes(BAR, NONE), "order 0"
        )
        np.testing.assert_array_equal(modes.lam, np.zeros(6))

    def test_order_1_of_a_free_block_is_pentland_and_williams_deformation(self) -> None:
        """12 modes: 6 rigid and 6 of uniform strain, of a cube whose directions are alike."""
        cube = box("hex20", (2, 2, 2))
        system = system_of(mapped(cube, lambda p: p - 0.5))
        V = polynomial_fields(cube.points, mesh_dofs(len(cube.points)), 1)
        modes = reduced_modes(V, system, rigid_modes(system, NONE), "")
        # ½ ∫ρ|u̇|² = ρ/24 ε̇:ε̇; ½ ∫σ:ε = μ ε:ε for shear and isochoric stretch, (μ + 3λ/2) ε:ε for volume
        lame, mu = 210e9 * 0.3 / (1.3 * 0.4), 210e9 / 2.6
        expected = 12 / 7850 * np.array([2 * mu] * 5 + [3 * lame + 2 * mu])
        np.testing.assert_allclose(modes.lam[6:], expected, rtol=1e-10)
        assert modes.rigid == 6
