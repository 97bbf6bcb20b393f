"""What a part adds to its modes where the motion of ports is prescribed: u = Ψ s + T Φ q."""

from dataclasses import dataclass

from .arrays import Floats
from .moving_shapes import MovingShapes
from .system import System


@dataclass(frozen=True, eq=False)  # arrays have no one truth value
class MovedPart:
    """Psi: (n, k), Ψ over all DOFs of the full model; c: (rows, k), what is measured of it; M = ΨᵀMΨ and
    K = ΨᵀKΨ: (k, k), in kg and N/m where s is in m.
    """

    Psi: Floats
    c: Floats
    M: Floats
    K: Floats


def moved_part(shapes: MovingShapes, c: Floats, system: System) -> MovedPart:
    """M and K exactly symmetric; system: over all DOFs."""
    Psi, elastic = shapes.Psi, shapes.elastic
    M, K = Psi.T @ (system.M @ Psi), elastic.T @ (system.K @ elastic)
    return MovedPart(Psi, c, (M + M.T) / 2, (K + K.T) / 2)
