"""The model description by itself: the schema, FMPy's rules, what neither looks at (section 2.2)."""

from collections.abc import Iterator, Mapping

from .check import Check
from .description import DESCRIPTION, Description, Unknown, Variable
from .driver import Fmu
from .finding import Demand, Finding

SEEN_BY_OURS = ('The unit "',)  # what the checks of units say better


def valid(fmu: Fmu) -> Iterator[Finding]:
    """FMPy's validation: schema, names, start values, causality, ModelStructure."""
    from fmpy.validation import validate_fmu  # takes a second to import, and only this check needs it

    for problem in validate_fmu(str(fmu.folder)):
        line = " ".join(problem.split())
        if not line.startswith(SEEN_BY_OURS):
            yield Finding("model-description", line)


def ranges(fmu: Fmu) -> Iterator[Finding]:
    """min ≤ start ≤ max; nominal is not 0."""
    for v in fmu.description.variables:
        low, high = v.minimum, v.maximum
        if low is not None and high is not None and low > high:
            yield Finding("range", f"{v.name}: min={low:g} is above max={high:g}")
        if isinstance(v.start, bool | str) or v.start is None:
            continue
        if (low is not None and v.start < low) or (high is not None and v.start > high):
            yield Finding("range", f"{v.name}: start={v.start:g} is not within min={low}, max={high}")
        if v.nominal == 0.0:
            yield Finding("range", f"{v.name}: nominal=0")


def structure(fmu: Fmu) -> Iterator[Finding]:
    """Indices exist and rise; dependencies are on knowns; what the flags allow."""
    d = fmu.description
    for group, unknowns in (
        ("Outputs", d.outputs),
        ("Derivatives", d.derivatives),
        ("InitialUnknowns", d.initial_unknowns),
    ):
        for u in unknowns:
            problem = _problem(d, u)
            if problem:
                yield Finding("model-structure", f"{group}: {problem}")
            elif foreign := [v.name for v in _foreign(d, group, u)]:
                name = d.variables[u.place].name
                yield Finding("dependencies-unknown", f"{group}: {name} depends on {foreign[0]}")
    places = [u.place for u in d.initial_unknowns]
    if places != sorted(places):
        yield Finding("model-structure", "InitialUnknowns are not in the order of the variables")
    if not d.can("providesDirectionalDerivative"):
        states = _states(d)
        listed = [u for u in d.outputs if set(u.dependencies or ()) & states]
        if listed and states:
            name = d.variables[listed[0].place].name
            yield Finding(
                "state-dependencies",
                f"{len(listed)} outputs, such as {name}, list states without providesDirectionalDerivative",
            )


def _problem(d: Description, u: Unknown) -> str | None:
    count = len(d.variables)
    if not 0 <= u.place < count:
        return f"the index {u.place + 1} is no variable's, there are {count}"
    name, known = d.variables[u.place].name, u.dependencies or ()
    if any(not 0 <= i < count for i in known):
        return f"{name} depends on an index that is no variable's, there are {count}"
    if list(known) != sorted(set(known)):
        return f"the dependencies of {name} do not rise"
    return None


def _foreign(d: Description, group: str, u: Unknown) -> Iterator[Variable]:
    """What is listed and is none of the knowns there."""
    states = _states(d)
    for i in u.dependencies or ():
        v = d.variables[i]
        exact = group == "InitialUnknowns" and v.initial == "exact"
        if not (exact or v.causality in ("input", "independent") or i in states):
            yield v


def _states(d: Description) -> set[int]:
    found = {d.variables[u.place].derivative for u in d.derivatives if 0 <= u.place < len(d.variables)}
    return {i for i in found if i is not None}


def aliases(fmu: Fmu) -> Iterator[Finding]:
    """Variables of one value reference have one value, so one unit, and depend on the same."""
    d = fmu.description
    listed = {u.place: u.dependencies for u in d.outputs}
    first: dict[tuple[str, int], int] = {}
    for i, v in enumerate(d.variables):
        one = first.setdefault((v.getter, v.reference), i)
        other = d.variables[one]
        if one != i and v.unit != other.unit:
            yield Finding("alias", f"{v.name} and {other.name} share a value reference, not the unit")
        elif one in listed and i in listed and listed[one] != listed[i]:
            yield Finding("alias", f"{v.name} and {other.name} share a value reference, not the dependencies")


def flags(fmu: Fmu) -> Iterator[Finding]:
    """Capabilities that need each other; times of the DefaultExperiment."""
    d = fmu.description
    if d.can("canSerializeFMUstate") and not d.can("canGetAndSetFMUstate"):
        yield Finding("capabilities", "canSerializeFMUstate without canGetAndSetFMUstate")
    if d.stop is not None and d.stop <= (d.start or 0.0):
        yield Finding("default-experiment", f"stopTime={d.stop:g} is not after startTime={d.start or 0:g}")
    if d.step is not None and d.step <= 0:
        yield Finding("default-experiment", f"stepSize={d.step:g} is not greater than 0")


def files(fmu: Fmu) -> Iterator[Finding]:
    """The files that are named are there."""
    for name in fmu.description.sources:
        if not (fmu.folder / "sources" / name).is_file():
            yield Finding("files-missing", f"sources/{name} is listed in {DESCRIPTION} and not there")


DEMANDS: Mapping[str, Demand] = {
    "model-description": Demand(
        "error",
        "2.2",
        "modelDescription.xml is valid by the schema and the rules of its elements",
        "as FMPy says",
    ),
    "range": Demand("error", "2.2.7", "min ≤ start ≤ max, and nominal is not 0", "choose them so"),
    "model-structure": Demand(
        "error",
        "2.2.8",
        "indices of ModelStructure are those of variables, in order",
        "count from 1",
    ),
    "dependencies-unknown": Demand(
        "warning",
        "2.2.8",
        "dependencies are on inputs, states and time; of InitialUnknowns also on what has initial=exact",
        "leave the others out: they do not change there",
    ),
    "state-dependencies": Demand(
        "note",
        "2.2.8",
        "without providesDirectionalDerivative a co-simulation FMU does not list dependencies on states",
        "leave the states out",
    ),
    "alias": Demand(
        "error",
        "2.1.7",
        "variables with one value reference are one value",
        "give each value a reference of its own",
    ),
    "capabilities": Demand(
        "error", "4.3.1", "canSerializeFMUstate needs canGetAndSetFMUstate", "declare both"
    ),
    "default-experiment": Demand(
        "warning", "2.2.5", "stopTime is after startTime, stepSize greater than 0", "choose so"
    ),
    "files-missing": Demand(
        "error", "2.3", "files that are listed are in the FMU", "add them, or do not list them"
    ),
}
CHECKS = (
    Check("model-description", valid),
    Check("range", ranges),
    Check("model-structure", structure),
    Check("alias", aliases),
    Check("capabilities", flags),
    Check("files", files),
)
