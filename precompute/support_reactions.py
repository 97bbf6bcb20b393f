"""The force of a support on the body, from the reduced motion."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csc_array, csr_array

from .arrays import Floats, Ints
from .dofs import Dofs
from .errors import PartError
from .notice import notice
from .system import System

Statics = Callable[[Floats], Floats]
"""b (n, k) → K⁺ b (n, k) in all DOFs, 0 at those held (`static_solver`)."""

Resting = Callable[[Floats], Floats]
"""ψ (n,) → ψ with the ports whose motion is prescribed moved back to where they were."""


def all_at_rest(psi: Floats) -> Floats:
    """No port's motion is prescribed."""
    return psi


@dataclass(frozen=True)
class Held:
    """The DOFs that one support holds; its name, if it has one, and outputs such as "reaction.x"."""

    dofs: Ints
    name: str = ""
    outputs: tuple[str, ...] = ()


def own_dofs(supports: Sequence[Held]) -> list[Held]:
    """The same supports without the DOFs that one before them holds too: every DOF has one reaction.

    A notice where that takes something from a reaction.
    """
    own: list[Held] = []
    taken = np.zeros(0, dtype=np.int64)
    for support in supports:
        left = np.setdiff1d(support.dofs, taken)
        if support.outputs and len(left) < len(np.unique(support.dofs)):
            notice(
                f"support {support.name}: a support before it in the file holds some of its nodes too; their "
                "reaction counts there"
            )
        own.append(replace(support, dofs=left))
        taken = np.union1d(taken, support.dofs)
    return own


def reaction_shape(
    support: Held, axis: int, dofs: Dofs, system: System, solve: Statics, resting: Resting = all_at_rest
) -> Floats:
    """ψ (n,): 1 at the support's DOFs in direction `axis`, 0 at all others held, K ψ = 0 at those free.

    With such a ψ the reaction R = Σ (M ü + D u̇ + K u − F) over these DOFs is
    R = ψᵀM ü + ψᵀD u̇ + ψᵀK u − ψᵀF,
    because M ü + D u̇ + K u − F vanishes at the free DOFs, or does no work on ψ, in which ports whose motion
    is prescribed rest. Of ψᵀK u only such motions are left (u vanishes at the supports): the elastic forces
    need no sum over the modes, and the static reaction is exact with any number of them.
    Where the supports leave rigid modes ψ is fixed up to these, and any of them gives the same R.
    Source: Craig & Kurdila, Fundamentals of Structural Dynamics, 2nd ed., 17.3 (constraint modes).
    Raises PartError: the support holds nothing in that direction.
    """
    unit = np.zeros(len(dofs.node))
    unit[support.dofs[dofs.direction[support.dofs] == axis]] = 1.0
    if not unit.any():
        raise PartError(
            f"support {support.name}: got the output reaction.{'xyz'[axis]}, but it holds no DOF in "
            f'{"xyz"[axis]} of its own; add "{"xyz"[axis]}" to its fix, or remove the output'
        )
    unit = resting(unit)
    psi: Floats = unit - solve((system.K @ unit)[:, None])[:, 0]
    return psi


def reaction_rows(
    psi: Floats, elastic: Floats, system: System, dashpots: Sequence[tuple[csr_array, float]], b: csc_array
) -> tuple[Floats, Floats]:
    """The rows ψᵀM, ψᵀD, ψᵀK as (3, n) and the feed-through −ψᵀb, 0, 0 as (3, m).

    elastic: (n,) ψ less a rigid motion of the whole part, which adds nothing to ψᵀK; D = system.D + Σ c wᵀw,
    dashpots (w (1, n), c). Rayleigh's α M and β K are added where α and β are known, and modal ratios are
    forces inside the body.
    """
    D_psi = np.zeros(len(psi)) if system.D is None else system.D @ psi
    for w, c in dashpots:
        D_psi = D_psi + c * (w.T @ (w @ psi))
    direct = -(b.T @ psi)
    none = np.zeros_like(direct)
    return np.stack([system.M @ psi, D_psi, system.K @ elastic]), np.stack([direct, none, none])
