"""ModelStructure against what the FMU does: which unknowns change when a known is changed (section 2.2.8).

In initialization mode set and get may alternate, so each known is moved by itself and all unknowns are read.
Between steps the same is done with the inputs, where the FMU has values at once.
"""

from collections.abc import Iterator, Mapping, Sequence

from .check import Check
from .description import Description, Unknown, Value, Variable
from .driver import Fmu, Refused, Slave
from .finding import Finding
from .runs import inputs_at, moved, run, same

MANY = 150  # knowns that are moved
ROUNDING = 1e-9  # of a value: less is the noise of an iteration
NAMED = 5  # findings of one kind


def knowns(description: Description) -> tuple[Variable, ...]:
    """In initialization mode: inputs, and what has initial=exact and can be set."""
    found = [
        v
        for v in description.variables
        if (v.causality == "input" or v.initial == "exact")
        and v.variability != "constant"
        and v.type in ("Real", "Boolean", "Integer")
    ]
    every = max(1, -(-len(found) // MANY))
    return tuple(found[::every])


def other_value(v: Variable, amount: float) -> Value | None:
    """Another value of a known; None where it has none that is sure to be good."""
    if v.type == "Real":
        return moved(v, amount)
    if v.type == "Boolean":
        return not v.start
    start = int(v.start or 0)
    steps = [start - 1, start + 1]
    within = [
        x for x in steps if v.minimum is not None and v.maximum is not None and v.minimum <= x <= v.maximum
    ]
    return within[0] if within else None


def generic(fmu: Fmu) -> dict[Variable, Value]:
    """A point where nothing is zero by chance: Reals on both sides of their start values."""
    reals = [v for v in knowns(fmu.description) if v.type == "Real"]
    return {
        v: moved(v, 0.3 + 0.05 * (i % 7) if i % 2 else -0.45 + 0.04 * (i % 5)) for i, v in enumerate(reals)
    }


def initialising(fmu: Fmu, point: Mapping[Variable, Value]) -> Slave:
    """In initialization mode, with these knowns set; those that are refused stay as they are."""
    slave = fmu.slave()
    slave.setup(fmu.start)
    slave.must("EnterInitializationMode")
    slave.set(point)
    return slave


def accepted(fmu: Fmu, point: Mapping[Variable, Value]) -> dict[Variable, Value]:
    """The knowns that can be set to these values; after a refusal each is tried by an instance of its own."""
    try:
        initialising(fmu, point).free()
    except Refused:
        return {v: value for v, value in point.items() if _alone(fmu, v, value)}
    return dict(point)


def _alone(fmu: Fmu, v: Variable, value: Value) -> bool:
    try:
        initialising(fmu, {v: value}).free()
    except Refused:
        return False
    return True


def initial(fmu: Fmu) -> Iterator[Finding]:
    """InitialUnknowns."""
    description = fmu.description
    point = accepted(fmu, generic(fmu))
    unknowns = [u for u in description.initial_unknowns if 0 <= u.place < len(description.variables)]
    moves = {v: value for v in knowns(description) if (value := other_value(v, 0.9)) is not None}
    moves = accepted(fmu, moves)
    slave = initialising(fmu, point)
    yield from _compare(fmu, slave, "InitialUnknowns", unknowns, moves, point)
    slave.free()


def at_a_point(fmu: Fmu) -> Iterator[Finding]:
    """Outputs, by the inputs."""
    description = fmu.description
    slave = fmu.slave().initialise(fmu.start)
    run(fmu, slave, 0, 3)
    point = inputs_at(fmu, 2)
    moves = {v: value for v in description.inputs if (value := other_value(v, 0.9)) is not None}
    unknowns = [u for u in description.outputs if 0 <= u.place < len(description.variables)]
    yield from _compare(fmu, slave, "Outputs", unknowns, moves, point)
    slave.free()


def _compare(
    fmu: Fmu,
    slave: Slave,
    group: str,
    unknowns: Sequence[Unknown],
    moves: Mapping[Variable, Value],
    point: Mapping[Variable, Value],
) -> Iterator[Finding]:
    """Move each known by itself; what changes must depend on it, by its declaration."""
    variables = fmu.description.variables
    place = {v: i for i, v in enumerate(variables)}
    read = [variables[u.place] for u in unknowns]
    before = slave.get(read)
    named: dict[str, int] = {}
    seen: set[tuple[int, int]] = set()
    for known, value in moves.items():
        back = point.get(known, known.start)
        if back is None or same(back, value):
            continue
        slave.set({known: value})
        after = slave.get(read)
        slave.set({known: back})
        for unknown, v in zip(unknowns, read, strict=True):
            if not _changed(before[v], after[v]):
                continue
            seen.add((unknown.place, place[known]))
            allowed = unknown.dependencies is None or place[known] in unknown.dependencies
            if not (allowed or v == known) and named.setdefault(group, 0) < NAMED:
                named[group] += 1
                yield Finding(
                    "dependencies-missing",
                    f"{group}: {v.name} changes with {known.name}, which is not listed",
                )
    yield from _unused(fmu.description, group, unknowns, moves, seen)


def _unused(
    description: Description,
    group: str,
    unknowns: Sequence[Unknown],
    moves: Mapping[Variable, Value],
    seen: set[tuple[int, int]],
) -> Iterator[Finding]:
    """Listed and never seen; one in ten may be a term that vanishes here."""
    variables = description.variables
    moved_places = {i for i, v in enumerate(variables) if v in moves}
    listed = [(u.place, i) for u in unknowns for i in u.dependencies or () if i in moved_places]
    idle = [pair for pair in listed if pair not in seen]
    if idle:
        unknown, known = (variables[i].name for i in idle[0])
        yield Finding(
            "dependencies-unused",
            f"{group}: {len(idle)} of {len(listed)} listed were not seen, such as of {unknown} on {known}",
        )


def _changed(before: Value, after: Value) -> bool:
    if isinstance(before, float) and isinstance(after, float):
        return not same(before, after) and not abs(after - before) <= ROUNDING * max(abs(before), abs(after))
    return before != after


def _no_initial(description: Description) -> str | None:
    return None if description.initial_unknowns else "ModelStructure has no InitialUnknowns"


def _no_feedthrough(description: Description) -> str | None:
    return None if description.inputs and description.outputs else "there are not both inputs and outputs"


CHECKS = (
    Check("dependencies at initialisation", initial, _no_initial),
    Check("dependencies at a communication point", at_a_point, _no_feedthrough),
)
