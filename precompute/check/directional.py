"""fmi2GetDirectionalDerivative against central differences and ModelStructure (section 2.1.9)."""

from collections.abc import Callable, Iterator, Mapping, Sequence

from .check import Check, needs, needs_indices
from .description import Description, Unknown, Value, Variable
from .driver import Fmu, Refused, Slave
from .finding import Demand, Finding
from .runs import inputs_at, run, size_of
from .structure import accepted, generic, initialising, knowns, some

STEP = 1e-4  # of a known's size; the error of a central difference is its square, 1e-8, times f'''
AGREE = 1e-3  # relative; a wrong derivative is further off
NAMED = 5  # findings of one kind


def initial(fmu: Fmu) -> Iterator[Finding]:
    """Of InitialUnknowns by inputs and by what has initial=exact, in initialization mode."""
    description = fmu.description
    point = accepted(fmu, generic(description))
    slave = initialising(fmu, point)
    reals = some([v for v in knowns(description) if v.type == "Real" and v in point])
    yield from _compare(fmu, slave, "in initialization mode", description.initial_unknowns, reals, point)
    slave.free()


def at_a_point(fmu: Fmu) -> Iterator[Finding]:
    """Of Outputs and Derivatives by the inputs, between steps; those by the states keep to the structure."""
    d = fmu.description
    slave = fmu.slave().initialise(fmu.start)
    run(fmu, slave, 0, 3)
    unknowns = (*d.outputs, *d.derivatives)
    where = "at a communication point"
    yield from _compare(fmu, slave, where, unknowns, d.real_inputs, inputs_at(fmu, 2))
    states = [d.variables[i] for u in d.derivatives if (i := d.variables[u.place].derivative) is not None]
    reals = [u for u in unknowns if d.variables[u.place].type == "Real"]
    named = 0
    for state in states:
        column = _column(slave, [d.variables[u.place] for u in reals], state)
        here = d.variables.index(state)
        for u, slope in zip(reals, column, strict=True):
            if slope != 0 and u.dependencies is not None and here not in u.dependencies and named < NAMED:
                named += 1
                yield _not_listed(where, d.variables[u.place], state, slope)
    slave.free()


def _not_listed(where: str, unknown: Variable, known: Variable, slope: float) -> Finding:
    return Finding(
        "dependencies-missing",
        f"{where} the derivative of {unknown.name} by {known.name} is {slope:.6g}, which is not listed",
    )


def _compare(
    fmu: Fmu,
    slave: Slave,
    where: str,
    unknowns: Sequence[Unknown],
    listed: Sequence[Variable],
    point: Mapping[Variable, Value],
) -> Iterator[Finding]:
    variables = fmu.description.variables
    place = {v: i for i, v in enumerate(variables)}
    reals = [u for u in unknowns if 0 <= u.place < len(variables) and variables[u.place].type == "Real"]
    if not reals or not listed:
        return
    read = [variables[u.place] for u in reals]
    named = 0
    columns: list[list[float]] = []
    for known in listed:
        depend = [u.dependencies is None or place[known] in u.dependencies for u in reals]
        try:
            column = _column(slave, read, known)
        except Refused as refused:
            if any(depend):
                yield Finding("directional-derivative", f"{where}, by {known.name}: {refused}")
            return
        columns.append(column)
        centre = float(point[known])
        at = _reader(slave, read, known)
        delta = STEP * max(size_of(known), abs(centre))
        wide, narrow = (_central(at, centre, d) for d in (delta, delta / 4))
        values = at(centre)
        for k, (got, fine, coarse) in enumerate(zip(column, narrow, wide, strict=True)):
            noise = 1e3 * 2.2e-16 * abs(values[k]) / (delta / 4)
            slack = AGREE * max(abs(got), abs(fine)) + noise
            if abs(fine - coarse) > slack:
                continue  # not smooth here
            wrong = not abs(got - fine) <= slack
            if wrong and named < NAMED:
                named += 1
                yield Finding(
                    "directional-derivative",
                    f"{where}, of {read[k].name} by {known.name}: {got:.6g}, by differences {fine:.6g}",
                )
            if not depend[k] and got != 0 and not wrong and named < NAMED:
                named += 1
                yield _not_listed(where, read[k], known, got)
    yield from _linear(slave, where, read, listed, columns)


def _linear(
    slave: Slave,
    where: str,
    read: Sequence[Variable],
    listed: Sequence[Variable],
    columns: Sequence[Sequence[float]],
) -> Iterator[Finding]:
    """A seed of several knowns gives the same combination of their columns."""
    seed = [(-1) ** j * (0.5 + j % 3) for j in range(len(listed))]
    together = slave.directional([v.reference for v in read], [v.reference for v in listed], seed)
    for k, v in enumerate(read):
        terms = [seed[j] * columns[j][k] for j in range(len(listed))]
        # the rounding of a sum of terms
        if not abs(together[k] - sum(terms)) <= 1e-9 * sum(map(abs, terms)):
            yield Finding(
                "directional-seed",
                f"{where}, of {v.name} by {len(listed)} knowns together: {together[k]:.6g}, "
                f"by each alone {sum(terms):.6g}",
            )
            return


def _column(slave: Slave, read: Sequence[Variable], known: Variable) -> list[float]:
    return slave.directional([v.reference for v in read], [known.reference], [1.0])


def _reader(slave: Slave, read: Sequence[Variable], known: Variable) -> Callable[[float], list[float]]:
    def at(value: float) -> list[float]:
        slave.set({known: value})
        return [float(value) for value in slave.get(read).values()]

    return at


def _central(at: Callable[[float], list[float]], centre: float, delta: float) -> list[float]:
    high, low = at(centre + delta), at(centre - delta)
    at(centre)
    return [(b - a) / (2 * delta) for a, b in zip(low, high, strict=True)]


def _hindrance(description: Description) -> str | None:
    return needs("providesDirectionalDerivative")(description) or needs_indices(description)


DEMANDS: Mapping[str, Demand] = {
    "directional-derivative": Demand(
        "error",
        "2.1.9",
        "fmi2GetDirectionalDerivative gives the partial derivatives of what fmi2GetReal gives",
        "derive what is computed; central differences here are right to some 1e-6",
    ),
    "directional-seed": Demand(
        "error", "2.1.9", "the derivative is linear in its seed", "add the columns, each times its seed"
    ),
}
CHECKS = (
    Check("directional-derivative at initialisation", initial, _hindrance),
    Check("directional-derivative at a communication point", at_a_point, _hindrance),
)
