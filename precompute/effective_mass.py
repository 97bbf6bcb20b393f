"""How much of the part's mass each mode moves."""

import numpy as np

from .arrays import Floats
from .system import System


def effective_mass(system: System, Phi: Floats) -> Floats:
    """m_ki = Γ_ki², Γ = Eᵀ M Φ with E the translations x, y, z: (3, r) in kg.

    Phi: (n, r), ΦᵀMΦ = I. Summed over all modes of a free body each direction gives its mass. Where supports
    hold it, the sum is gᵀ M_ff⁻¹ g, g the rows of M E at the free DOFs f: less by what the supports carry.
    Source: Clough & Penzien, Dynamics of Structures, chapter 26.
    """
    Gamma = system.rigid[:, :3].T @ (system.M @ Phi)
    return np.asarray(Gamma**2)


def total_mass(system: System) -> float:
    """m = e_xᵀ M e_x in kg, the fixed nodes included."""
    ones = system.rigid[:, 0]
    return float(ones @ (system.M @ ones))
