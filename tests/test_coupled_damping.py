"""Damping that couples modes: matrices, materials and dashpots against dense products and textbook cases."""

import logging
from dataclasses import replace

import numpy as np
import pytest
from boxes import box, mapped
from scipy.integrate import quad
from scipy.linalg import eigh, expm
from scipy.sparse import csr_array, diags
from systems import along_x, chain

from precompute.arrays import Floats
from precompute.assembly import assemble
from precompute.coupled_damping import projected_damping
from precompute.damping import damping_of
from precompute.damping_table import DampingForm
from precompute.eigen import solve_modes
from precompute.errors import ModalFmuError
from precompute.material import CellMaterial, shared_rayleigh
from precompute.notice import LOGGER_NAME
from precompute.rayleigh_part import split_rayleigh
from precompute.rigid import rigid_modes
from precompute.system import System

ROUNDING = 1e-13  # sums of up to a hundred terms, relative to the largest
NONE = np.zeros(0, dtype=np.int64)


def row(*w: float) -> csr_array:
    return csr_array(np.array([w]))


def between(n: int, i: int, j: int | None = None) -> csr_array:
    """u_i, or u_i − u_j, of n DOFs."""
    w = np.zeros((1, n))
    w[0, i] = 1.0
    if j is not None:
        w[0, j] -= 1.0
    return csr_array(w)


def all_modes(system: System) -> tuple[Floats, Floats]:
    """λ and Φ of every mode, rigid ones exact and first, as the eigensolver gives them."""
    lam, Phi = eigh(system.K.toarray(), system.M.toarray())
    rigid = rigid_modes(system, NONE)
    k = rigid.shape[1]
    lam[:k], Phi[:, :k] = 0.0, rigid
    return lam, Phi


def test_no_modes_have_no_damping() -> None:
    """A supported body has no rigid modes, which a certificate starts from."""
    system = chain(3, ground=1.0)
    assert projected_damping(np.zeros(0), np.zeros((3, 0)), system.K, [(between(3, 0), 1.0)]).shape == (0, 0)


class TestDashpots:
    def test_two_masses_with_a_dashpot_between_them(self) -> None:
        """m = k = 1, c between: Φ = [[1, 1], [1, −1]]/√2, so D̃ = diag(0, 2c), and λ = 0, 2."""
        lam, Phi = all_modes(chain(2))
        D = projected_damping(lam, Phi, None, [(between(2, 0, 1), 0.3)])
        np.testing.assert_allclose(D, [[0, 0], [0, 0.6]], rtol=ROUNDING)
        assert not D[0].any()

    def test_two_masses_with_a_dashpot_to_ground(self) -> None:
        """At the first mass: D̃ = c/2 [[1, ±1], [±1, 1]], rank 1, the sign as the second mode's."""
        lam, Phi = all_modes(chain(2))
        D = projected_damping(lam, Phi, None, [(between(2, 0), 0.3)])
        np.testing.assert_allclose(np.abs(D), 0.15 * np.ones((2, 2)), rtol=ROUNDING)
        assert (D == D.T).all()
        assert np.linalg.det(D) == pytest.approx(0.0, abs=ROUNDING)

    def test_dashpots_add_and_agree_with_the_dense_matrix(self) -> None:
        lam, Phi = all_modes(chain(9))
        dashpots = [(between(9, 0), 0.3), (between(9, 2, 7), 1.2), (row(*np.linspace(-1, 2, 9)), 0.01)]
        dense = sum(c * (w.T @ w).toarray() for w, c in dashpots)
        D = projected_damping(lam, Phi, None, dashpots)
        np.testing.assert_allclose(D, Phi.T @ dense @ Phi, atol=ROUNDING * np.abs(D).max())
        assert np.linalg.eigvalsh(D)[0] > -ROUNDING * np.abs(D).max()

    def test_what_is_dissipated_is_the_integral_of_c_v_squared(self) -> None:
        """Energy at 0 less energy at T = ∫ c (w u̇)² dt along the exact motion of the reduced model."""
        system, c, T = chain(3, ground=1.0), 0.4, 5.0
        lam, Phi = all_modes(system)
        w = between(3, 2, 0)
        D = projected_damping(lam, Phi, None, [(w, c)])
        A = np.block([[np.zeros((3, 3)), np.eye(3)], [-np.diag(lam), -D]])
        x0 = np.array([0.0, 0.0, 0.0, 1.0, -0.5, 0.2])

        def energy(t: float) -> float:
            x = expm(A * t) @ x0
            return float(0.5 * x[3:] @ x[3:] + 0.5 * x[:3] @ (lam * x[:3]))

        def power(t: float) -> float:
            v = (w @ Phi @ (expm(A * t) @ x0)[3:])[0]
            return float(c * v**2)

        lost = quad(power, 0, T, epsabs=1e-12, limit=200)[0]
        assert lost == pytest.approx(energy(0.0) - energy(T), rel=1e-10)  # quadrature
        assert lost > 0.1 * energy(0.0)  # there is something to see

    def test_inner_dashpot_leaves_rigid_motion_free_to_the_last_bit(self) -> None:
        """Weights of sum 1 to rounding only: the rigid modes' rows are 0, without the rule they are not."""
        mesh = mapped(box("hex8", (3, 2, 2)), lambda p: p @ np.linalg.qr(np.vander([1.0, 2.0, 4.0]))[0])
        system = assemble(mesh, [steel_like(mesh, "all", np.arange(12))])
        lam, Phi = all_modes(system)
        w = np.zeros(system.K.shape[0])
        weights = np.arange(1.0, 10.0) / 45.0
        w[0:27:3], w[-27::3] = weights, -weights[::-1]
        D = projected_damping(lam, Phi, None, [(csr_array(w[None]), 10.0)])
        plain = 10.0 * np.outer(w @ Phi, w @ Phi)
        # what is left out as rounding is 1e-13 of a mode's largest amplitude, some ten times its mean one
        np.testing.assert_allclose(D[6:, 6:], plain[6:, 6:], atol=1e-12 * plain.max())
        translations = np.abs(system.rigid[:, :3].T @ w) < 1e-15
        assert translations.all()  # an inner dashpot
        assert not D[:3].any()
        assert not D[:, :3].any()
        assert (plain[:3, :3] != 0).any()

    def test_modes_that_a_dashpot_does_not_move_stay_uncoupled(self) -> None:
        """At the middle of a symmetric chain the antimetric modes stand still."""
        lam, Phi = all_modes(chain(7))
        D = projected_damping(lam, Phi, None, [(between(7, 3), 1.0)])
        assert not D[1::2].any()
        assert np.count_nonzero(D) == 16  # modes 0, 2, 4, 6

    @pytest.mark.parametrize("bad", [-1.0, np.nan, np.inf])
    def test_refuses_what_is_no_coefficient(self, bad: float) -> None:
        with pytest.raises(ModalFmuError, match="expected a finite number ≥ 0 in N"):
            projected_damping(np.ones(2), np.eye(2), None, [(between(2, 0), bad)])


