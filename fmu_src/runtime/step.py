"""Modal state, its exact advance over a step, and its equilibrium."""

from dataclasses import dataclass

import numpy as np

from .model import Floats
from .propagator import Propagator


@dataclass(frozen=True)
class State:
    """Modal amplitudes q and velocities q̇ = v, (r,) each, in kg^½·m and kg^½·m/s."""

    q: Floats
    v: Floats


def at_rest(r: int) -> State:
    """q = v = 0 for r modes."""
    return State(np.zeros(r), np.zeros(r))


def step(
    P: Propagator, state: State, f: Floats, f_dot: Floats | float = 0.0, f_ddot: Floats | float = 0.0
) -> State:
    """[q, v](t+h) = E(h) [q, v](t) + G₀(h) f + G₁(h) ḟ + G₂(h) f̈, exact for the force f + ḟ s + f̈ s²/2.

    f: (r,) modal forces Bu at the start of the step, f_dot, f_ddot: (r,) their first two rates there [2.33].
    """
    q, v = state.q, state.v
    return State(
        P.E11 * q + P.E12 * v + P.G0 * f + P.G1 * f_dot + P.G2 * f_ddot,
        P.E21 * q + P.E22 * v + P.E12 * f + P.G0 * f_dot + P.G1 * f_ddot,
    )


def acceleration(lam: Floats, d: Floats, state: State, f: Floats) -> Floats:
    """q̈ = f − d q̇ − λ q, (r,) [2.32]."""
    return f - d * state.v - lam * state.q


def static_solution(lam: Floats, f: Floats) -> State:
    """qᵢ = fᵢ/kᵢ with kᵢ = λᵢ > 0, at rest [2.35, 2.36]."""
    return State(f / lam, np.zeros_like(lam))


def keep_modes(state: State, active: int) -> State:
    """Level of detail: the first `active` modes as they are, the others at rest."""
    q, v = state.q.copy(), state.v.copy()
    q[active:] = 0.0
    v[active:] = 0.0
    return State(q, v)
