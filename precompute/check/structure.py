"""ModelStructure against what the FMU does: which unknowns change when a known is changed (section 2.2.8).

In initialization mode set and get may alternate, so each known is moved by itself and all unknowns are read.
Between steps the same is done with the inputs, where the FMU has values at once. From a point where nothing
is zero by chance, and with inputs and states, then fixed parameters too, at their start values, where a
small effect is not lost in a large value.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from .check import Check, needs_indices
from .description import Description, Unknown, Value, Variable
from .driver import Fmu, Refused, Slave
from .finding import Demand, Finding
from .runs import inputs_at, moved, run, same

MANY = 100  # knowns that are moved
ROUNDING = 1e-9  # of a value: less is the noise of an iteration
NAMED = 5  # findings of one kind
Pair = tuple[int, int]  # places of an unknown and a known


@dataclass(frozen=True)
class Effects:
    """any: pairs in which the unknown changed at all; large: by more than rounding."""

    any: frozenset[Pair]
    large: frozenset[Pair]


def knowns(description: Description) -> tuple[Variable, ...]:
    """In initialization mode: inputs, and what has initial=exact and can be set."""
    return tuple(
        v
        for v in description.variables
        if (v.causality == "input" or v.initial == "exact") and v.variability != "constant"
    )


def some(found: Sequence[Variable]) -> Sequence[Variable]:
    """Each n-th of very many."""
    return found[:: max(1, -(-len(found) // MANY))]


def other_value(v: Variable) -> Value | None:
    """Another value of a known; None where it has none that is sure to be good."""
    if v.type == "Real":
        return moved(v, 0.9)
    if v.type == "Boolean":
        return not v.start
    if v.type == "String":
        return f"{v.start}."
    if v.type == "Integer" and v.minimum is not None and v.maximum is not None:
        return int(v.minimum if v.start != v.minimum else v.maximum)
    return None


def generic(description: Description) -> dict[Variable, Value]:
    """Reals on both sides of their start values, each by an amount of its own."""
    reals = [v for v in knowns(description) if v.type == "Real"]
    return {
        v: moved(v, 0.3 + 0.05 * (i % 7) if i % 2 else -0.45 + 0.04 * (i % 5)) for i, v in enumerate(reals)
    }


def initialising(fmu: Fmu, point: Mapping[Variable, Value]) -> Slave:
    """In initialization mode, with these knowns set."""
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
    d = fmu.description
    moves = {v: value for v in some(knowns(d)) if (value := other_value(v)) is not None}
    moves = accepted(fmu, moves)
    everywhere = accepted(fmu, generic(d))
    effects = []
    parameters = {v: x for v, x in everywhere.items() if v.causality == "parameter"}
    tuned = {v: x for v, x in parameters.items() if v.variability == "tunable"}
    for point in (everywhere, parameters, tuned):
        slave = initialising(fmu, point)
        effects.append(_effects(d, slave, d.initial_unknowns, moves, point))
        slave.free()
    yield from _judge(d, "InitialUnknowns", d.initial_unknowns, moves, effects)


def at_a_point(fmu: Fmu) -> Iterator[Finding]:
    """Outputs, by the inputs."""
    d = fmu.description
    moves = {v: value for v in some(d.inputs) if (value := other_value(v)) is not None}
    effects = []
    for steps, point in ((3, inputs_at(fmu, 2)), (0, {})):
        slave = fmu.slave().initialise(fmu.start)
        run(fmu, slave, 0, steps)
        effects.append(_effects(d, slave, d.outputs, moves, point))
        slave.free()
    yield from _judge(d, "Outputs", d.outputs, moves, effects)


def _effects(
    d: Description,
    slave: Slave,
    unknowns: Sequence[Unknown],
    moves: Mapping[Variable, Value],
    point: Mapping[Variable, Value],
) -> Effects:
    """Move each known by itself and put it back."""
    places = [u.place for u in unknowns if 0 <= u.place < len(d.variables)]
    read = [d.variables[place] for place in places]
    before = slave.get(read)
    small: set[Pair] = set()
    large: set[Pair] = set()
    for known, value in moves.items():
        back = point.get(known, known.start)
        if back is None or same(back, value):
            continue
        slave.set({known: value})
        after = slave.get(read)
        slave.set({known: back})
        here = d.variables.index(known)
        for place, v in zip(places, read, strict=True):
            if place != here and not same(before[v], after[v]):
                small.add((place, here))
                if _large(before[v], after[v]):
                    large.add((place, here))
    return Effects(frozenset(small), frozenset(large))


def _judge(
    d: Description,
    group: str,
    unknowns: Sequence[Unknown],
    moves: Mapping[Variable, Value],
    effects: Sequence[Effects],
) -> Iterator[Finding]:
    """What changes must be listed; what is listed should change."""
    dependencies = {u.place: u.dependencies for u in unknowns}
    name = [v.name for v in d.variables]
    missing = sorted(
        (unknown, known)
        for unknown, known in effects[0].large
        if (listed := dependencies[unknown]) is not None and known not in listed
    )
    for unknown, known in missing[:NAMED]:
        said = f"{group}: {name[unknown]} changes with {name[known]}, which is not listed"
        rest = f" ({len(missing)} such pairs)" if len(missing) > NAMED else ""
        yield Finding("dependencies-missing", said + rest)
    moved_places = {i for i, v in enumerate(d.variables) if v in moves}
    listed_pairs = [(u.place, i) for u in unknowns for i in u.dependencies or () if i in moved_places]
    idle = [pair for pair in listed_pairs if not any(pair in e.any for e in effects) and pair[0] != pair[1]]
    if idle:
        unknown, known = idle[0]
        yield Finding(
            "dependencies-unused",
            f"{group}: {len(idle)} of {len(listed_pairs)} listed were not seen, such as of {name[unknown]} "
            f"on {name[known]}",
        )


def _large(before: Value, after: Value) -> bool:
    if isinstance(before, float) and isinstance(after, float):
        return not abs(after - before) <= ROUNDING * max(abs(before), abs(after))
    return True


def _no_initial(description: Description) -> str | None:
    none = None if description.initial_unknowns else "ModelStructure has no InitialUnknowns"
    return none or needs_indices(description)


def _no_feedthrough(description: Description) -> str | None:
    none = None if description.inputs and description.outputs else "there are not both inputs and outputs"
    return none or needs_indices(description)


DEMANDS: Mapping[str, Demand] = {
    "dependencies-missing": Demand(
        "error",
        "2.2.8",
        "an unknown depends on nothing that its dependencies do not list",
        "list it, or leave the attribute out: then it depends on everything",
    ),
    "dependencies-unused": Demand(
        "note",
        "2.2.8",
        "dependencies list what the unknown depends on",
        "take it off, if it vanishes everywhere",
    ),
}
CHECKS = (
    Check("dependencies at initialisation", initial, _no_initial),
    Check("dependencies at a communication point", at_a_point, _no_feedthrough),
)
