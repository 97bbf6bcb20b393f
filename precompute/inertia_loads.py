"""Loads on every mass of the part: gravity, and the acceleration of the supports."""

import numpy as np

from .arrays import Floats, Ints
from .dofs import Dofs
from .notice import warning
from .part_values import Axis
from .rounding import without_energy
from .system import System


def gravity_load(system: System, axis: Axis) -> Floats:
    """F = M r_k in kg, (n,): the nodal forces of 1 m/s² of gravity in the direction k of `axis`.

    r_k: (n,) the unit translation of all DOFs.
    """
    F: Floats = system.M @ system.rigid[:, "xyz".index(axis)]
    return F


def base_load(system: System, axis: Axis, fixed: Ints, dofs: Dofs, *, driven: bool = False) -> Floats:
    """F = −M r_k in kg, (n,), per m/s² of the supports in the direction k of `axis`.

    Displacements are relative to the moving supports, u_abs = u + r_k u_base, so that
    M ü + D u̇ + K u = F − M r_k ü_base (Clough & Penzien, Dynamics of Structures, 2nd ed., 2-7); springs and
    dashpots to ground move with the supports, and so do ports whose motion is prescribed (driven: there are
    some). A warning where nothing holds the body in that direction.
    """
    r = system.rigid[:, "xyz".index(axis)]
    if (
        not driven
        and not np.any(dofs.direction[fixed] == "xyz".index(axis))
        and without_energy(system.K, r[:, None], system.precision)[0]
    ):
        warning(
            f"base: no support holds the part in {axis}, so base.acceleration.{axis} moves the "
            "frame of reference but not the part"
        )
    return -gravity_load(system, axis)