class TestMatrix:
    def test_equals_the_dense_product_and_is_symmetric_to_the_last_bit(self) -> None:
        lam, Phi = all_modes(chain(8, ground=1.0))
        rng = np.random.default_rng(3)
        A = rng.standard_normal((8, 5))
        D = csr_array(A @ A.T)
        found = projected_damping(lam, Phi, D, [])
        np.testing.assert_allclose(found, Phi.T @ (A @ A.T) @ Phi, atol=ROUNDING * np.abs(found).max())
        assert (found == found.T).all()

    def test_of_m_and_k_does_not_couple(self) -> None:
        """D = αM + βK in the matrix itself: the couplings left are rounding, and 0."""
        system = chain(12, ground=1.0)
        lam, Phi = all_modes(system)
        D = csr_array(0.2 * system.M + 0.03 * system.K)
        found = projected_damping(lam, Phi, D, [])
        np.testing.assert_allclose(found, np.diag(0.2 + 0.03 * lam), rtol=ROUNDING)
        assert (Phi.T @ (D @ Phi))[0, 1:].any()  # without the rule it would couple

    def test_rows_of_modes_without_resistance_are_0(self) -> None:
        """Also where D has thirteen digits only, so that it is no longer exactly 0 in rigid motion."""
        system = chain(12)
        lam, Phi = all_modes(system)
        D = csr_array(system.K / 3)
        D.data = np.array([float(f"{x:.12e}") for x in D.data])
        D[4, 4] += 1e-13  # the last digit of another
        found = projected_damping(lam, Phi, D, [])
        assert not found[0].any()
        assert not found[:, 0].any()
        np.testing.assert_allclose(np.diag(found), lam / 3, rtol=1e-11)  # 1e-13 of the stiffest, λ₁ = 0.07
        assert Phi[:, 0] @ (D @ Phi[:, 0]) > 1e-15

    def test_modes_that_it_does_not_touch_have_rows_of_0(self) -> None:
        """Where every term of the sum is 0 there is nothing to measure rounding by."""
        D = csr_array(np.diag([2.0, 0.0, 3.0]))
        found = projected_damping(np.array([0.0, 1.0, 4.0]), np.eye(3), D, [])
        np.testing.assert_array_equal(found, np.diag([2.0, 0.0, 3.0]))

    @pytest.mark.parametrize(
        ("change", "words"),
        [
            (lambda D: D + csr_array(diags([np.ones(4)], [1], shape=(5, 5))), "expected a symmetric matrix"),
            (lambda D: D - csr_array(diags([[0.0, 0.0, 3.0, 0.0, 0.0]], [0])), "expected D ≥ 0"),
            (lambda D: -D, "expected D ≥ 0"),
            (lambda D: D * np.nan, "expected a symmetric matrix"),
        ],
    )
    def test_refuses_a_matrix_that_is_not_symmetric_or_gains_energy(self, change, words: str) -> None:
        system = chain(5, ground=1.0)
        lam, Phi = all_modes(system)
        projected_damping(lam, Phi, system.K, [])  # the one without the fault
        with pytest.raises(ModalFmuError, match=words) as raised:
            projected_damping(lam, Phi, csr_array(change(system.K)), [])
        assert "\n" not in str(raised.value)


