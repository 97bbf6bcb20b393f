"""What truncated modes do statically: as a feed-through, and as more modes."""

import numpy as np
import pytest
from bodies import BAR, LOADS, SUPPORTS, dense, interface, modal_flexibility, relative
from scipy.sparse import csc_array, csr_array
from systems import along_x

from fmu_src.runtime.model import Port
from precompute.arrays import Floats
from precompute.craig_bampton import craig_bampton
from precompute.eigen import Modes, solve_modes
from precompute.interface import Interface
from precompute.residual import residual_flexibility, with_residual_modes
from precompute.ritz import reduced_modes
from precompute.statics import StaticSolver, static_solver
from precompute.system import System

KEPT = 9


def kept(supports: str) -> Modes:
    return solve_modes(BAR, SUPPORTS[supports], count=KEPT)


def flexibility(modes: Modes) -> Floats:
    return modal_flexibility(modes.lam, modes.Phi, modes.rigid, LOADS)


@pytest.mark.parametrize("supports", SUPPORTS)
class TestStaticResponse:
    def test_feed_through(self, supports: str) -> None:
        expected = dense(BAR, SUPPORTS[supports]).static(LOADS)
        modes, over = kept(supports), interface()
        with static_solver(BAR, SUPPORTS[supports]) as solve:
            residual = residual_flexibility(over, modes, solve)
        assert relative(flexibility(modes), LOADS.T @ expected) > 1e-2  # nine modes alone do not do
        assert relative(flexibility(modes) + residual.R_in, LOADS.T @ expected) < 1e-10  # κ(K) ε
        elastic = modes.Phi[:, modes.rigid :]
        quasi = elastic @ ((elastic.T @ LOADS) / modes.lam[modes.rigid :, None])
        got = (over.c @ quasi + residual.R)[[0, 2]]  # displacement, velocity (per rate of the load)
        np.testing.assert_allclose(got, (over.c @ expected)[[0, 2]], atol=1e-10 * np.abs(expected).max())
        np.testing.assert_array_equal(residual.R[1], 0)  # acceleration

    def test_more_modes(self, supports: str) -> None:
        expected = LOADS.T @ dense(BAR, SUPPORTS[supports]).static(LOADS)
        modes = kept(supports)
        with static_solver(BAR, SUPPORTS[supports]) as solve:
            more = with_residual_modes(modes, LOADS, solve)
        assert more.rigid == modes.rigid
        assert len(more.lam) == KEPT + LOADS.shape[1]
        assert relative(flexibility(more), expected) < 1e-10
        np.testing.assert_allclose(more.lam[:KEPT], modes.lam, rtol=1e-9)
        np.testing.assert_allclose(more.Phi[:, :KEPT], modes.Phi, atol=1e-6 * np.abs(modes.Phi).max())
        np.testing.assert_allclose(more.Phi.T @ (BAR.M @ more.Phi), np.eye(len(more.lam)), atol=1e-11)

    def test_strain_energy(self, supports: str) -> None:
        """½ fᵀR_in f is that of what the modes leave, never negative."""
        with static_solver(BAR, SUPPORTS[supports]) as solve:
            R_in = residual_flexibility(interface(), kept(supports), solve).R_in
            x = solve(LOADS)
        np.testing.assert_array_equal(R_in, R_in.T)
        assert np.linalg.eigvalsh(R_in)[0] > 0
        whole = np.sum(x * (BAR.K @ x), axis=0)
        modal = np.diag(flexibility(kept(supports)))
        np.testing.assert_allclose(np.diag(R_in) + modal, whole, rtol=1e-9)


