"""x = K⁺ b: closed forms, dense algebra, inertia relief, slender bodies, what is refused."""

import numpy as np
import pytest
from bodies import BAR, LOADS, SUPPORTS, dense
from boxes import box, joined, mapped, mesh_of, steel
from scipy.sparse import block_diag, csr_array
from systems import SOLVERS, chain, dofs_where, system_of

from precompute.assembly import assemble
from precompute.errors import EigenError, ZeroEnergyError
from precompute.factor import Solver
from precompute.statics import static_solver
from precompute.system import System

NONE = np.zeros(0, dtype=np.int64)


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("supports", SUPPORTS)
class TestAgainstDenseAlgebra:
    def test_response(self, supports: str, solver: Solver) -> None:
        fixed = SUPPORTS[supports]
        with static_solver(BAR, fixed, solver=solver) as solve:
            x = solve(LOADS)
        expected = dense(BAR, fixed).static(LOADS)
        np.testing.assert_allclose(x, expected, atol=1e-10 * np.abs(expected).max())  # κ(K) ε is 1e-11

    def test_equilibrium(self, supports: str, solver: Solver) -> None:
        fixed = SUPPORTS[supports]
        with static_solver(BAR, fixed, solver=solver) as solve:
            x, g, R = solve(LOADS), solve.balanced(LOADS), solve.rigid
        assert not np.any(x[fixed])
        free = np.setdiff1d(np.arange(len(x)), fixed)
        rounding = abs(BAR.K) @ np.abs(x) + np.abs(g)
        # rounding: at most the dozens of entries of a row
        assert np.max(np.abs(BAR.K @ x - g)[free] / rounding.max(axis=0)) < 1e-15
        size = np.sqrt(np.max(np.sum(x * (BAR.M @ x), axis=0)))
        np.testing.assert_allclose(R.T @ (BAR.M @ x), 0, atol=1e-12 * size)
        np.testing.assert_allclose(R.T @ g, 0, atol=1e-12 * np.abs(R).max(initial=0.0))


class TestClosedForms:
    def test_chain_of_springs(self) -> None:
        """N = 1 N throughout: the i-th mass moves by i of 1 m."""
        load = np.eye(6)[-1]
        with static_solver(chain(6, ground=1.0), NONE) as solve:
            np.testing.assert_allclose(solve(load), np.arange(1, 7), rtol=1e-14)

    @pytest.mark.parametrize("supports", ["clamped", "free"])
    def test_bar_in_tension(self, supports: str) -> None:
        """Clamped: F L/EA. Free and pulled at one end: N = F x/L, an elongation of F L/2EA."""
        mesh = box("hex20", (3, 1, 1), (2.0, 0.1, 0.2))
        system = assemble(mesh, steel(mesh, poisson=0.0))  # uniaxial: u is x or x², which hex20 has
        x = mesh.points[:, 0]
        end = np.flatnonzero(x == 2.0)
        corner = np.all(np.isin(mesh.points[end, 1:] / (0.1, 0.2), (0, 1)), axis=1)
        F = np.zeros(len(system.rigid))
        F[3 * end] = np.where(corner, -1 / 12, 1 / 3)  # ∫N dA / A of a face of 8 nodes
        with static_solver(system, dofs_where(mesh, x == 0) if supports == "clamped" else NONE) as solve:
            u = solve(F)[0::3]
        unit = 2.0 / (210e9 * 0.02)
        stretch = np.mean(u[end]) - np.mean(u[x == 0])
        assert stretch == pytest.approx(unit if supports == "clamped" else unit / 2, rel=1e-11)


