"""How much of the part's mass each mode moves."""

import numpy as np

from .arrays import Floats
from .system import System


def effective_mass(system: System, Phi: Floats) -> Floats:
    """m_ki = Γ_ki², Γ = Eᵀ M Φ with E the translations x, y, z: (3, r) in kg.

    Phi: (n, r), ΦᵀMΦ = I. Summed over all modes of a body each direction gives its mass; where supports
    hold it, the mass of its free DOFs. Source: Clough & Penzien, Dynamics of Structures, chapter 26.
    """
    Gamma = system.rigid[:, :3].T @ (system.M @ Phi)
    return np.asarray(Gamma**2)


def total_mass(system: System) -> float:
    """m = e_xᵀ M e_x in kg, the fixed nodes included."""
    ones = system.rigid[:, 0]
    return float(ones @ (system.M @ ones))