class TestWhatAddsNothing:
    def added(self, modes: Modes, b: Floats, solve: StaticSolver) -> int:
        return len(with_residual_modes(modes, b, solve).lam) - len(modes.lam)

    def test_loads_that_depend_on_others(self) -> None:
        with static_solver(BAR, SUPPORTS["clamped"]) as solve:
            b = np.column_stack([LOADS, LOADS @ np.arange(1.0, 5.0), 1e-9 * LOADS[:, 0], 0 * LOADS[:, 0]])
            assert self.added(kept("clamped"), b, solve) == 4

    @pytest.mark.parametrize(("supports", "added"), [("free", 0), ("clamped", 3)])
    def test_gravity_does_not_bend_a_free_body(self, supports: str, added: int) -> None:
        with static_solver(BAR, SUPPORTS[supports]) as solve:
            assert self.added(kept(supports), BAR.M @ BAR.rigid[:, :3], solve) == added

    def test_loads_on_supports(self) -> None:
        b = np.zeros((len(LOADS), 1))
        b[SUPPORTS["clamped"][4]] = 1.0
        with static_solver(BAR, SUPPORTS["clamped"]) as solve:
            assert self.added(kept("clamped"), b, solve) == 0

    @pytest.mark.parametrize("supports", SUPPORTS)
    def test_a_basis_that_answers_already(self, supports: str) -> None:
        with static_solver(BAR, SUPPORTS[supports]) as solve:
            W = LOADS / np.linalg.norm(LOADS, axis=0)
            modes = reduced_modes(craig_bampton(W, solve, 3), BAR, solve.rigid, "")
            assert self.added(modes, LOADS, solve) == 0
            R = residual_flexibility(interface(), modes, solve)
            x = solve(LOADS)
        assert np.abs(R.R).max() < 1e-11 * np.abs(x).max()
        assert np.abs(R.R_in).max() < 1e-11 * np.abs(LOADS.T @ x).max()

    def test_all_modes(self) -> None:
        every = solve_modes(BAR, SUPPORTS["free"], count=len(BAR.rigid))
        with static_solver(BAR, SUPPORTS["free"]) as solve:
            assert self.added(every, LOADS, solve) == 0


def test_what_moves_no_mass_is_no_residual_mode(caplog: pytest.LogCaptureFixture) -> None:
    """A force on a massless point between a held mass and a free one: the masses answer exactly, it by what
    they do; residual = true has the rest, 1/(2 k) of two springs k = 1 N/m."""
    K = csr_array(np.array([[3.0, -1, 0], [-1, 2, -1], [0, -1, 1]]))
    system = System(csr_array(np.diag([1.0, 0, 1])), K, along_x(3))
    none = np.zeros(0, dtype=np.int64)
    modes = solve_modes(system, none, count=2)
    b = np.array([[0.0, 0], [1, 0], [0, 1]])
    static = np.linalg.solve(K.toarray(), b)
    with static_solver(system, none) as solve:
        more = with_residual_modes(modes, b, solve)
        over = Interface(
            (Port("p", ("force.x", "force.y"), ()),), csc_array(b), csr_array((0, 3)), np.zeros((0, 2))
        )
        R_in = residual_flexibility(over, modes, solve).R_in
    assert "1 of 1 residual vectors move no mass" in caplog.text
    np.testing.assert_allclose(more.lam, modes.lam, rtol=1e-13)
    answered = more.Phi @ ((more.Phi.T @ b) / more.lam[:, None])
    np.testing.assert_allclose(answered[[0, 2]], static[[0, 2]], rtol=1e-13)
    np.testing.assert_allclose(R_in, [[0.5, 0], [0, 0]], atol=1e-14)


def test_rows_of_every_law() -> None:
    """Mises (six rows) and displacement take R; acceleration and reaction (three rows) do not."""
    ports = (
        Port("tip", ("force.z",), ("stress.mises", "acceleration.x", "displacement.z")),
        Port("clamp", (), ("reaction.z",)),
        Port("energy", (), ("kinetic", "strain")),
    )
    c = csr_array(np.tile(LOADS[:, 2], (11, 1)))
    over = Interface(ports, csc_array(LOADS[:, [2]]), c, np.zeros((11, 1)))
    with static_solver(BAR, SUPPORTS["clamped"]) as solve:
        R = residual_flexibility(over, kept("clamped"), solve).R
    np.testing.assert_array_equal(R[:, 0] > 0, [True] * 6 + [False, True, False, False, False])