class TestSlender:
    """A beam of 300:1: λ₁ is 1e-11 of the stiffest cell's, a shift of K would be 100 λ₁."""

    mesh = box("hex20", (300, 1, 1), (300.0, 1.0, 1.0))
    system = system_of(mesh)

    @pytest.mark.parametrize("held", [False, True])
    def test_every_row_is_fulfilled_to_rounding(self, held: bool) -> None:
        x = self.mesh.points[:, 0]
        fixed = dofs_where(self.mesh, x == 0) if held else NONE
        b = np.zeros(3 * len(x))
        b[3 * np.flatnonzero(x == 300.0) + 2] = 1 / np.sum(x == 300.0)
        with static_solver(self.system, fixed) as solve:
            u, g = solve(b), solve.balanced(b)
        free = ~solve.held
        rounding = (abs(self.system.K) @ np.abs(u) + np.abs(g))[free]
        assert np.max(np.abs(self.system.K @ u - g)[free]) < 1e-15 * rounding.max()
        if held:  # Euler; shear adds 1e-5, the fully clamped end takes off 1e-3
            assert np.mean(u[2::3][x == 300.0]) == pytest.approx(300.0**3 / (3 * 210e9 / 12), rel=2e-3)


def test_symmetric_and_positive_as_a_preconditioner() -> None:
    X = np.random.default_rng(1).standard_normal((len(BAR.rigid), 20))
    with static_solver(BAR, NONE) as solve:
        G = X.T @ solve.unrefined(X)
    np.testing.assert_allclose(G, G.T, atol=1e-10 * np.abs(G).max())  # κ(K) ε
    assert np.linalg.eigvalsh(G)[0] > 0


@pytest.mark.parametrize("solver", SOLVERS)
def test_solvers_live_side_by_side(solver: Solver) -> None:
    """The factor of one does not evict that of another."""
    with static_solver(BAR, SUPPORTS["clamped"], solver=solver) as first:
        before = first(LOADS)
        with static_solver(BAR, SUPPORTS["free"], solver=solver) as second:
            other = second(LOADS)
            np.testing.assert_array_equal(first(LOADS), before)
            np.testing.assert_array_equal(second(LOADS), other)
        np.testing.assert_array_equal(first(LOADS), before)


def test_what_deforms() -> None:
    b = np.column_stack([BAR.M @ BAR.rigid[:, 2], LOADS[:, 0], 0 * LOADS[:, 0], np.zeros(len(LOADS))])
    b[SUPPORTS["clamped"][0], 3] = 1.0
    with static_solver(BAR, SUPPORTS["free"]) as solve:
        np.testing.assert_array_equal(solve.deforms(b), [False, True, False, True])
        assert not solve(b)[:, 0].any()  # exactly: no output is then said to depend on it
    with static_solver(BAR, SUPPORTS["clamped"]) as solve:
        np.testing.assert_array_equal(solve.deforms(b), [True, True, False, False])
        assert solve(b[:, :0]).shape == (len(b), 0)
        assert not solve(b)[:, 2:].any()


class TestRefused:
    def test_hinge_within_the_body(self) -> None:
        """Two blocks that share one edge."""
        block = box("hex8", (2, 2, 2))
        hinged = joined(block, mapped(block, lambda p: p + np.array([1.0, 0.0, 1.0])))
        with (
            pytest.raises(ZeroEnergyError, match="1 zero-energy mode beyond the 6 rigid ones"),
            static_solver(system_of(hinged), NONE),
        ):
            pass

    def test_loose_pieces(self) -> None:
        M, K = (csr_array(block_diag([A, A]).tocsr()) for A in (BAR.M, BAR.K))
        two = System(M, K, np.concatenate([BAR.rigid, BAR.rigid]))
        with pytest.raises(ZeroEnergyError, match="2 pieces"), static_solver(two, NONE):
            pass

    def test_a_node_in_no_element(self) -> None:
        mesh = mesh_of(
            np.vstack([box("hex8", (1, 1, 1)).points, [[5.0, 5.0, 5.0]]]), box("hex8", (1, 1, 1)).cells
        )
        with (
            pytest.raises(ZeroEnergyError, match="3 free DOFs without stiffness"),
            static_solver(system_of(mesh), NONE),
        ):
            pass

    def test_nothing_free(self) -> None:
        with pytest.raises(EigenError, match="all DOFs held"), static_solver(BAR, np.arange(len(BAR.rigid))):
            pass
