"""Units of variables: which quantity they measure, and how values go from one to another."""

from dataclasses import dataclass
from functools import cached_property

from .fmu_face import Face

BASES = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")
LOADS = {(1, 1, -2), (1, 2, -2), (1, -1, -2)}  # exponents of kg, m, s of a force, a moment, a pressure
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
    """The unit of a variable, None where it has none."""
    name = face.unit(variable)
    if not name:
        return None
    for unit in face.description.unitDefinitions:
        base = unit.baseUnit
        if unit.name == name and base is not None:
            exponents = tuple(int(getattr(base, key)) for key in BASES)
            return Unit(name, exponents, float(base.factor), float(base.offset))
    return Unit(name, None)


def conversion(source: Unit, target: Unit) -> tuple[float, float] | None:
    """(f, o) with target = f · source + o; None where they do not measure the same."""
    if source.exponents is None or target.exponents is None:
        return (1.0, 0.0) if source.name == target.name else None
    if source.exponents != target.exponents:
        return None
    return source.factor / target.factor, (source.offset - target.offset) / target.factor
