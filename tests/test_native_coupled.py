"""The step of coupled modes in C, by every set of instructions, against arithmetic of many digits."""

import math
from collections.abc import Mapping
from itertools import pairwise
from typing import Any

import mpmath as mp
import numpy as np
import pytest
from hypothesis import example, given, settings, target
from hypothesis import strategies as st
from native_maths import kernel_tables, native_coupled

from fmu_src.runtime.coupled import CoupledPropagator, coupled_propagator
from fmu_src.runtime.model import Floats

REQUIRED = 1e-11  # of the peak, for |A| h up to 1e4
# What is promised, per 1 + ωh of the fastest mode, where each mode is damped in the measure of its own
# frequency: as of modes alone (test_propagator.py). A long search found 7e-16 at worst.
PROMISE = 2e-15


def exact(lam: Floats, D: Floats, h: float) -> Mapping[str, Any]:
    """exp of [[0, I, 0], [−Λ, −D̃, I], [0, 0, shift]] h; its last columns answer f, ḟ, f̈, f⃛."""
    g = len(lam)
    A = np.zeros((6 * g, 6 * g))
    A[:g, g : 2 * g] = A[g : 2 * g, 2 * g : 3 * g] = np.eye(g)
    A[2 * g : 5 * g, 3 * g :] = np.eye(3 * g)
    A[g : 2 * g, :g], A[g : 2 * g, g : 2 * g] = -np.diag(lam), -D
    halvings = max(0, math.ceil(math.log2(np.abs(A).sum(axis=1).max() * h + 1))) + 4
    with mp.workdps(60 + halvings):  # a digit is lost in three doublings
        X = mp.matrix(A.tolist()) * mp.mpf(h) / 2**halvings
        term = total = mp.eye(6 * g)
        for k in range(1, 50):  # 1/16⁵⁰/50! is 1e-125
            term = term * X / k
            total += term
        for _ in range(halvings):
            total = total * total
    E = np.array([[total[i, j] for j in range(6 * g)] for i in range(2 * g)], dtype=object)
    q, v = np.vsplit(E, 2)
    columns = [slice(k * g, (k + 1) * g) for k in range(6)]
    return {
        "E11": q[:, columns[0]],
        "E12": q[:, columns[1]],
        "E21": v[:, columns[0]],
        "E22": v[:, columns[1]],
        **{f"G{k}": q[:, columns[2 + k]] for k in range(4)},
    }


def errors(
    P: CoupledPropagator, true: Mapping[str, Any], lam: Floats, D: Floats, h: float
) -> dict[str, float]:
    """Of E in the coordinates [w q, v], w = max(ω, 1/h), where it is no larger than 1 or so; of Gₖ in parts
    of its largest entry over steps from h/2 to h: at full turns it is next to 0."""
    w = np.maximum(np.sqrt(lam), 1 / h)
    scale: dict[str, Any] = {"E11": np.divide.outer(w, w), "E12": w[:, None], "E21": 1 / w, "E22": 1.0}
    around = [native_coupled(lam, D, h * part) for part in (0.5, 0.7, 1.0)]
    scale |= {
        key: 1 / max(np.abs(getattr(other, key)).max() for other in around)
        for key in ("G0", "G1", "G2", "G3")
    }
    found = {}
    for key, value in true.items():
        difference = np.abs(np.vectorize(mp.mpf)(getattr(P, key)) - value).astype(float)
        found[key] = float((difference * scale[key]).max())
    return found


def worst(P: CoupledPropagator, true: Mapping[str, Any], lam: Floats, D: Floats, h: float) -> float:
    return max(errors(P, true, lam, D, h).values())


def symmetric(A: Floats) -> Floats:
    return (A + A.T) / 2


