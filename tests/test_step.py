"""The step itself: closed forms of one oscillator, semigroup, energy balance, statics."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import expm

from fmu_src.runtime.propagator import propagator
from fmu_src.runtime.step import State, acceleration, at_rest, keep_modes, static_solution, step

ONE = np.ones(1)
EPS = np.finfo(float).eps


def response_to_unit_force(lam: float, d: float, h: float, steps: int) -> np.ndarray:
    P = propagator(lam * ONE, d * ONE, h)
    state, q = at_rest(1), []
    for _ in range(steps):
        state = step(P, state, ONE)
        q.append(state.q[0])
    return np.array(q)


def step_response(lam: float, d: float, t: np.ndarray) -> np.ndarray:
    """Unit force from t = 0 on a body at rest: textbook forms, each case by itself."""
    if lam == 0:
        return t**2 / 2 if d == 0 else t / d - (1 - np.exp(-d * t)) / d**2
    omega, zeta = math.sqrt(lam), d / (2 * math.sqrt(lam))
    if zeta < 1:
        w = omega * math.sqrt(1 - zeta**2)
        return (1 - np.exp(-zeta * omega * t) * (np.cos(w * t) + zeta * omega / w * np.sin(w * t))) / lam
    if zeta == 1:
        return (1 - np.exp(-omega * t) * (1 + omega * t)) / lam
    fast, slow = (omega * (zeta + s * math.sqrt(zeta**2 - 1)) for s in (1, -1))
    return (1 - (fast * np.exp(-slow * t) - slow * np.exp(-fast * t)) / (fast - slow)) / lam


@pytest.mark.parametrize(
    ("lam", "d"),
    [(9.0, 0.6), (9.0, 6.0), (9.0, 60.0), (9.0, 0.0), (0.0, 0.0), (0.0, 2.0)],
    ids=["under-damped", "critical", "over-damped", "undamped", "rigid free", "rigid damped"],
)
@pytest.mark.parametrize("h", [0.01, 0.3, 7.0])
def test_each_damping_case(lam: float, d: float, h: float) -> None:
    q = response_to_unit_force(lam, d, h, 40)
    reference = step_response(lam, d, h * np.arange(1, 41))
    bound = 400 * EPS * (1 + 3 * h) * np.abs(reference).max()  # 40 steps, each with a few roundings
    assert np.abs(q - reference).max() <= bound
    other = step_response(lam * (1 + 1e-6), d * (1 + 1e-6), h * np.arange(1, 41) * (1 + 1e-6))
    assert np.abs(q - other).max() > 100 * bound  # which would see a part in a million


RATES = st.floats(-4, 4).map(lambda x: 10.0**x)


@settings(max_examples=300, deadline=None)
@given(
    lam=st.one_of(st.just(0.0), RATES),
    d=st.one_of(st.just(0.0), RATES),
    h=st.floats(-4, 2).map(lambda x: 10.0**x),
    split=st.floats(0.05, 0.95),
    start=st.tuples(*[st.one_of(st.just(0.0), st.floats(1e-100, 1), st.floats(-1, -1e-100))] * 5),
)
def test_semigroup(lam: float, d: float, h: float, split: float, start: tuple[float, ...]) -> None:
    """Two steps h₁ + h₂ = one of h under the same quadratic force, whatever the damping."""
    q, v, f, f_dot, f_ddot = start
    lam_, d_ = lam * ONE, d * ONE
    h1 = split * h
    h2 = h - h1
    state = State(q * ONE, v * ONE)
    whole = step(propagator(lam_, d_, h), state, f * ONE, f_dot * ONE, f_ddot * ONE)
    half = step(propagator(lam_, d_, h1), state, f * ONE, f_dot * ONE, f_ddot * ONE)
    there, rate_there = f + f_dot * h1 + f_ddot * h1**2 / 2, f_dot + f_ddot * h1
    both = step(propagator(lam_, d_, h2), half, there * ONE, rate_there * ONE, f_ddot * ONE)
    # rounding of h and ω becomes a phase of ωh roundings; the terms that are summed set the scale
    P = propagator(lam_, d_, h)
    force = abs(f) + abs(f_dot) * h + abs(f_ddot) * h**2
    q_scale = max(abs(q), abs(half.q[0])) + min(h, 1 / max(d, math.sqrt(lam), 1e-300)) * max(
        abs(v), abs(half.v[0])
    )
    q_scale += float(P.G0[0]) * force + abs(whole.q[0])
    rate = math.sqrt(lam) + (d if d * h > 1 else 0.0)
    v_scale = max(abs(v), abs(half.v[0])) + rate * q_scale + min(h, 1 / max(d, 1e-300)) * force
    bound = 60 * EPS * (1 + math.sqrt(lam) * h)
    assert abs(whole.q[0] - both.q[0]) <= bound * q_scale
    assert abs(whole.v[0] - both.v[0]) <= bound * v_scale


def test_quadratic_force_is_exact() -> None:
    """Over-, critically, under-damped and rigid modes at once against expm of the augmented matrix."""
    lam = np.array([0.0, 4.0, 4.0, 4.0])
    d = np.array([0.5, 0.4, 4.0, 40.0])
    rng = np.random.default_rng(1)
    q, v, f, f_dot, f_ddot = rng.standard_normal((5, 4))
    h = 0.8
    after = step(propagator(lam, d, h), State(q, v), f, f_dot, f_ddot)
    for i in range(4):
        A = np.zeros((5, 5))  # of q, q̇, f, ḟ, f̈
        A[0, 1] = A[1, 2] = A[2, 3] = A[3, 4] = 1.0
        A[1, :2] = -lam[i], -d[i]
        exact = expm(A * h) @ [q[i], v[i], f[i], f_dot[i], f_ddot[i]]
        np.testing.assert_allclose([after.q[i], after.v[i]], exact[:2], rtol=1e-13)  # expm's own rounding
        for rates in ([0.0, f_ddot[i]], [f_dot[i], 0.0]):
            other = expm(A * h) @ [q[i], v[i], f[i], *rates]
            assert abs(other[0] - after.q[i]) > 1e-4  # each rate of the force matters here


def test_energy_balance() -> None:
    """Work of the force = energy stored + energy dissipated, over steps of many sizes."""
    lam, d = np.array([0.0, 30.0, 500.0]), np.array([0.2, 0.5, 60.0])
    rng = np.random.default_rng(2)
    state, work, lost = at_rest(3), np.zeros(3), np.zeros(3)
    x, w = np.polynomial.legendre.leggauss(40)
    for h in rng.uniform(1e-3, 0.2, 60):
        f, f_dot = rng.standard_normal((2, 3))
        for x_k, w_k in zip(h * (x + 1) / 2, h * w / 2, strict=True):  # power inside the step by quadrature
            inside = step(propagator(lam, d, x_k), state, f, f_dot)
            work += w_k * (f + f_dot * x_k) * inside.v
            lost += w_k * d * inside.v**2
        state = step(propagator(lam, d, h), state, f, f_dot)
    stored = state.v**2 / 2 + lam * state.q**2 / 2
    np.testing.assert_allclose(work, stored + lost, rtol=1e-11)  # 60 × 40 quadrature points of rounding
    assert (lost > 0.1 * work).all()  # the balance has both terms
    assert (stored > 1e-3 * work).all()


def test_acceleration_is_the_derivative_of_velocity() -> None:
    lam, d, f = np.array([0.0, 50.0]), np.array([0.3, 2.0]), np.array([1.0, -2.0])
    state = State(np.array([0.4, 0.1]), np.array([-1.0, 3.0]))
    a = acceleration(lam, d, None, state, f)
    h = 1e-4
    ahead = step(propagator(lam, d, h), state, f)
    further = step(propagator(lam, d, 2 * h), state, f)
    difference = (-3 * state.v + 4 * ahead.v - further.v) / (2 * h)
    np.testing.assert_allclose(difference, a, rtol=1e-5)  # O(h²) with ω²h² = 5e-7 and rounding/h


def test_static_solution_is_where_motion_ends() -> None:
    """qᵢ = fᵢ/kᵢ stays put, and a damped body arrives there [2.36]."""
    lam, f = np.array([2.0, 1e4, 3e8]), np.array([1.0, -5.0, 2.0])
    rest = static_solution(lam, f)
    P = propagator(lam, 2 * 0.1 * np.sqrt(lam), 1000.0)
    stays, arrives = step(P, rest, f), step(P, at_rest(3), f)
    np.testing.assert_allclose(stays.q, f / lam, rtol=1e-14)
    np.testing.assert_allclose(arrives.q, f / lam, rtol=1e-14)
    assert np.abs(acceleration(lam, 0 * lam, None, rest, f)).max() < 1e-14


def test_modes_switched_off_are_at_rest() -> None:
    kept = keep_modes(State(np.arange(1.0, 4), np.arange(4.0, 7)), 2)
    assert kept.q.tolist() == [1, 2, 0]
    assert kept.v.tolist() == [4, 5, 0]
