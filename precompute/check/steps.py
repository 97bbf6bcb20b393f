"""Steps and time: sizes that vary, where a run begins, points that are rounded (section 4.2.2)."""

import ctypes
from collections.abc import Iterator, Mapping, Sequence
from ctypes import c_double, c_int

from .check import Check, needs
from .description import Variable
from .driver import Ended, Fmu, Refused
from .finding import Demand, Finding
from .library import LAST_SUCCESSFUL_TIME, OK, TERMINATED
from .runs import inputs_at, observed, run, shown

# parts of 12 steps: each size other than its neighbours, fewer and more of them than 12
COARSE = (2.0, 1.0, 3.0, 2.0, 1.5, 2.5)
FINE = (0.5, 1.0, 0.25, 0.75, 0.5, 1.0, 0.5, 0.5, 1.0, 0.25, 0.75, 1.0, 0.5, 1.0, 0.5, 0.75, 0.25, 1.0)
APART = 0.05  # of what a variable moves: the FMU's solver may depend on the step a little


def variable_step(fmu: Fmu) -> Iterator[Finding]:
    """With inputs that are held, steps of other sizes lead to much the same values at the same time."""
    watched = fmu.description.real_outputs
    even, moves = _through(fmu, [1.0] * 12, watched)
    for sizes in (COARSE, FINE):
        got, _ = _through(fmu, sizes, watched)
        for v in watched:
            if abs(got[v] - even[v]) > APART * moves[v]:
                yield Finding(
                    "variable-step",
                    f"{v.name} at {fmu.point(12):g} s is {shown(even[v])} after 12 equal steps, "
                    f"{shown(got[v])} after {len(sizes)} unequal ones",
                )
                return


def _through(
    fmu: Fmu, sizes: Sequence[float], watched: Sequence[Variable]
) -> tuple[dict[Variable, float], dict[Variable, float]]:
    """Values at the end, and how far each moved on the way."""
    slave = fmu.slave().initialise(fmu.start)
    slave.set(inputs_at(fmu, 2))
    rows = []
    passed = 0.0
    for size in sizes:
        slave.step(fmu.point(0) + passed * fmu.h, size * fmu.h)
        passed += size
        rows.append({v: float(value) for v, value in slave.get(watched).items()})
    slave.free()
    moves = {v: max(row[v] for row in rows) - min(row[v] for row in rows) for v in watched}
    floor = {v: max(moves[v], 1e-6 * abs(rows[-1][v])) for v in watched}
    return rows[-1], floor


def start_time(fmu: Fmu) -> Iterator[Finding]:
    """A run begins at the start time of fmi2SetupExperiment, whatever it is."""
    later = fmu.start + 8 * fmu.h
    slave = fmu.slave().initialise(later)
    try:
        for k in range(2):
            slave.set(inputs_at(fmu, k))
            slave.step(later + k * fmu.h, fmu.h)
    except Refused as refused:
        yield Finding("start-time", f"started at {later:g} s: {refused}")
    slave.free()


def rounded_points(fmu: Fmu) -> Iterator[Finding]:
    """Masters form a communication point as t + h or as k h; these differ by rounding."""
    count = 200 if fmu.description.stop is None else min(200, fmu.most)
    for how in ("k h", "t + h"):
        slave = fmu.slave().initialise(fmu.start)
        t = fmu.start
        try:
            for k in range(count):
                here = fmu.start + k * fmu.h if how == "k h" else t
                slave.step(here, fmu.h)
                t += fmu.h
        except Refused as refused:
            yield Finding("time-rounding", f"with points formed as {how}: {refused}")
        slave.free()


def independent(fmu: Fmu) -> Iterator[Finding]:
    """The variable that is time has the time at which a step ended."""
    time = next(v for v in fmu.description.variables if v.causality == "independent")
    slave = fmu.slave().initialise(fmu.start)
    for k, row in enumerate(run(fmu, slave, 0, fmu.steps)):
        if abs(float(row[time]) - fmu.point(k + 1)) > 1e-6 * fmu.h:
            seen = f"{time.name} is {shown(row[time])} at {fmu.point(k + 1):.10g} s"
            yield Finding("time-variable", f"{seen}{fmu.guessed}")
            break
    slave.free()


def status(fmu: Fmu) -> Iterator[Finding]:
    """The end of the last step, where the FMU tells it."""
    slave = fmu.slave().initialise(fmu.start)
    run(fmu, slave, 0, 3)
    reached, wants = c_double(-1.0), c_int(-1)
    known = slave.call("GetRealStatus", LAST_SUCCESSFUL_TIME, ctypes.byref(reached)) == OK
    if known and not abs(reached.value - fmu.point(3)) <= 1e-6 * fmu.h:
        seen = f"fmi2LastSuccessfulTime is {reached.value:g} s at {fmu.point(3):g} s"
        yield Finding("step-status", f"{seen}{fmu.guessed}")
    if slave.call("GetBooleanStatus", TERMINATED, ctypes.byref(wants)) == OK and wants.value != 0:
        yield Finding("step-status", "fmi2Terminated is true after a step of fmi2OK")
    slave.free()


def whole_run(fmu: Fmu) -> Iterator[Finding]:
    """A run with moving inputs comes to its end."""
    slave = fmu.slave().initialise(fmu.start)
    for k in range(fmu.steps):
        slave.set(inputs_at(fmu, k))
        try:
            slave.step(fmu.point(k), fmu.h)
        except Ended:
            break
        except Refused as refused:
            yield Finding("step-refused", f"from {fmu.point(k):g} s: {refused}")
            break
        slave.get(observed(fmu))
    slave.free()


DEMANDS: Mapping[str, Demand] = {
    "step-refused": Demand(
        "error", "4.2.2", "steps with inputs near their start values succeed", "see what it logged"
    ),
    "variable-step": Demand(
        "error",
        "4.3.1",
        "with canHandleVariableCommunicationStepSize each step goes to currentCommunicationPoint + size",
        "use the size that is given, or take the flag off",
    ),
    "start-time": Demand(
        "error", "4.2.2", "the first step begins at startTime of fmi2SetupExperiment", "begin where it says"
    ),
    "time-rounding": Demand(
        "warning",
        "4.2.2",
        "a communication point differs from the FMU's own time by rounding",
        "compare with a tolerance",
    ),
    "step-status": Demand(
        "error",
        "4.2.3",
        "fmi2GetXXXStatus tells of the last step, or gives fmi2Discard",
        "keep its end and its status",
    ),
    "time-variable": Demand(
        "error",
        "4.2.2",
        "a step ends exactly at currentCommunicationPoint + communicationStepSize",
        "set the time so",
    ),
}
CHECKS = (
    Check("run", whole_run),
    Check("variable-step", variable_step, needs("canHandleVariableCommunicationStepSize")),
    Check("start-time", start_time),
    Check("step-status", status),
    Check("time-rounding", rounded_points),
    Check(
        "time-variable",
        independent,
        lambda d: (
            None if any(v.causality == "independent" for v in d.variables) else "no variable is the time"
        ),
    ),
)
