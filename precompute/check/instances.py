"""Instances: alike, beside each other, begun anew, ended (sections 2.1.5, 2.1.6)."""

from collections.abc import Iterator

from .check import Check
from .description import Description
from .driver import Fmu, Refused
from .finding import Finding
from .runs import Snapshot, difference, fresh_run, observed, run

PHASES = (0.0, 2.0)  # of the inputs of two instances


def repeatable(fmu: Fmu) -> Iterator[Finding]:
    """Two instances, one after the other, with the same inputs."""
    apart = difference(fresh_run(fmu, fmu.steps), fresh_run(fmu, fmu.steps))
    if apart:
        yield Finding("not-repeatable", f"run a second time by a new instance, {apart}")


def beside(fmu: Fmu) -> Iterator[Finding]:
    """Two instances step by turns, with inputs of their own, as each does alone."""
    alone = [fresh_run(fmu, fmu.steps, phase) for phase in PHASES]
    try:
        both = [fmu.slave(name).initialise(fmu.start) for name in ("one", "two")]
    except Refused as refused:
        yield Finding("second-instance", f"while another one lives, {refused}")
        return
    rows: tuple[list[Snapshot], list[Snapshot]] = ([], [])
    for k in range(fmu.steps):
        for slave, row, phase in zip(both, rows, PHASES, strict=True):
            row += run(fmu, slave, k, 1, phase)
    both[0].free()
    for which, expected, got in zip(("first", "second"), alone, rows, strict=True):
        apart = difference(expected, got)
        if apart:
            yield Finding("second-instance", f"the {which} of two instances: {apart}")
    apart = difference(rows[1][-1:], [both[1].get(observed(fmu))][: len(rows[1])])
    if apart:
        yield Finding("second-instance", f"after the first of two was freed, in the second {apart}")
    both[1].free()


def reset(fmu: Fmu) -> Iterator[Finding]:
    """After fmi2Reset an instance is as new, from wherever it was."""
    expected = fresh_run(fmu, fmu.steps)
    slave = fmu.slave().initialise(fmu.start)
    run(fmu, slave, 0, fmu.steps, phase=2.0)
    for where in ("between steps", "after fmi2Terminate"):
        if where == "after fmi2Terminate":
            slave.must("Terminate")
        slave.must("Reset")
        slave.initialise(fmu.start)
        apart = difference(expected, run(fmu, slave, 0, fmu.steps))
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


CHECKS = (
    Check("not-repeatable", repeatable, several),
    Check("second-instance", beside, several),
    Check("reset", reset, several),
    Check("get-after-terminate", terminate),
)