class TestSplit:
    def test_alpha_and_beta_are_found(self, caplog: pytest.LogCaptureFixture) -> None:
        caplog.set_level(logging.INFO, logger=LOGGER_NAME)
        system = chain(30, ground=1.0)
        D = csr_array(0.2 * system.M + 3e-4 * system.K)
        without, (alpha, beta) = split_rayleigh(replace(system, D=D))
        assert without.D is None
        assert alpha == pytest.approx(0.2, rel=ROUNDING)
        assert beta == pytest.approx(3e-4, rel=10 * ROUNDING)  # a thousandth of the other
        assert "alpha = 0.2 1/s, beta = 0.0003 s" in caplog.text

    @pytest.mark.parametrize(("alpha", "beta"), [(0.2, 0.0), (0.0, 3e-4)])
    def test_the_other_is_exactly_0(self, alpha: float, beta: float) -> None:
        system = chain(30, ground=1.0)
        D = csr_array(alpha * system.M + beta * system.K)
        found = split_rayleigh(replace(system, D=D))[1]
        assert [x == 0 for x in found] == [alpha == 0, beta == 0]

    def test_thirteen_printed_digits_suffice(self) -> None:
        system = chain(30, ground=1.0)
        D = csr_array(0.123456789 * system.M + 0.0987654321 * system.K)
        D.data = np.array([float(f"{x:.12e}") for x in D.data])
        assert split_rayleigh(replace(system, D=D))[0].D is None

    @pytest.mark.parametrize(
        "extra",
        [
            csr_array(([1e-6], ([3], [3])), shape=(30, 30)),  # a dashpot to ground
            csr_array(([-0.4], ([3], [3])), shape=(30, 30)),  # no damping at all
        ],
    )
    def test_anything_else_is_left_as_it_is(self, extra: csr_array) -> None:
        system = chain(30, ground=1.0)
        damped = replace(system, D=csr_array(0.2 * system.M + 3e-4 * system.K + extra))
        assert split_rayleigh(damped) == (damped, (0.0, 0.0))

    def test_a_negative_beta_is_left_for_the_check_of_d(self) -> None:
        system = chain(30, ground=1.0)
        damped = replace(system, D=csr_array(0.2 * system.M - 3e-4 * system.K))
        assert split_rayleigh(damped)[1] == (0.0, 0.0)

    def test_no_damping_is_none(self) -> None:
        system = chain(3)
        assert split_rayleigh(system) == (system, (0.0, 0.0))
        assert split_rayleigh(replace(system, D=csr_array((3, 3))))[0].D is None


def steel_like(mesh, name: str, cells, **damping: float) -> CellMaterial:
    (family,) = mesh.cells
    young, density = (210e9, 7850.0) if name != "rubber" else (1e8, 1200.0)
    return CellMaterial(name, young, 0.3, density, {family: cells}, **damping)


MESH = box("hex8", (6, 1, 1), (1.2, 0.1, 0.1))
LEFT, RIGHT = np.arange(3), np.arange(3, 6)


def bar(left: dict[str, float], right: dict[str, float]) -> tuple[System, tuple[float, float]]:
    materials = [steel_like(MESH, "steel", LEFT, **left), steel_like(MESH, "rubber", RIGHT, **right)]
    return assemble(MESH, materials), shared_rayleigh(materials)


