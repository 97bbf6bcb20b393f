"""ModelStructure: what each unknown depends on, from where B, C, R and D_rest have entries.

Every unknown is made of some coordinates' x, ẋ and ẍ and of some inputs at once, and s̈ = a,
q̈ = B u + N ṡ − D̃ q̇ − λ q bring in the rest.
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
    """What an unknown is made of: coordinates by x = q, ẋ = v and ẍ = a, (k + r,) each, and inputs u (m,).

    follows: it has the static part of modes that are off (`residual`), so in equilibrium it lacks nothing;
    beta: there is a β in it beside those of the accelerations;
    free_of_alpha: its accelerations are ẍ + αẋ, as those of a reaction: forces of the body, without α's drag
    on the modes.
    """

    q: Bools
    v: Bools
    a: Bools
    u: Bools
    follows: bool = False
    beta: bool = False
    free_of_alpha: bool = False


def structure(model: ReducedModel) -> Structure:
    """The dependencies of every output, derivative and calculated variable of the model."""
    place, k, n = layout(model), model.k, len(model.lam)
    starts = row_starts(model.laws)
    outputs = {
        place.outputs.start + k: _output(model, law, slice(starts[k], starts[k + 1]))
        for k, law in enumerate(model.laws)
    }
    one, none, no_input = (
        np.eye(n, dtype=bool),
        np.zeros(n, dtype=bool),
        np.zeros(len(model.inputs), dtype=bool),
    )
    derivatives = {place.q_dot.start + i: Content(none, one[i], none, no_input) for i in range(n)}
    derivatives |= {place.v_dot.start + i: Content(none, none, one[i], no_input) for i in range(n)}
    unknowns = outputs | derivatives
    if model.initial == "static":
        unknowns |= {place.q.start + i: Content(one[i], none, none, no_input) for i in range(k, n)}
    damping = [place.alpha, place.beta]
    initial = {
        place.damping_ratio.start + i: damping if lam > 0 else [] for i, lam in enumerate(model.lam[k:])
    }
    initial |= {i: _initial(model, content) for i, content in unknowns.items()}
    for states, starts_at in ((place.q, place.start.start), (place.v, place.start.start + k)):
        initial |= {states.start + j: [starts_at + j] for j in range(k)}
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
            elastic = C[2] != 0
            velocities = (C[1] != 0) | elastic
            return Content(
                elastic, velocities, C[0] != 0, through, beta=bool(elastic.any()), free_of_alpha=True
            )
        case "kinetic":
            return Content(none, ~none, none, np.zeros(len(model.inputs), dtype=bool))
        case "strain":
            stiff = model.lam > 0
            through = (model.R_in != 0).any(axis=0) | _follows(model, stiff)
            stretched = stiff.copy()
            stretched[: model.k] = (model.K_s != 0).any(axis=0)
            return Content(stretched, none, none, through, follows=model.residual)


def _follows(model: ReducedModel, modes: Bools) -> Bools:
    """The inputs that move these modes at once when they are switched off and follow statically."""
    if not model.residual:
        return np.zeros(len(model.inputs), dtype=bool)
    return _driven(model, modes & (model.lam > 0))


def _driven(model: ReducedModel, modes: Bools) -> Bools:
    """The inputs with an entry in these rows of B."""
    found: Bools = (model.B[modes] != 0).any(axis=0)
    return found


def _drag(model: ReducedModel) -> tuple[Bools, Bools]:
    """Where αB_a and ΦᵀDΨ, which are N, have entries, (k + r, k) each."""
    by_alpha, by_dashpots = model.B[:, model.motions] != 0, model.D_rest[:, : model.k] != 0
    by_alpha[: model.k] = by_dashpots[: model.k] = False
    return by_alpha, by_dashpots


def _dragging(model: ReducedModel, modes: Bools) -> Bools:
    """The coordinates whose velocities are in N ṡ of these modes, (k + r,); α may be tuned to anything."""
    found = np.zeros_like(modes)
    found[: model.k] = np.logical_or(*_drag(model))[modes].any(axis=0)
    return found


def _braked(model: ReducedModel, content: Content) -> Bools:
    """The coordinates whose velocities are in its accelerations by −D̃ q̇, or +αẋ; α, β may be tuned."""
    mode = _modes(model)
    own = (model.D_rest != 0) & mode & mode[:, None]
    own |= np.diag((model.lam > 0) | ~mode if content.free_of_alpha else mode)
    found: Bools = own[content.a].any(axis=0)
    return found


def _modes(model: ReducedModel) -> Bools:
    """The coordinates that are modes."""
    found: Bools = np.arange(len(model.lam)) >= model.k
    return found


def _running(model: ReducedModel, content: Content) -> list[int]:
    """On the inputs that are in it or drive ẍ, and on x and ẋ; a rigid mode's q̈ has no λq."""
    place = layout(model)
    velocities = content.v | _braked(model, content) | _dragging(model, content.a)
    return [
        *np.flatnonzero(content.u | _driven(model, content.a)).tolist(),
        *(place.q.start + np.flatnonzero(content.q | (content.a & (model.lam > 0)))).tolist(),
        *(place.v.start + np.flatnonzero(velocities)).tolist(),
    ]


def _resting(model: ReducedModel, content: Content) -> list[int]:
    """In a static start: λ q = B u + N ṡ leaves −D̃ q̇ of q̈."""
    place, mode = layout(model), _modes(model)
    velocities = content.v | _braked(model, content) | _dragging(model, content.q)
    return [
        *np.flatnonzero(content.u | _driven(model, (content.q & mode) | (content.a & ~mode))).tolist(),
        *(place.q.start + np.flatnonzero(content.q & ~mode)).tolist(),
        *(place.v.start + np.flatnonzero(velocities)).tolist(),
    ]


def _initial(model: ReducedModel, content: Content) -> list[int]:
    """The same with α, β, modes.active as knowns, and with the starts of s and ṡ in place of these."""
    place, k, mode = layout(model), model.k, _modes(model)
    static = model.initial == "static"
    starts = {place.q.start + j: place.start.start + j for j in range(k)}
    starts |= {place.v.start + j: place.start.start + k + j for j in range(k)}
    found = _resting(model, content) if static else _running(model, content)
    known = [starts.get(i, i) for i in found]
    by_alpha, by_dashpots = (part.any(axis=1) for part in _drag(model))
    stays = content.q & mode  # of a mode that is switched off, what follows statically
    if static and content.follows:
        stays &= by_alpha | by_dashpots
    switched = ((content.v | content.a) & mode).any() or stays.any()
    # ẍ + αẋ is a + αṡ of a motion, and of a mode what is left of it without damping
    own = ~mode | (by_alpha & (not static)) if content.free_of_alpha else mode
    known += [place.alpha] if (content.a & own).any() or (static and (content.q & by_alpha).any()) else []
    known += [place.beta] if content.beta or (content.a & (model.lam > 0)).any() else []  # d = α + βλ
    # modes.active stands behind the Reals
    return sorted([*known, place.size]) if known and switched else sorted(known)
