"""Exact modes of the full model, which its responses need not be sought for."""

from dataclasses import dataclass

import numpy as np

from .arrays import Floats
from .coupled_damping import projected_damping
from .extra_damping import Dashpots
from .statics import StaticSolver


@dataclass(frozen=True, eq=False)  # arrays have no one truth value
class KnownModes:
    """Exact modes of the full model, the lowest: lam (r,), Phi (n, r), and their damping D_rest (r, r)."""

    lam: Floats
    Phi: Floats
    D_rest: Floats


def rigid_only(solve: StaticSolver, dashpots: Dashpots = ()) -> KnownModes:
    """The rigid modes alone, for a basis that holds no exact elastic ones."""
    lam = np.zeros(solve.rigid.shape[1])
    return KnownModes(lam, solve.rigid, projected_damping(lam, solve.rigid, solve.system.D, dashpots))
