"""Instances: alike, beside each other, begun anew, ended (sections 2.1.5, 2.1.6)."""

from collections.abc import Iterator, Mapping, Sequence

from .check import Check
from .description import Description
from .driver import Ended, Fmu, Refused
from .finding import Demand, Finding
from .runs import Snapshot, difference, fresh_run, inputs_at, observed, run, tuned

PHASES = (0.0, 2.0)  # of the inputs of two instances


def repeatable(fmu: Fmu) -> Iterator[Finding]:
    """Two instances, one after the other, with the same inputs."""
    apart = difference(fresh_run(fmu, fmu.steps), fresh_run(fmu, fmu.steps))
    if apart:
        yield Finding("not-repeatable", f"run a second time by a new instance, {apart}")


def beside(fmu: Fmu) -> Iterator[Finding]:
    """Two instances step by turns, with inputs and parameters of their own, as each does alone."""
    alone = [_together(fmu, [which])[0] for which in (0, 1)]
    try:
        both = _together(fmu, [0, 1])
    except Refused as refused:
        yield Finding("second-instance", f"while another one lives, {refused}")
        return
    for which, expected, got in zip(("first", "second"), alone, both, strict=True):
        apart = difference(expected, got)
        if apart:
            yield Finding("second-instance", f"the {which} of two instances: {apart}")


def _together(fmu: Fmu, which: Sequence[int]) -> list[list[Snapshot]]:
    """Runs of instances that set, step and read in turn; the second one is tuned, and outlives the first."""
    slaves = [fmu.slave(("one", "two")[i]).initialise(fmu.start) for i in which]
    rows: list[list[Snapshot]] = [[] for _ in which]
    for k in range(fmu.steps):
        for i, slave in zip(which, slaves, strict=True):
            slave.set({**inputs_at(fmu, k, PHASES[i]), **(tuned(fmu.description) if i and k == 2 else {})})
        try:
            for slave in slaves:
                slave.step(fmu.point(k), fmu.h)
        except Ended:
            break
        for slave, row in zip(slaves, rows, strict=True):
            row.append(slave.get(observed(fmu)))
    for slave, row in zip(slaves, rows, strict=True):
        row.append(slave.get(observed(fmu)))  # those before it are gone
        slave.free()
    return rows


def reset(fmu: Fmu) -> Iterator[Finding]:
    """After fmi2Reset an instance is as new, from wherever it was."""
    new = fmu.slave().initialise(fmu.start)
    expected = [new.get(observed(fmu)), *run(fmu, new, 0, fmu.steps)]
    new.free()
    slave = fmu.slave().initialise(fmu.start)
    run(fmu, slave, 0, fmu.steps // 2, phase=2.0)
    slave.set(tuned(fmu.description))
    run(fmu, slave, fmu.steps // 2, fmu.steps // 2, phase=2.0)
    for where in ("between steps", "after fmi2Terminate"):
        if where == "after fmi2Terminate":
            slave.must("Terminate")
        slave.must("Reset")
        slave.initialise(fmu.start)
        got = [slave.get(observed(fmu)), *run(fmu, slave, 0, fmu.steps)]
        apart = difference(expected, got, 0)
        if apart:
            yield Finding("reset", f"after fmi2Reset {where}, {apart}")
            break
    slave.free()


def terminate(fmu: Fmu) -> Iterator[Finding]:
    """The last values can be read after fmi2Terminate."""
    slave = fmu.slave().initialise(fmu.start)
    rows = run(fmu, slave, 0, fmu.steps)
    slave.must("Terminate")
    apart = difference(rows[-1:], [slave.get(observed(fmu))][: len(rows)])
    if apart:
        yield Finding("get-after-terminate", apart)
    slave.free()


def several(description: Description) -> str | None:
    """The check needs more than one instance in a process."""
    once = description.can("canBeInstantiatedOnlyOncePerProcess")
    return "canBeInstantiatedOnlyOncePerProcess is declared" if once else None


DEMANDS: Mapping[str, Demand] = {
    "not-repeatable": Demand(
        "warning",
        "4.1.1",
        "the same inputs give the same outputs",
        "initialise all memory; draw random numbers from a seed that is a parameter",
    ),
    "second-instance": Demand(
        "error",
        "2.1.5",
        "instances do not know of each other",
        "keep nothing in static variables, or declare canBeInstantiatedOnlyOncePerProcess",
    ),
    "reset": Demand(
        "error",
        "2.1.6",
        "after fmi2Reset an instance is as after fmi2Instantiate",
        "set every variable and state back",
    ),
    "get-after-terminate": Demand(
        "error",
        "2.1.6",
        "the final values can be read after fmi2Terminate",
        "keep them until fmi2FreeInstance",
    ),
}
CHECKS = (
    Check("not-repeatable", repeatable, several),
    Check("second-instance", beside, several),
    Check("reset", reset, several),
    Check("get-after-terminate", terminate, crash="get-after-terminate"),
)
