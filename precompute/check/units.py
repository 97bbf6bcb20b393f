"""Units: defined where used, with the exponents that their names tell (section 2.2.2)."""

import re
from collections.abc import Iterator, Mapping

from .check import Check
from .description import Description, Unit
from .driver import Fmu
from .finding import Demand, Finding

Exponents = Mapping[str, int]
BASE = ("kg", "m", "s", "A", "K", "mol", "cd")  # rad is 1: whether it is counted is the FMU's choice
# names that can only mean this, coherent with SI: factor 1
NAMED: Mapping[str, Exponents] = {
    **{base: {base: 1} for base in BASE},
    "rad": {},
    "Hz": {"s": -1},
    "N": {"kg": 1, "m": 1, "s": -2},
    "Pa": {"kg": 1, "m": -1, "s": -2},
    "J": {"kg": 1, "m": 2, "s": -2},
    "W": {"kg": 1, "m": 2, "s": -3},
    "C": {"A": 1, "s": 1},
    "V": {"kg": 1, "m": 2, "s": -3, "A": -1},
    "ohm": {"kg": 1, "m": 2, "s": -3, "A": -2},
    "F": {"kg": -1, "m": -2, "s": 4, "A": 2},
    "H": {"kg": 1, "m": 2, "s": -2, "A": -2},
    "T": {"kg": 1, "s": -2, "A": -1},
    "Wb": {"kg": 1, "m": 2, "s": -2, "A": -1},
}
_FACTOR = re.compile(r"([A-Za-z]+|1)\^?(-?\d+)?")


def exponents(name: str) -> dict[str, int] | None:
    """Of N.m/s2 or kg*m2/s2; None where the name is not made of NAMED ones alone."""
    top, *bottom = name.replace("*", ".").split("/")
    if len(bottom) > 1:
        return None
    found: dict[str, int] = {}
    for part, sign in ((top, 1), *((text, -1) for text in bottom)):
        for text in part.strip("()").split("."):
            match = _FACTOR.fullmatch(text)
            if match is None or (match[1] != "1" and match[1] not in NAMED):
                return None
            for base, power in NAMED.get(match[1], {}).items():
                found[base] = found.get(base, 0) + sign * power * int(match[2] or 1)
    return {base: power for base, power in found.items() if power}


def declared(unit: Unit) -> dict[str, int] | None:
    """Of the BaseUnit, without rad."""
    if unit.exponents is None:
        return None
    return {base: power for base, power in unit.exponents if power and base != "rad"}


def defined(fmu: Fmu) -> Iterator[Finding]:
    """Every unit of a variable is in UnitDefinitions."""
    known = {unit.name for unit in fmu.description.units}
    users = {v.unit: v.name for v in reversed(fmu.description.variables) if v.unit is not None}
    for unit, name in users.items():
        if unit not in known:
            yield Finding("unit-undefined", f"{name} has the unit {unit!r}, which is not in UnitDefinitions")


def right(fmu: Fmu) -> Iterator[Finding]:
    """The exponents of a BaseUnit are those of the name."""
    for unit in fmu.description.units:
        base, expected = declared(unit), exponents(unit.name)
        if base is None or expected is None:
            continue
        if base != expected:
            yield Finding("unit-definition", f"{unit.name} is {_shown(base)}, expected {_shown(expected)}")
        elif (unit.factor != 1.0 and "Hz" not in unit.name) or unit.offset != 0.0:  # 1 Hz may be 2π rad/s
            yield Finding(
                "unit-definition",
                f"{unit.name} has factor={unit.factor:g}, offset={unit.offset:g}, expected 1 and 0",
            )


def derivatives(fmu: Fmu) -> Iterator[Finding]:
    """The unit of a derivative is that of its variable by second."""
    d = fmu.description
    bases = {unit.name: declared(unit) for unit in d.units}
    for v in d.variables:
        if v.derivative is None or not 0 <= v.derivative < len(d.variables):
            continue
        whole = d.variables[v.derivative]
        own, of = bases.get(v.unit or ""), bases.get(whole.unit or "")
        if own is None or of is None:
            continue
        expected = {b: p for b, p in {**of, "s": of.get("s", 0) - 1}.items() if p}
        if own != expected:
            yield Finding(
                "unit-derivative", f"{v.name} in {v.unit} is the derivative of {whole.name} in {whole.unit}"
            )


def _shown(powers: Exponents) -> str:
    return " ".join(f"{base}{power if power != 1 else ''}" for base, power in powers.items()) or "1"


def _no_units(description: Description) -> str | None:
    return None if description.units else "no units are defined"


DEMANDS: Mapping[str, Demand] = {
    "unit-undefined": Demand("error", "2.2.2", "units of variables are in UnitDefinitions", "define them"),
    "unit-definition": Demand(
        "error",
        "2.2.2",
        "a BaseUnit has the exponents, factor and offset of its unit",
        "count the SI base units",
    ),
    "unit-derivative": Demand(
        "warning",
        "2.2.7",
        "the unit of a derivative is that of its variable by second",
        "correct one of them",
    ),
}
CHECKS = (
    Check("unit-undefined", defined),
    Check("unit-definition", right, _no_units),
    Check("unit-derivative", derivatives, _no_units),
)
