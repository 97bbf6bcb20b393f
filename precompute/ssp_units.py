"""Units of variables: which quantity they measure, and how values go from one to another."""

from dataclasses import dataclass
from functools import cached_property
from math import isclose, isfinite

from .errors import SspError
from .fmu_face import Face

BASES = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")
LOADS = {(1, 1, -2), (1, 2, -2), (1, -1, -2)}  # exponents of kg, m, s of a force, a moment, a pressure
SAME_FACTOR = 1e-6  # tools print the factors of one unit with 6 to 17 digits
MOTIONS = {(0, 1, 0), (0, 1, -1), (0, 1, -2), (0, 0, 0), (0, 0, -1), (0, 0, -2)}  # the last three with rad


@dataclass(frozen=True)
class Unit:
    """One value of it is factor · value + offset in SI base units with the `exponents` of BASES.

    exponents: none where the FMU names the unit and does not say what it is.
    """

    name: str
    exponents: tuple[int, ...] | None
    factor: float = 1.0
    offset: float = 0.0

    @cached_property
    def is_load(self) -> bool:
        """A force, a moment or a pressure."""
        return self.exponents is not None and self.exponents[:3] in LOADS and not any(self.exponents[3:])

    @cached_property
    def is_motion(self) -> bool:
        """A displacement or rotation, a velocity or an acceleration."""
        if self.exponents is None or any(self.exponents[3:-1]):
            return False
        angular = self.exponents[-1]
        return self.exponents[:3] in MOTIONS and angular == (0 if self.exponents[1] else 1)


def unit_of(face: Face, variable: str) -> Unit | None:
    """The unit of a variable, None where it has none.

    Raises SspError where its factor or offset is no number that values can be converted by.
    """
    name = face.unit(variable)
    if not name:
        return None
    for unit in face.description.unitDefinitions:
        base = unit.baseUnit
        if unit.name == name and base is not None:
            exponents = tuple(int(getattr(base, key)) for key in BASES)
            factor, offset = float(base.factor), float(base.offset)
            if not (1e-30 <= abs(factor) <= 1e30 and isfinite(offset)):
                raise SspError(
                    f"{face.path}: its unit {name} has factor {factor:g} and offset {offset:g}, expected a "
                    "factor of 1e-30 to 1e30 and a finite offset; mend its modelDescription.xml"
                )
            return Unit(name, exponents, factor, offset)
    return Unit(name, None)


def same_unit(a: Unit, b: Unit) -> bool:
    """One name, and what the FMUs say of it differs in digits only, or in rad, which has no dimension."""
    if a.name != b.name or a.exponents is None or b.exponents is None:
        return a.name == b.name
    return (
        a.exponents[:-1] == b.exponents[:-1]
        and isclose(a.factor, b.factor, rel_tol=SAME_FACTOR)
        and isclose(a.offset, b.offset, rel_tol=SAME_FACTOR)
    )


def conversion(source: Unit, target: Unit) -> tuple[float, float] | None:
    """(f, o) with target = f · source + o; None where they do not measure the same."""
    if same_unit(source, target):
        return 1.0, 0.0
    if source.exponents is None or source.exponents != target.exponents:
        return None
    return source.factor / target.factor, (source.offset - target.offset) / target.factor
