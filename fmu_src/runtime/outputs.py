"""What is measured: every output from q, q̇, q̈ and the inputs, by the law of its kind."""

from dataclasses import dataclass

import numpy as np

from .kinds import STATIC_LAWS, Law
from .model import Floats, Ints, ReducedModel, row_starts
from .step import State


@dataclass(frozen=True)
class Rows:
    """The outputs of one law: their places (k,), and their rows of C and R one below the other."""

    places: Ints
    C: Floats
    R: Floats | None


@dataclass(frozen=True)
class Feedthrough:
    """R: (s, m) and R_in: (m, m) of the modes that are active."""

    R: Floats
    R_in: Floats


def feedthrough(model: ReducedModel, active: int) -> Feedthrough:
    """R + Σ Cᵢ Bᵢ/λᵢ and R_in + Σ Bᵢ Bᵢᵀ/λᵢ over the elastic modes i that are off but follow statically.

    active: how many of the coordinates move.

    Only positions and velocities have the sum: what is off has no acceleration.
    """
    off = np.arange(len(model.lam)) >= active
    off &= model.lam > 0
    if not (model.residual and off.any()):
        return Feedthrough(model.R, model.R_in)
    flexible = model.B[off] / model.lam[off, None]
    R = model.R.copy()
    starts = row_starts(model.laws)
    for k, law in enumerate(model.laws):
        if law in STATIC_LAWS:
            rows = slice(starts[k], starts[k + 1])
            R[rows] += model.C[rows][:, off] @ flexible
    return Feedthrough(R, model.R_in + model.B[off].T @ flexible)


def rows_by_law(model: ReducedModel, R: Floats) -> dict[Law, Rows]:
    """The outputs gathered by law; R is left out where all of it is 0."""
    starts = np.array(row_starts(model.laws))
    laws = np.array(model.laws, dtype=object)
    found: dict[Law, Rows] = {}
    for law in dict.fromkeys(model.laws):
        places = np.flatnonzero(laws == law)
        rows = np.concatenate([np.arange(starts[k], starts[k + 1]) for k in places])
        through = R[rows]
        found[law] = Rows(places, np.ascontiguousarray(model.C[rows]), through if through.any() else None)
    return found


def outputs(
    model: ReducedModel,
    rows: dict[Law, Rows],
    R_in: Floats,
    damping: tuple[float, float],
    state: State,
    a: Floats,
    u: Floats,
) -> Floats:
    """y: (p,) in the units of kinds.py; the inputs are held, so that velocities have no R u̇.

    rows: of `rows_by_law`; R_in: (m, m); damping: α in 1/s, β in s; state: x, ẋ; a: (k + r,) ẍ; u: (m,).
    """
    alpha, beta = damping
    y = np.zeros(sum(len(one.places) for one in rows.values()))
    q, v = state.q, state.v
    for law, one in rows.items():
        match law:
            case "position":
                y[one.places] = _linear(one, q, u)
            case "velocity":
                y[one.places] = one.C @ v
            case "acceleration":
                y[one.places] = _linear(one, a, u)
            case "reaction":
                through = 0.0 if one.R is None else (one.R @ u)[::3]
                inertia, dashpots = one.C[::3] @ (a + alpha * v), one.C[1::3] @ v
                y[one.places] = inertia + dashpots + one.C[2::3] @ (q + beta * v) + through
            case "mises":
                y[one.places] = mises(_linear(one, q, u).reshape(-1, 6))
            case "kinetic":
                y[one.places] = 0.5 * kinetic_form(model, v)
            case "strain":
                y[one.places] = 0.5 * (strain_form(model, q) + u @ R_in @ u)
    return y


def kinetic_form(model: ReducedModel, v: Floats) -> float:
    """q̇ᵀq̇ + 2 q̇ᵀP ṡ + ṡᵀM_s ṡ with P = ΦᵀMΨ = −B_a: twice the energy of the whole motion Ψ ṡ + Φ q̇."""
    if model.k == 0:
        return float(v @ v)
    s_dot, q_dot = np.split(v, [model.k])
    P = -model.B[model.k :, model.motions]
    return float(q_dot @ q_dot + 2 * (q_dot @ (P @ s_dot)) + s_dot @ model.M_s @ s_dot)


def strain_form(model: ReducedModel, q: Floats) -> float:
    """qᵀΛq + sᵀK_s s: twice the strain energy, to which Ψ s and Φ q have no part in common."""
    s = q[: model.k]
    own = float(q @ (model.lam * q))
    return own + float(s @ model.K_s @ s) if model.k else own


def _linear(rows: Rows, motion: Floats, u: Floats) -> Floats:
    """C x + R u."""
    y: Floats = rows.C @ motion
    return y if rows.R is None else y + rows.R @ u


def mises(stress: Floats) -> Floats:
    """√(½[(σxx − σyy)² + (σyy − σzz)² + (σzz − σxx)²] + 3(σxy² + σyz² + σzx²)): (k,) from (k, 6), Pa."""
    xx, yy, zz, xy, yz, zx = stress.T
    value: Floats = np.sqrt(
        0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) + 3 * (xy**2 + yz**2 + zx**2)
    )
    return value
