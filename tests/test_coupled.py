"""The step of modes that damping couples, against the exponential of the full state matrix in 80 digits."""

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fmu_src.runtime.coupled import CoupledPropagator, coupled_propagator
from fmu_src.runtime.model import Floats
from fmu_src.runtime.propagator import propagator
from fmu_src.runtime.step import State, coupled_step

PEAK = 1e-11  # of the largest value of its kind; ε‖A‖h with ‖A‖h up to 1e4 leaves 2e-12
OMEGA = 500.0  # rad/s, the highest of these systems


def exact(lam: Floats, D: Floats, h: float) -> dict[str, Floats]:
    """exp of [[0, I, 0], [−Λ, −D̃, I], [0, 0, shift]] h; its last columns answer f, ḟ, f̈, f⃛."""
    g = len(lam)
    size = 6 * g
    with mp.workdps(80):  # G₃ of the smallest step is 1e-61
        A = mp.zeros(size)
        for i in range(g):
            A[i, g + i] = 1
            A[g + i, i] = -mp.mpf(float(lam[i]))
            A[g + i, 2 * g + i] = A[2 * g + i, 3 * g + i] = A[3 * g + i, 4 * g + i] = 1
            A[4 * g + i, 5 * g + i] = 1
            for j in range(g):
                A[g + i, g + j] = -mp.mpf(float(D[i, j]))
        X = mp.expm(A * mp.mpf(h))
        full = np.array(X.tolist(), dtype=float)
    q, v = full[:g], full[g : 2 * g]
    return {
        "E11": q[:, :g],
        "E12": q[:, g : 2 * g],
        "E21": v[:, :g],
        "E22": v[:, g : 2 * g],
        "G0": q[:, 2 * g : 3 * g],
        "G1": q[:, 3 * g : 4 * g],
        "G2": q[:, 4 * g : 5 * g],
        "G3": q[:, 5 * g :],
    }


def worst(found: CoupledPropagator, true: dict[str, Floats], lam: Floats, h: float) -> float:
    """The largest error, each coefficient against what it can be: powers of h or of the slowest ω."""
    scale = {"E21": max(np.sqrt(lam.max()), 1e-300)}
    return max(
        float(np.abs(getattr(found, key) - value).max())
        / max(float(np.abs(value).max()), scale.get(key, 0.0))
        for key, value in true.items()
    )


def dashpot(g: int, c: float, seed: int = 0) -> Floats:
    w = np.random.default_rng(seed).standard_normal(g)
    return c * np.outer(w, w) / (w @ w)


CASES = {
    "weak": (np.array([1.0, 2.5e3, 2.5e5]), dashpot(3, 3.0)),
    "strong": (np.array([1.0, 2.5e3, 2.5e5]), dashpot(3, 5e3)),
    "free body, inner dashpot": (
        np.array([0.0, 0.0, 1e4, 2.5e5]),
        np.diag([0.0, 0, 0, 0]) + dashpot(4, 40.0),
    ),
    "rigid modes undamped": (
        np.array([0.0, 1e4, 2.5e5]),
        np.pad(dashpot(2, 40.0), ((1, 0), (1, 0))),
    ),
    "equal modes": (np.array([1e4, 1e4]), dashpot(2, 30.0)),
    "two dashpots": (np.array([4.0, 1e4, 2e4, 2.5e5]), dashpot(4, 200.0) + dashpot(4, 7.0, seed=1)),
}


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("turns", [1e-9, 1e-3, 0.7, 20.0, 2000.0])
def test_equals_the_exponential_at_any_step_size(name: str, turns: float) -> None:
    lam, D = CASES[name]
    h = turns / OMEGA
    assert worst(coupled_propagator(lam, D, h), exact(lam, D, h), lam, h) < PEAK


@pytest.mark.parametrize("beside", [0.0, 1e-14, -1e-14, 1e-8])
def test_critical_pairs(beside: float) -> None:
    """D̃ = Q diag(2ω₁, 2ω₂) Qᵀ with one ω in both: a critical pair in a basis that is not its own."""
    omega, angle = 100.0, 0.6
    Q = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    D = Q @ np.diag([2 * omega * (1 + beside), 0.3 * omega]) @ Q.T
    D = (D + D.T) / 2
    lam = np.full(2, omega**2)
    for h in (1e-4, 0.01, 0.3):
        assert worst(coupled_propagator(lam, D, h), exact(lam, D, h), lam, h) < PEAK


def test_modes_without_coupling_move_as_they_do_alone() -> None:
    lam, d = np.array([0.0, 0.0, 30.0, 2.5e5, 400.0]), np.array([0.0, 2.0, 1.0, 3e3, 40.0])
    for h in (1e-6, 1e-3, 0.5):
        together, alone = coupled_propagator(lam, np.diag(d), h), propagator(lam, d, h)
        for key in ("E11", "E12", "E22", "G0", "G1", "G2", "G3"):
            found, expected = getattr(together, key), np.diag(getattr(alone, key))
            # ‖A‖h is up to 2000 here
            assert np.abs(found - expected).max() < 1e-12 * np.abs(expected).max()


@settings(max_examples=40, deadline=None)
@given(
    exponents=st.lists(st.floats(-2, 6), min_size=2, max_size=5),
    c=st.floats(-3, 4),
    h=st.floats(-6, 0),
    seed=st.integers(0, 99),
)
def test_semigroup(exponents: list[float], c: float, h: float, seed: int) -> None:
    """Two steps of h/2 are one of h, under one polynomial force; a wrong G₃ would show."""
    lam, size = np.sort(10.0 ** np.array(exponents)), 10.0**h
    D = dashpot(len(lam), 10.0**c, seed)
    rng = np.random.default_rng(seed)
    q, v, f, f1, f2, f3 = rng.standard_normal((6, len(lam)))
    half, whole = coupled_propagator(lam, D, size / 2), coupled_propagator(lam, D, size)
    middle = coupled_step(half, State(q, v), f, f1, f2, f3)
    s = size / 2
    there = (f + s * f1 + s**2 / 2 * f2 + s**3 / 6 * f3, f1 + s * f2 + s**2 / 2 * f3, f2 + s * f3, f3)
    end = coupled_step(half, middle, *there)
    once = coupled_step(whole, State(q, v), f, f1, f2, f3)
    stiff = max(np.sqrt(lam.max()), 10.0**c) * size
    scale = (
        np.abs(once.q).max()
        + np.abs(q).max()
        + size * (np.abs(v).max() + size * np.abs([f, f1, f2, f3]).max())
    )
    assert np.abs(end.q - once.q).max() < 1e-13 * (1 + stiff) * scale


def test_energy_never_grows() -> None:
    """½ (v² + λq²) falls by what the dashpot takes; with no damping it stays."""
    lam = np.array([1.0, 50.0, 9e4])
    state = np.array([1.0, -1.0, 0.01, 0.5, 2.0, -3.0])
    weights = np.concatenate([lam, np.ones(3)])
    for c, grows in ((0.0, 1e-11), (20.0, 0.0)):
        P = coupled_propagator(lam, dashpot(3, c), 0.01)
        E = np.block([[P.E11, P.E12], [P.E21, P.E22]])
        x, energy = state, []
        for _ in range(1000):
            energy.append(weights @ x**2)
            x = E @ x
        assert np.max(np.diff(energy)) <= grows * energy[0]
        assert (energy[-1] < 0.9 * energy[0]) == (c > 0)


def test_beyond_range_is_no_number() -> None:
    P = coupled_propagator(np.array([1.0, 1e4]), dashpot(2, 1e20), 1.0)
    assert np.isnan(P.E11).all()
