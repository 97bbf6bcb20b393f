"""The reference results that an FMU carries (FMI-LS-REF): it must give them."""

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

from ..errors import ModelError
from .check import Check
from .description import Value, Variable
from .driver import Fmu
from .finding import Demand, Finding

if TYPE_CHECKING:
    from ..experiments import Experiment


def reference_results(fmu: Fmu) -> Iterator[Finding]:
    """Each experiment is repeated; those with inputs and outputs at different times are left out."""
    import numpy as np  # which takes longer to load than most checks take

    from ..experiments import difference
    from ..ls_ref import read_experiments
    from ..signals import signals_of

    try:
        experiments = read_experiments(fmu.folder)
    except ModelError as error:
        yield Finding("reference-results", str(error))
        return
    variables = {v.name: v for v in fmu.description.variables}
    units = {v.name: v.unit or "" for v in variables.values()}
    for e in experiments:
        unknown = sorted({*e.inputs, *e.outputs} - {*variables})
        if unknown:
            yield Finding("reference-results", f"the experiment {e.name} names {unknown[0]!r}, no variable")
        elif e.stimuli["time"].tolist() == e.references["time"].tolist():
            rows = _repeated(fmu, e, [variables[n] for n in e.inputs], [variables[n] for n in e.outputs])
            found = difference(e, signals_of(["time", *e.outputs], np.array(rows)), units)
            worst = max(found, key=lambda name: found[name])
            if found[worst] > e.tolerance:
                yield Finding(
                    "reference-results",
                    f"in the experiment {e.name} {worst} is off by {found[worst]:.2g} of the largest value "
                    f"of its unit, {e.tolerance:g} is allowed",
                )


def _repeated(
    fmu: Fmu, e: "Experiment", inputs: list[Variable], outputs: list[Variable]
) -> list[list[float]]:
    """Time and outputs at the start and after each step; an input is held over the step from its row."""
    slave = fmu.slave()
    slave.setup(e.start)
    slave.must("EnterInitializationMode")
    slave.set(_row(e, inputs, 0))
    slave.must("ExitInitializationMode")
    time = e.stimuli["time"].tolist()
    rows = [[time[0], *map(float, slave.get(outputs).values())]]
    for k in range(len(time) - 1):
        slave.set(_row(e, inputs, k))
        slave.step(time[k], time[k + 1] - time[k])
        rows.append([time[k + 1], *map(float, slave.get(outputs).values())])
    slave.free()
    return rows


def _row(e: "Experiment", inputs: list[Variable], k: int) -> dict[Variable, Value]:
    """The inputs of a row, each of its type."""
    types = {"Boolean": bool, "Integer": int, "Enumeration": int}
    return {v: types.get(v.type, float)(e.stimuli[v.name][k]) for v in inputs}


DEMANDS: Mapping[str, Demand] = {
    "reference-results": Demand(
        "error",
        "FMI-LS-REF",
        "the FMU gives the reference results that it carries",
        "find what differs, or compute them again",
    ),
}
CHECKS = (Check("reference-results", reference_results),)
