"""ModelStructure: what each unknown depends on, from where B, C, R and D_rest have entries.

Every unknown is made of some modes' q, q̇ and q̈ and of some inputs at once, and q̈ = B u − D̃ q̇ − λ q brings
in the rest.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .runtime.kinds import Law
from .runtime.model import ReducedModel, row_starts
from .runtime.variables import layout

Bools = NDArray[np.bool_]


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
class Content:
    """What an unknown is made of: modes by their q, q̇ = v and q̈ = a, (r,) each, and inputs u (m,).

    follows: it has the static part of modes that are off (`residual`), so in equilibrium it lacks nothing;
    free_of_alpha: its accelerations are q̈ + αq̇, as those of a reaction: forces of the body, without α's drag.
    """

    q: Bools
    v: Bools
    a: Bools
    u: Bools
    follows: bool = False
    free_of_alpha: bool = False


def structure(model: ReducedModel) -> Structure:
    """The dependencies of every output, derivative and calculated variable of the model."""
    place, r = layout(model), len(model.lam)
    starts = row_starts(model.laws)
    outputs = {
        place.outputs.start + k: _output(model, law, slice(starts[k], starts[k + 1]))
        for k, law in enumerate(model.laws)
    }
    one, none, no_input = (
        np.eye(r, dtype=bool),
        np.zeros(r, dtype=bool),
        np.zeros(len(model.inputs), dtype=bool),
    )
    derivatives = {place.q_dot.start + i: Content(none, one[i], none, no_input) for i in range(r)}
    derivatives |= {place.v_dot.start + i: Content(none, none, one[i], no_input) for i in range(r)}
    unknowns = outputs | derivatives
    if model.initial == "static":
        unknowns |= {place.q.start + i: Content(one[i], none, none, no_input) for i in range(r)}
    damping = [place.alpha, place.beta]
    initial = {place.damping_ratio.start + i: damping if model.lam[i] > 0 else [] for i in range(r)}
    initial |= {i: _initial(model, content) for i, content in unknowns.items()}
    return Structure(
        {i: _running(model, content) for i, content in outputs.items()},
        {i: _running(model, content) for i, content in derivatives.items()},
        {i: initial[i] for i in sorted(initial)},
    )


def _output(model: ReducedModel, law: Law, rows: slice) -> Content:
    C, R = model.C[rows], model.R[rows]
    modes, through = (C != 0).any(axis=0), (R != 0).any(axis=0)
    none = np.zeros_like(modes)
    match law:
        case "position" | "mises":
            return Content(modes, none, none, through | _follows(model, modes), follows=model.residual)
        case "velocity":
            return Content(none, modes, none, np.zeros_like(through))
        case "acceleration":
            return Content(none, none, modes, through)
        case "reaction":
            return Content(none, C[1] != 0, C[0] != 0, through, free_of_alpha=True)
        case "kinetic":
            return Content(none, ~none, none, np.zeros(len(model.inputs), dtype=bool))
        case "strain":
            stiff = model.lam > 0
            return Content(
                stiff, none, none, (model.R_in != 0).any(axis=0) | _follows(model, stiff), model.residual
            )


def _follows(model: ReducedModel, modes: Bools) -> Bools:
    """The inputs that move these modes at once when they are switched off and follow statically."""
    if not model.residual:
        return np.zeros(len(model.inputs), dtype=bool)
    return _driven(model, modes & (model.lam > 0))


def _driven(model: ReducedModel, modes: Bools) -> Bools:
    """The inputs with an entry in these rows of B."""
    found: Bools = (model.B[modes] != 0).any(axis=0)
    return found


def _damped_by(model: ReducedModel, content: Content) -> Bools:
    """The modes whose velocities are in the accelerations; α, β may be tuned to anything."""
    own = model.D_rest != 0
    own |= np.diag(model.lam > 0) if content.free_of_alpha else np.eye(len(own), dtype=bool)
    found: Bools = own[content.a].any(axis=0)
    return found


def _running(model: ReducedModel, content: Content) -> list[int]:
    """On the inputs that are in it or drive q̈, and on q and v; a rigid mode's q̈ has no λq."""
    place = layout(model)
    stiff = model.lam > 0
    return [
        *np.flatnonzero(content.u | _driven(model, content.a)).tolist(),
        *(place.q.start + np.flatnonzero(content.q | (content.a & stiff))).tolist(),
        *(place.v.start + np.flatnonzero(content.v | _damped_by(model, content))).tolist(),
    ]


def _initial(model: ReducedModel, content: Content) -> list[int]:
    """The same with α, β and modes.active as knowns.

    In a static start q follows the inputs, and B u − λ q = 0 leaves −D̃ q̇ of q̈.
    """
    place = layout(model)
    static = model.initial == "static"
    switched = content.v.any() or content.a.any() or (content.q.any() and not (static and content.follows))
    if static:
        known = [
            *np.flatnonzero(content.u | _driven(model, content.q)).tolist(),
            *(place.v.start + np.flatnonzero(content.v | _damped_by(model, content))).tolist(),
        ]
    else:
        known = _running(model, content)
    known += [place.alpha] if content.a.any() and not content.free_of_alpha else []
    known += [place.beta] if (content.a & (model.lam > 0)).any() else []  # d = α + βλ
    # modes.active stands behind the Reals
    return sorted([*known, place.size]) if known and switched else sorted(known)
