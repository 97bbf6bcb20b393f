"""What is measured at ports and between two of them, as rows over all DOFs."""

from collections.abc import Callable
from typing import TypeAlias

from scipy.sparse import csr_array

from fmu_src.runtime.kinds import STRESSES

MotionOf: TypeAlias = Callable[[str, int], csr_array]
"""The name of a port and a direction 0 … 5 → the row (1, n) of its motion."""

StressOf: TypeAlias = Callable[[str], csr_array]
"""The name of a port → the rows (6, n) of its stress in xx, yy, zz, xy, yz, zx (Pa)."""

_ANGULAR = (
    *("moment", "angular_motion", "reaction_moment", "action_moment"),
    *("rotation", "angular_velocity", "angular_acceleration"),
)

ACTIONS = {"action": "motion", "action_moment": "angular_motion"}
"""The input that a port answers to by a force on what moves it: the negative of its reaction."""

DRIVEN = {"reaction": "motion", "reaction_moment": "angular_motion"} | ACTIONS
"""The input that each reaction and action of a port answers to."""


def direction_of(key: str) -> int:
    """0 … 5 (x y z rx ry rz) of an input or output such as "force.x" or "angular_velocity.z"."""
    kind, axis = key.split(".")
    return "xyz".index(axis) + 3 * (kind in _ANGULAR)


def port_rows(port: str, key: str, motion: MotionOf, stress: StressOf) -> csr_array:
    """The rows of one output of a port: one (1, n), but six (6, n) of "stress.mises"."""
    kind, component = key.split(".")
    if kind != "stress":
        return motion(port, direction_of(key))
    if component == "mises":
        return stress(port)
    return csr_array(stress(port)[[STRESSES.index(component)]])


def pair_row(ports: tuple[str, str], key: str, motion: MotionOf) -> csr_array:
    """The motion of the second port less that of the first, (1, n)."""
    first, second = (motion(port, direction_of(key)) for port in ports)
    return csr_array(second - first)
