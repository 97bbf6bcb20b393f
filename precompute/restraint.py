"""What the supports hold of the full model, and which rigid motions they leave."""

from dataclasses import dataclass

import numpy as np

from .arrays import Bools, Floats, Ints
from .errors import EigenError
from .notice import notice
from .rigid import rigid_modes
from .system import System
from .zero_energy import Where, refuse_dofs_without_stiffness, refuse_loose_pieces


@dataclass(frozen=True)
class Restraint:
    """held: (n,), which DOFs the supports hold; rigid: (n, k) kg^-1/2, M-orthonormal, what they leave."""

    held: Bools
    rigid: Floats

    @property
    def free(self) -> Ints:
        """The DOFs that are not held, ascending."""
        return np.flatnonzero(~self.held)


def restrain(system: System, fixed: Ints, where: Where) -> Restraint:
    """The supports of a sound model; where: DOF → its place, for messages.

    Raises EigenError: fixed DOFs that do not exist, nothing free, K or M that is not finite or has a negative
    diagonal. ZeroEnergyError: DOFs without stiffness, loose pieces.
    """
    n = system.K.shape[0]
    if len(fixed) and not (np.min(fixed) >= 0 and np.max(fixed) < n):
        raise EigenError(f"fixed: got DOFs {np.min(fixed)} to {np.max(fixed)}, expected 0 to {n - 1}")
    held = np.zeros(n, dtype=bool)
    held[fixed] = True
    if held.all():
        raise EigenError("support: got all DOFs held, expected some that are free; take a support out")
    _check_matrices(system, where)
    refuse_dofs_without_stiffness(system.K, ~held, where)
    rigid = rigid_modes(system, np.flatnonzero(held))
    refuse_loose_pieces(system, held, rigid.shape[1], where)
    return Restraint(held, rigid)


def tell_rigid(rigid: Floats) -> None:
    """A notice where the supports leave rigid modes, the columns of rigid."""
    if rigid.shape[1]:
        notice(f"rigid modes: {rigid.shape[1]}, the supports leave the part free to move")


def _check_matrices(system: System, where: Where) -> None:
    for name, A in (("K", system.K), ("M", system.M)):
        if not np.all(np.isfinite(A.data)):
            raise EigenError(
                f"{name}: got NaN or infinite entries, expected finite ones; check the materials"
            )
        if np.any(A.diagonal() < 0):
            first = int(np.argmax(A.diagonal() < 0))
            raise EigenError(f"{name}: got a negative diagonal entry, first {where(first)}; expected none")