@st.composite
def damped_in_their_measure(draw: st.DrawFn) -> tuple[Floats, Floats, float]:
    """λ ∈ [1e-6, 1e12], the first ones then 0; D̃ᵢⱼ = 2 √(ζᵢωᵢ ζⱼωⱼ) cᵢⱼ, ζ ≤ 1, correlation c; ‖A‖h ≤ 1e4."""
    g = draw(st.integers(2, 3))
    lam = np.sort(10.0 ** np.array(draw(st.lists(st.floats(-6, 12), min_size=g, max_size=g))))
    zeta = 10.0 ** np.array(draw(st.lists(st.floats(-8, 0), min_size=g, max_size=g)))
    root = np.sqrt(2 * zeta * np.sqrt(lam))
    vectors = np.random.default_rng(draw(st.integers(0, 999))).standard_normal((g, draw(st.integers(1, g))))
    vectors /= np.linalg.norm(vectors, axis=1)[:, None]
    D = symmetric(root[:, None] * (vectors @ vectors.T) * root)
    lam[: draw(st.integers(0, g - 1))] = 0.0
    h = 10.0 ** draw(st.floats(-9, 4)) / max(np.sqrt(lam.max()), np.abs(D).sum(axis=1).max())
    return lam, D, float(h)


FREE_BODY = (np.array([0.0, 0.0, 1e4]), symmetric(np.outer([3.0, -1.0, 5.0], [3.0, -1.0, 5.0])), 0.7)
SPREAD = (np.array([1e-2, 1.0, 1e8]), symmetric(np.outer([0.1, 1.0, 1e2], [0.1, 1.0, 1e2])), 0.03)


@settings(max_examples=60, deadline=None)
@given(damped_in_their_measure())
@example(FREE_BODY)
@example(SPREAD)
def test_slow_modes_keep_their_digits_beside_fast_ones(system: tuple[Floats, Floats, float]) -> None:
    lam, D, h = system
    found = worst(native_coupled(lam, D, h), exact(lam, D, h), lam, D, h) / (1 + np.sqrt(lam.max()) * h)
    target(math.log10(found + 1e-18))
    assert found <= PROMISE


def dashpot(g: int, c: float) -> Floats:
    w = np.random.default_rng(g).standard_normal(g)
    return symmetric(c * np.outer(w, w) / (w @ w))


def critical(beside: float) -> Floats:
    """Q diag(2ω, 0.3 ω) Qᵀ with ω = 100 in both: a critical pair in a basis that is not its own."""
    Q = np.array([[np.cos(0.6), -np.sin(0.6)], [np.sin(0.6), np.cos(0.6)]])
    return symmetric(Q @ np.diag([200.0 * (1 + beside), 30.0]) @ Q.T)


LAM = np.array([0.0, 1.0, 2.5e3, 2.5e5])
PAIR = np.full(2, 1e4)
CASES = {
    **{f"critical {beside:+g}": (PAIR, critical(beside)) for beside in (0.0, 1e-14, -1e-14, 1e-8)},
    "all critical": (PAIR, np.diag([200.0, 200.0])),
    **{f"dashpot {c:g}": (LAM, dashpot(4, c)) for c in (1e-3, 3.0, 5e3)},
    "rigid modes undamped": (LAM[[0, 2, 3]], np.pad(dashpot(2, 40.0), ((1, 0), (1, 0)))),
    "rigid modes alone": (np.zeros(2), dashpot(2, 7.0)),
    "nearly nothing": (LAM, dashpot(4, 1e-300)),
}


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("size", [1e-9, 1e-3, 1.5, 40.0, 1e4])
def test_every_case_at_every_step_size(name: str, size: float) -> None:
    """size = ‖A‖h, by each set of instructions."""
    lam, D = CASES[name]
    h = size / max(np.sqrt(lam.max()), np.abs(D).sum(axis=1).max())
    true = exact(lam, D, h)
    for kernels in kernel_tables():
        assert worst(native_coupled(lam, D, h, kernels), true, lam, D, h) < REQUIRED


