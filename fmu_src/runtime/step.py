"""The state, its exact advance over a step, and its equilibrium.

A prescribed motion s̈ = a (model.py) is stepped as a mode without stiffness and damping; its velocity is a
polynomial in time, so what it drags is a force of one degree more than the inputs.
"""

from dataclasses import dataclass

import numpy as np

from .coupled import CoupledPropagator
from .model import Floats
from .propagator import Propagator


@dataclass(frozen=True)
class State:
    """Amplitudes q and velocities q̇ = v, (r,) each, in kg^½·m and kg^½·m/s; or x and ẋ of a whole model."""

    q: Floats
    v: Floats


def at_rest(r: int) -> State:
    """q = v = 0 for r modes."""
    return State(np.zeros(r), np.zeros(r))


def step(P: Propagator, state: State, f: Floats, *rates: Floats) -> State:
    """[q, v](t+h) = E(h) [q, v](t) + G₀(h) f + G₁(h) ḟ + …, exact for the force f + ḟ τ + f̈ τ²/2 + f⃛ τ³/6.

    f: (r,) modal forces Bu at the start of the step, rates: (r,) each, up to three derivatives there [2.33].
    """
    q, v = state.q, state.v
    q, v = P.E11 * q + P.E12 * v + P.G0 * f, P.E21 * q + P.E22 * v + P.E12 * f
    for G, G_dot, rate in zip((P.G1, P.G2, P.G3), (P.G0, P.G1, P.G2), rates, strict=False):
        q, v = q + G * rate, v + G_dot * rate
    return State(q, v)


def coupled_step(P: CoupledPropagator, state: State, f: Floats, *rates: Floats) -> State:
    """The same for modes that damping couples: state and forces are those of the group alone, (g,) each."""
    q, v = P.E11 @ state.q + P.E12 @ state.v + P.G0 @ f, P.E21 @ state.q + P.E22 @ state.v + P.E12 @ f
    for G, G_dot, rate in zip((P.G1, P.G2, P.G3), (P.G0, P.G1, P.G2), rates, strict=False):
        q, v = q + G @ rate, v + G_dot @ rate
    return State(q, v)


def acceleration(lam: Floats, d: Floats, D_off: Floats | None, state: State, f: Floats) -> Floats:
    """q̈ = f − D̃ q̇ − λ q, (r,) [2.32]; d (r,) the diagonal of D̃, D_off (r, r) the rest of it, if any."""
    a = f - d * state.v - lam * state.q
    return a if D_off is None else a - D_off @ state.v


def static_solution(lam: Floats, f: Floats) -> State:
    """qᵢ = fᵢ/kᵢ with kᵢ = λᵢ > 0, at rest [2.35, 2.36]."""
    return State(f / lam, np.zeros_like(lam))


def keep_modes(state: State, active: int) -> State:
    """Level of detail: the first `active` coordinates as they are, the modes behind them at rest."""
    q, v = state.q.copy(), state.v.copy()
    q[active:] = 0.0
    v[active:] = 0.0
    return State(q, v)
