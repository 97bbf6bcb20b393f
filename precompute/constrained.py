"""The full model in fewer coordinates û: u = T û + P s, where ports are rigid or their motion is given."""

from dataclasses import dataclass

from scipy.sparse import csr_array, identity

from .arrays import Ints
from .system import System


@dataclass(frozen=True)
class Constrained:
    """TᵀMT, TᵀDT, TᵀKT [2.21]: how the part moves with its rigid ports rigid and its moved ports held.

    system: (n̂, n̂); fixed: the held DOFs among û; T: (n, n̂); L: (n̂, n), û of a motion that the constraints
    allow, L T = I; origin: (n̂,), the DOF of the full model that each is, of a rigid port's the first one.
    W: (k, n), the motions W u = s that are prescribed; P: (n, k) what moves with them where û = 0:
    W T = 0, W P = I.
    """

    system: System
    fixed: Ints
    T: csr_array
    L: csr_array
    origin: Ints
    W: csr_array
    P: csr_array


def unconstrained(system: System, fixed: Ints, origin: Ints) -> Constrained:
    """û = u."""
    n = len(origin)
    itself = csr_array(identity(n, format="csr"))
    return Constrained(system, fixed, itself, itself, origin, csr_array((0, n)), csr_array((n, 0)))
