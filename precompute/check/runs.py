"""Runs with inputs that move a little about their start values, and what two runs have different."""

import math
from collections.abc import Mapping, Sequence

from .description import Description, Value, Variable
from .driver import Ended, Fmu, Slave

SMALL = 0.1  # of a variable's size: how far an input moves from its start value
Snapshot = Mapping[Variable, Value]


def size_of(variable: Variable) -> float:
    """How large a Real is: its start value, or its nominal one where that is larger; 1 where neither is."""
    start = abs(float(variable.start)) if isinstance(variable.start, int | float) else 0.0
    return max(start, abs(variable.nominal or 0.0)) or 1.0


def moved(variable: Variable, amount: float) -> float:
    """The start value of a Real and `amount` of its size, -1 … 1, within its min and max."""
    start = float(variable.start) if isinstance(variable.start, int | float) else 0.0
    low = -math.inf if variable.minimum is None else variable.minimum
    high = math.inf if variable.maximum is None else variable.maximum
    reach = min(SMALL * size_of(variable), (high - low) / 4)
    centre = min(max(start, low + reach), high - reach)
    return centre + reach * amount


def inputs_at(fmu: Fmu, k: int, phase: float = 0.0) -> dict[Variable, Value]:
    """Inputs for the step k: Reals on sines, each of its own, Booleans now and then the other way."""
    values: dict[Variable, Value] = {}
    for i, v in enumerate(fmu.description.inputs):
        if v.type == "Real":
            values[v] = moved(v, math.sin(0.61 * k + 1.37 * i + 0.3 + phase))
        elif v.type == "Boolean":
            values[v] = bool(v.start) ^ ((k + i) % 7 == 3)
    return values


def tuned(description: Description) -> dict[Variable, Value]:
    """Tunable Real parameters, moved a little."""
    return {
        v: moved(v, 0.5)
        for v in description.variables
        if (v.causality, v.variability, v.type) == ("parameter", "tunable", "Real")
    }


def observed(fmu: Fmu) -> tuple[Variable, ...]:
    """What a run records: every variable that has a value at a communication point."""
    return fmu.description.variables


def run(fmu: Fmu, slave: Slave, first: int, count: int, phase: float = 0.0) -> list[Snapshot]:
    """The values after each of `count` steps from the point `first`; fewer where the FMU ends."""
    rows: list[Snapshot] = []
    for k in range(first, first + count):
        slave.set(inputs_at(fmu, k, phase))
        try:
            slave.step(fmu.point(k), fmu.h)
        except Ended:
            break
        rows.append(slave.get(observed(fmu)))
    return rows


def fresh_run(fmu: Fmu, count: int, phase: float = 0.0) -> list[Snapshot]:
    """The same by an instance of its own."""
    slave = fmu.slave().initialise(fmu.start)
    rows = run(fmu, slave, 0, count, phase)
    slave.free()
    return rows


def same(a: Value, b: Value) -> bool:
    """To the bit, for what that means to a simulation: −0 is 0, and one NaN is like another."""
    return a == b or (a != a and b != b)


def difference(expected: Sequence[Snapshot], got: Sequence[Snapshot], first: int = 1) -> str | None:
    """The first value that two runs have different, in words; None where all are the same.

    first: the number of steps before the first row.
    """
    for k, (one, other) in enumerate(zip(expected, got, strict=False), first):
        for v in one:
            if not same(one[v], other[v]):
                return f"{v.name} is {shown(other[v])} instead of {shown(one[v])} after step {k}"
    if len(expected) != len(got):
        return f"it ended after {len(got)} steps instead of {len(expected)}"
    return None


def shown(value: Value) -> str:
    """A value as it is told."""
    return f"{value:.10g}" if isinstance(value, float) else str(value)