class TestMaterials:
    def test_d_is_the_sum_of_the_parts(self) -> None:
        """M and K of the left half: what K and M gain when that half is twice as stiff and heavy."""
        left, right = {"alpha": 5.0, "beta": 1e-5}, {"alpha": 40.0, "beta": 2e-4}
        system, shared = bar(left, right)
        assert shared == (0.0, 0.0)
        assert system.D is not None
        twice = CellMaterial("steel", 420e9, 0.3, 15700.0, {"hex8": LEFT})
        doubled = assemble(MESH, [twice, steel_like(MESH, "rubber", RIGHT)])
        K_left, M_left = doubled.K - system.K, doubled.M - system.M
        expected = 5.0 * M_left + 1e-5 * K_left + 40.0 * (system.M - M_left) + 2e-4 * (system.K - K_left)
        np.testing.assert_allclose(
            system.D.toarray(),
            expected.toarray(),
            atol=1e-13 * np.abs(expected.data).max(),  # differences of sums of eight cells
        )
        assert (system.D != system.D.T).nnz == 0
        assert system.D.has_canonical_format

    def test_one_damping_for_all_is_rayleigh(self) -> None:
        same = {"alpha": 5.0, "beta": 1e-5}
        system, shared = bar(same, same)
        assert system.D is None
        assert shared == (5.0, 1e-5)

    def test_what_is_shared_is_not_in_d(self) -> None:
        """One β, two α: D has the α only, and βΛ stays tunable."""
        system, shared = bar({"alpha": 5.0, "beta": 1e-5}, {"beta": 1e-5})
        assert shared == (0.0, 1e-5)
        plain, _ = bar({"alpha": 5.0}, {})
        assert system.D is not None
        assert plain.D is not None
        np.testing.assert_array_equal(system.D.toarray(), plain.D.toarray())

    def test_modes_of_a_clamped_bar_of_two_materials(self) -> None:
        """D̃ = ΦᵀDΦ with the whole, dense D."""
        system, shared = bar({"alpha": 5.0, "beta": 1e-5}, {"alpha": 40.0, "beta": 1e-5})
        fixed = np.flatnonzero(np.repeat(MESH.points[:, 0] == 0, 3))
        modes = solve_modes(system, fixed, count=8)
        damping = damping_of(DampingForm(beta=1e-6), modes.lam, modes.Phi, system.D, shared=shared)
        assert system.D is not None
        whole = system.D.toarray() + 1.1e-5 * system.K.toarray()
        D_tilde = damping.alpha * np.eye(8) + damping.beta * np.diag(modes.lam) + damping.D_rest
        expected = modes.Phi.T @ whole @ modes.Phi
        # K's rounding in the modes: the eigensolver's residual, relative to the largest
        np.testing.assert_allclose(D_tilde, expected, atol=1e-9 * np.abs(expected).max())
        off = damping.D_rest - np.diag(np.diag(damping.D_rest))
        assert np.abs(off).max() > 0.02 * np.abs(damping.D_rest).max()  # a diagonal would not do
        assert damping.beta == pytest.approx(1.1e-5, rel=1e-15)

    def test_own_beta_does_not_damp_rigid_motion_and_own_alpha_does(self) -> None:
        system, _ = bar({"beta": 1e-5}, {"beta": 2e-4})
        lam, Phi = all_modes(system)
        assert np.count_nonzero(lam == 0) == 6
        D = projected_damping(lam, Phi, system.D, [])
        assert not D[:6].any()
        assert not D[:, :6].any()
        assert (np.diag(D)[6:] > 0).all()
        rounding = Phi.T @ (system.D @ Phi)
        assert rounding[:6].any()  # without the rule it would
        system, _ = bar({"alpha": 5.0}, {})
        D = projected_damping(lam, Phi, system.D, [])
        half = (
            5.0 * 7850.0 / (7850.0 + 1200.0)
        )  # the left half's share of the mass moves with every translation
        np.testing.assert_allclose(np.diag(D)[:3], half, rtol=1e-12)

    @pytest.mark.parametrize("key", ["alpha", "beta"])
    @pytest.mark.parametrize("bad", [-1.0, np.nan, np.inf])
    def test_refuses_what_is_no_coefficient(self, key: str, bad: float) -> None:
        with pytest.raises(ModalFmuError, match=f"material 'steel': got {key} = .*expected a finite number"):
            steel_like(MESH, "steel", LEFT, **{key: bad})


def test_a_free_chain_slides_under_its_inner_dashpot() -> None:
    """The rigid mode's amplitude after a push is t, whatever the dashpot does inside."""
    system = System(csr_array(np.eye(2)), chain(2).K, along_x(2))
    lam, Phi = all_modes(system)
    D = projected_damping(lam, Phi, None, [(between(2, 0, 1), 5.0)])
    A = np.block([[np.zeros((2, 2)), np.eye(2)], [-np.diag(lam), -D]])
    velocity = (expm(A * 1e6) @ np.array([0.0, 0.0, 1.0, 0.7]))[2:]
    assert velocity[0] == pytest.approx(1.0, rel=1e-12)  # expm of a large matrix by squaring
    assert velocity[1] == pytest.approx(0.0, abs=1e-12)
