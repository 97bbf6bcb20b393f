"""How the part follows a prescribed motion of its ports statically: u = Ψ s, W Ψ = I, K Ψ = Wᵀμ elsewhere."""

from dataclasses import dataclass

import numpy as np

from .arrays import Floats, Ints
from .constrained import Constrained
from .rigid import HELD, rigid_modes
from .rounding import without_energy
from .statics import StaticSolver
from .system import System

ROUNDING = (
    1e-10  # of a motion: what W and R, products of coordinates, leave of one that the body follows rigidly
)


@dataclass(frozen=True, eq=False)  # arrays have no one truth value
class MovingShapes:
    """Psi: (n, k), Ψ over all DOFs; elastic: (n, k), Ψ less a rigid motion of the whole part.

    KΨ = K · elastic, exactly 0 where the ports take the part along as a rigid body.
    """

    Psi: Floats
    elastic: Floats


def moving_shapes(held: Constrained, system: System, fixed: Ints, solve: StaticSolver) -> MovingShapes:
    """Ψ = R C + X: the rigid motions R that supports leave, C = (W R)⁺, then what they cannot give,

      X = P E − T K̂⁺ TᵀK P E,  E = I − W R C, exactly 0 where W R has full rank.

    Ψ is 0 at the supports, W Ψ = I and TᵀKΨ = 0. Where the held ports leave rigid motions, Ψ is fixed up to
    these, and taken orthogonal to them in M, so that the ports do not drive them.
    system, fixed: over all DOFs; solve: of û.
    Source: Craig & Bampton, AIAA Journal 6 (1968) (constraint modes); Clough & Penzien, Dynamics of
    Structures, 2nd ed., 26-3 (pseudostatic displacements).
    """
    R = rigid_modes(system, fixed)
    C, E = _rigid_share(held, R)
    X = held.P @ E
    X = X - held.T @ solve(held.T.T @ (system.K @ X))
    Psi = R @ C + X
    left = held.T @ solve.rigid
    elastic = np.where(without_energy(system.K, X, system.precision), 0.0, X)
    return MovingShapes(Psi - left @ (left.T @ (system.M @ Psi)), elastic)


def _rigid_share(held: Constrained, R: Floats) -> tuple[Floats, Floats]:
    """C = (W R)⁺ (r, k) and E = I − W R C (k, k), without what is rounding only.

    R reaches what is not small beside the largest that it could make of a motion.
    """
    WR = held.W @ R
    rows, columns = np.asarray(abs(held.W).sum(axis=1)), np.abs(R).max(axis=0)
    U, size, Vt = np.linalg.svd(WR / rows[:, None] / columns, full_matrices=False)
    reached = size > HELD
    C = (Vt[reached].T / size[reached]) @ U[:, reached].T / rows / columns[:, None]
    one = np.eye(len(rows))
    E = one - WR @ C
    rounded = np.abs(E) <= ROUNDING * (one + np.outer(rows, columns @ np.abs(C)))
    return C, np.where(rounded | (reached.sum() == len(rows)), 0.0, E)
