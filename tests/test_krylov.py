"""Moments of the frequency response, matched about 0 and about a given frequency."""

import logging

import numpy as np
import pytest
from bodies import BAR, LOADS, SUPPORTS, Dense, dense
from systems import SOLVERS, chain, chain_held

from precompute.arrays import Floats
from precompute.errors import EigenError
from precompute.factor import Solver
from precompute.krylov import krylov
from precompute.ritz import reduced_modes
from precompute.statics import static_solver

NONE = SUPPORTS["free"]
TWO = LOADS[:, 1:3]  # y and z at the tip


def moments(lam: Floats, B: Floats, omega2: float, number: int) -> list[Floats]:
    """Bᵀ (Λ − ω²)^−(j+1) B, j = 0, 1, …: coefficients of bᵀ(K − (ω² + s) M)⁻¹b in s."""
    return [B.T @ (B / (lam[:, None] - omega2) ** (j + 1)) for j in range(number)]


def full_moments(full: Dense, rigid: int, omega2: float, number: int) -> list[Floats]:
    lam, Phi = full.modes()
    return moments(lam[rigid:], Phi[:, rigid:].T @ TWO[full.free], omega2, number)


@pytest.mark.parametrize("frequency", [0.0, 700.0])  # Hz; the first elastic ones are between 160 and 1100
@pytest.mark.parametrize("supports", SUPPORTS)
@pytest.mark.parametrize("solver", SOLVERS)
def test_twice_as_many_moments_as_blocks(supports: str, frequency: float, solver: Solver) -> None:
    omega2 = (2 * np.pi * frequency) ** 2
    with static_solver(BAR, SUPPORTS[supports], solver=solver) as solve:
        rigid = solve.rigid.shape[1]
        V = krylov(TWO, rigid + 2 * TWO.shape[1], frequency, solve, solver)
        modes = reduced_modes(V, BAR, solve.rigid, "")
    assert modes.rigid == rigid
    B = modes.Phi[:, rigid:].T @ TWO
    expected = full_moments(dense(BAR, SUPPORTS[supports]), rigid, omega2, 6)
    got = moments(modes.lam[rigid:], B, omega2, 6)
    errors = [np.max(np.abs(a - e)) / np.max(np.abs(e)) for a, e in zip(got, expected, strict=True)]
    assert max(errors[:4]) < 1e-9  # 2 blocks; κ(K) ε
    assert errors[5] > 100 * max(errors[:4])  # the sixth is not matched


@pytest.mark.parametrize("frequency", [0.0, 0.05])
def test_exact_near_the_frequency_and_not_far_from_it(frequency: float) -> None:
    """A chain of 40: 4 vectors give its response at the frequency itself and not elsewhere."""
    system = chain(40, ground=1.0)
    b = np.eye(40)[:, [-1]]
    with static_solver(system, NONE) as solve:
        modes = reduced_modes(krylov(b, 4, frequency, solve), system, solve.rigid, "")

    def error(f: float) -> float:
        omega2 = (2 * np.pi * f) ** 2
        full = np.linalg.solve(system.K.toarray() - omega2 * np.eye(40), b)
        reduced = modes.Phi @ ((modes.Phi.T @ b) / (modes.lam[:, None] - omega2))
        return float(np.linalg.norm(reduced - full) / np.linalg.norm(full))

    assert error(frequency) < 1e-11
    assert error(frequency + 0.02) > 1e-3


def test_a_space_that_is_exhausted(caplog: pytest.LogCaptureFixture) -> None:
    """Load on the middle of a symmetric chain: only the symmetric modes are ever reached."""
    system = chain(5)
    with static_solver(system, NONE) as solve, caplog.at_level(logging.INFO):
        V = krylov(np.eye(5)[:, [2]], 5, 0.0, solve)
    assert V.shape == (5, 3)
    np.testing.assert_allclose(V, V[::-1], atol=1e-12)
    assert "3 vectors span all that the inputs reach" in caplog.text


def test_count_includes_the_rigid_modes() -> None:
    with static_solver(BAR, NONE) as solve:
        assert krylov(TWO, 9, 0.0, solve).shape[1] == 9
        assert krylov(TWO, 2, 0.0, solve).shape[1] == 6


def test_vectors_are_orthonormal_and_vanish_at_supports() -> None:
    with static_solver(BAR, SUPPORTS["hinge"]) as solve:
        V = krylov(LOADS, 20, 0.0, solve)
    np.testing.assert_allclose(V.T @ (BAR.M @ V), np.eye(20), atol=1e-12)
    assert not np.any(V[SUPPORTS["hinge"]])


def test_resonance() -> None:
    frequency = float(np.sqrt(chain_held(9, 3)[2]) / (2 * np.pi))
    with (
        static_solver(chain(9, ground=1.0), NONE) as solve,
        pytest.raises(EigenError, match=r"is a resonance, expected one off it|zero pivot|singular"),
    ):
        krylov(np.eye(9)[:, [0]], 3, frequency, solve)


@pytest.mark.parametrize("b", [np.zeros((len(LOADS), 0)), 0 * TWO, BAR.M @ BAR.rigid[:, :3]])
def test_no_input_that_deforms_the_part(b: Floats) -> None:
    """None, no force, gravity on a free body."""
    with static_solver(BAR, NONE) as solve, pytest.raises(EigenError, match="starts from the inputs"):
        krylov(b, 9, 0.0, solve)