def test_a_slow_mode_behind_a_strong_dashpot() -> None:
    """Decay times of 1e-9 s and 1e3 s: the slow one keeps its digits over twelve decades of doublings."""
    lam, D = np.array([1.0, 4.0]), np.array([[1e3, 0.0], [0.0, 1e9]]) + 1e-3 * dashpot(2, 1.0)
    h = 1e3
    assert worst(native_coupled(lam, D, h), exact(lam, D, h), lam, D, h) < 1e-13


@pytest.mark.parametrize("g", [2, 7, 8, 9, 20, 50])
def test_any_number_of_modes(g: int) -> None:
    """As the other twin, whose errors are a few ε‖A‖h; whatever was in the memory before."""
    lam = np.sort(np.random.default_rng(g).uniform(1.0, 1e5, g))
    D = dashpot(g, 30.0) + dashpot(g, 3.0)
    for h in (1e-7, 1e-3, 0.1):
        found, python = native_coupled(lam, D, h), coupled_propagator(lam, D, h)
        for key in ("E11", "E12", "E21", "E22", "G0", "G1", "G2", "G3"):
            difference = np.abs(getattr(found, key) - getattr(python, key)).max()
            assert difference <= 1e-12 * np.abs(getattr(python, key)).max() + 1e-15 * (key == "E11"), key


def test_symmetric_to_the_last_bit() -> None:
    P = native_coupled(LAM, dashpot(4, 5e3), 0.3)
    for array in (P.E12, P.E22, P.G0, P.G1, P.G2, P.G3):
        np.testing.assert_array_equal(array, array.T)


def test_beyond_the_numbers() -> None:
    """An enormous step is the equilibrium G₀ = Λ⁻¹, or no number; never a wrong one."""
    lam, D = np.array([400.0, 1e4]), dashpot(2, 70.0) + np.diag([1.0, 2.0])
    numbers = 0
    for exponent in range(2, 308, 2):  # from a hundred seconds on, when the motion has died down
        G0 = native_coupled(lam, D, 10.0**exponent).G0
        if not np.isnan(G0).all():
            assert np.abs(G0 - np.diag(1 / lam)).max() < 1e-13 / lam[0]
            numbers += 1
    assert numbers == 6  # 1e12 s: ‖A‖h < 1e15
    for D in (dashpot(2, 1e20), np.full((2, 2), np.nan), dashpot(2, 1e308)):
        assert np.isnan(native_coupled(lam, D, 1.0).E22).all()


@settings(max_examples=60, deadline=None)
@given(damped_in_their_measure())
def test_semigroup(system: tuple[Floats, Floats, float]) -> None:
    """Two steps of h/2 are one of h under one polynomial force: E² and E Gₖ + …, in the coordinates of E."""
    lam, D, h = system
    g, half, s = len(lam), h / 2, np.maximum(np.sqrt(lam), 1 / h)
    once, twice = native_coupled(lam, D, h), native_coupled(lam, D, half)
    E = np.block([[twice.E11, twice.E12], [twice.E21, twice.E22]])
    columns = (twice.E12, twice.G0, twice.G1, twice.G2, twice.G3)
    G0, G1, G2, G3 = (np.vstack([G, G_dot]) for G_dot, G in pairwise(columns))
    ends = {
        "E12": (E @ E)[:g, g:] * s[:, None],
        "E22": (E @ E)[g:, g:],
        "G0": (E @ G0 + G0)[:g],
        "G1": (E @ G1 + G1 + half * G0)[:g],
        "G2": (E @ G2 + G2 + half * G1 + half**2 / 2 * G0)[:g],
        "G3": (E @ G3 + G3 + half * G2 + half**2 / 2 * G1 + half**3 / 6 * G0)[:g],
    }
    for key, value in ends.items():
        expected = getattr(once, key) * (s[:, None] if key == "E12" else 1.0)
        size = 1.0 if key.startswith("E") else np.abs(expected).max()
        # unlike C, the products here are taken in both halves
        spread = np.sqrt(lam.max()) / s.min()
        assert np.abs(value - expected).max() <= 1e-14 * (1 + np.sqrt(lam.max()) * h) * (1 + spread) * size
