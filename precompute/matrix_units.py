"""Units of exported matrices: K, M and D in SI."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from scipy.sparse import csr_array

from .arrays import Ints
from .errors import MatrixError
from .read_mesh import UNITS as LENGTHS

_POUND = 0.45359237  # kg
_GRAVITY = 9.80665  # m/s²

MASSES: Mapping[str, float] = MappingProxyType(
    {
        "kg": 1.0,
        "t": 1e3,
        "g": 1e-3,
        "mg": 1e-6,
        "lb": _POUND,
        "slug": _POUND * _GRAVITY / 0.3048,  # 1 lbf gives it 1 ft/s²
        "slinch": _POUND * _GRAVITY / 0.0254,  # 1 lbf gives it 1 in/s²
    }
)
"""Kilograms per unit of mass."""

TIMES: Mapping[str, float] = MappingProxyType({"s": 1.0, "ms": 1e-3})
"""Seconds per unit of time."""


@dataclass(frozen=True)
class Units:
    """The units of length, mass and time that matrices are consistent in; the force unit follows.

    Raises MatrixError: a unit that is not known.
    """

    length: str = "m"
    mass: str = "kg"
    time: str = "s"

    def __post_init__(self) -> None:
        for name, known in (("length", LENGTHS), ("mass", MASSES), ("time", TIMES)):
            if getattr(self, name) not in known:
                raise MatrixError(
                    f"units: got {name} {getattr(self, name)!r}, expected one of {', '.join(known)}"
                )

    @property
    def metres(self) -> float:
        """Metres per unit of length."""
        return LENGTHS[self.length]


def in_si(A: csr_array, direction: Ints, units: Units, per_time: int) -> csr_array:
    """m/tᵏ · S A S, S = 1 for translations and the unit of length for rotations.

    A translational entry of K is a mass/time² (k = 2), of D a mass/time (k = 1), of M a mass (k = 0); a row
    or column of a rotation, in radians, carries one more length. direction: (n,), 0 … 5.
    """
    S = np.where(direction < 3, 1.0, units.metres)
    factor = MASSES[units.mass] / TIMES[units.time] ** per_time
    row = np.repeat(np.arange(A.shape[0]), np.diff(A.indptr))
    data = A.data * (S[row] * S[A.indices]) * factor
    return csr_array((data, A.indices, A.indptr), shape=A.shape)
