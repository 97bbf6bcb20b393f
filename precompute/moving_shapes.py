"""How the part follows a prescribed motion of its ports statically: u = Ψ s, W Ψ = I, K Ψ = Wᵀμ elsewhere."""

from dataclasses import dataclass

import numpy as np

from .arrays import Floats, Ints
from .constrained import Constrained
from .rigid import HELD, rigid_modes
from .statics import StaticSolver
from .system import System


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
    WR = held.W @ R
    size = np.sqrt(np.asarray(held.W.multiply(held.W).sum(axis=1)).ravel())
    A = WR / size[:, None]
    C = np.linalg.pinv(A, rcond=HELD) / size
    reached = np.linalg.svd(A, compute_uv=False)
    whole = np.sum(reached > HELD * np.max(reached, initial=0.0)) == len(A)
    X = held.P @ (np.zeros((len(A), len(A))) if whole else np.eye(len(A)) - WR @ C)
    X = X - held.T @ solve(held.T.T @ (system.K @ X))
    Psi = R @ C + X
    left = held.T @ solve.rigid
    return MovingShapes(Psi - left @ (left.T @ (system.M @ Psi)), X)
