"""ModelStructure: what each unknown depends on, from where B and C have entries.

Every unknown is made of some modes' q, q̇ and q̈, and q̈ = B u − d q̇ − λ q brings in the rest.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .runtime.model import ReducedModel
from .runtime.variables import layout

Modes = NDArray[np.bool_]


@dataclass(frozen=True)
class Structure:
    """Places of unknowns → places of the knowns they depend on, all as in the list of variables.

    outputs, derivatives: at a communication point, on inputs and states; initial: during initialisation, on
    inputs, parameters and the states that have start values.
    """

    outputs: Mapping[int, list[int]]
    derivatives: Mapping[int, list[int]]
    initial: Mapping[int, list[int]]


@dataclass(frozen=True)
class Motion:
    """The modes whose q, q̇ = v and q̈ = a an unknown is made of, (r,) each."""

    q: Modes
    v: Modes
    a: Modes


def structure(model: ReducedModel) -> Structure:
    """The dependencies of every output, derivative and calculated variable of the model."""
    place, r = layout(model), len(model.lam)
    outputs = {
        place.outputs.start + row: _motion(kind, model.C[row] != 0)
        for row, kind in enumerate(model.output_kinds)
    }
    one = np.eye(r, dtype=bool)
    derivatives = {place.q_dot.start + i: _motion("velocity", one[i]) for i in range(r)}
    derivatives |= {place.v_dot.start + i: _motion("acceleration", one[i]) for i in range(r)}
    unknowns = outputs | derivatives
    if model.initial == "static":
        unknowns |= {place.q.start + i: _motion("displacement", one[i]) for i in range(r)}
    damping = [place.alpha, place.beta]
    initial = {place.damping_ratio.start + i: damping if model.lam[i] > 0 else [] for i in range(r)}
    initial |= {i: _initial(model, motion) for i, motion in unknowns.items()}
    return Structure(
        {i: _running(model, motion) for i, motion in outputs.items()},
        {i: _running(model, motion) for i, motion in derivatives.items()},
        {i: initial[i] for i in sorted(initial)},
    )


def _motion(kind: str, modes: Modes) -> Motion:
    none = np.zeros_like(modes)
    match kind:
        case "displacement":
            return Motion(modes, none, none)
        case "velocity":
            return Motion(none, modes, none)
        case _:
            return Motion(none, none, modes)


def _running(model: ReducedModel, motion: Motion) -> list[int]:
    """On the inputs that drive q̈, and on q and v; a rigid mode's q̈ has no λq."""
    place = layout(model)
    stiff = model.lam > 0
    return [
        *_inputs(model, motion.a),
        *(place.q.start + np.flatnonzero(motion.q | (motion.a & stiff))).tolist(),
        *(place.v.start + np.flatnonzero(motion.v | motion.a)).tolist(),
    ]


def _initial(model: ReducedModel, motion: Motion) -> list[int]:
    """The same with α, β and modes.active as knowns.

    In a static start q follows the inputs, and B u − λ q = 0 leaves −d q̇ of q̈.
    """
    place = layout(model)
    if model.initial == "static":
        known = [
            *_inputs(model, motion.q),
            *(place.v.start + np.flatnonzero(motion.v | motion.a)).tolist(),
        ]
    else:
        known = _running(model, motion)
    known += [place.alpha] if motion.a.any() else []
    known += [place.beta] if (motion.a & (model.lam > 0)).any() else []  # d = α + βλ
    return sorted([*known, place.size]) if known else []  # modes.active stands behind the Reals


def _inputs(model: ReducedModel, modes: Modes) -> list[int]:
    """The inputs with an entry in these rows of B; they stand first among the variables."""
    found: list[int] = np.flatnonzero((model.B[modes] != 0).any(axis=0)).tolist()
    return found
