"""What everything else needs: the library, an instance, its initialisation, one step."""

from collections.abc import Iterator, Mapping

from .check import Check
from .driver import Fmu, Refused
from .finding import Demand, Finding
from .runs import run


def functions(fmu: Fmu) -> Iterator[Finding]:
    """All functions of a co-simulation FMU are there, and their versions right."""
    for name in fmu.library.missing:
        yield Finding("missing-function", f"fmi2{name} is not in the library")
    for name, expected in (("GetVersion", "2.0"), ("GetTypesPlatform", "default")):
        if name not in fmu.library.missing:
            got = fmu.library.call(name)
            if got != expected.encode():
                said = "NULL" if got is None else got.decode(errors="replace")
                yield Finding("version", f"fmi2{name} gives {said!r}, expected {expected!r}")


def first_step(fmu: Fmu) -> Iterator[Finding]:
    """fmi2Instantiate … one fmi2DoStep … fmi2FreeInstance, with everything right."""
    if fmu.library.missing:
        return
    try:
        slave = fmu.slave()
    except Refused as refused:
        yield Finding("instantiation", str(refused))
        return
    try:
        slave.initialise(fmu.start)
    except Refused as refused:
        yield Finding("initialisation", str(refused))
        return
    try:
        run(fmu, slave, 0, 1)
        slave.must("Terminate")
    except Refused as refused:
        yield Finding("first-step", f"{refused}{fmu.guessed}")
        return
    slave.free()


def unload(fmu: Fmu) -> Iterator[Finding]:
    """The library is taken out of the process, when no instance is left."""
    fmu.unload()
    yield from ()


DEMANDS: Mapping[str, Demand] = {
    "missing-function": Demand(
        "error",
        "2.3",
        "all functions of a co-simulation FMU are there",
        "export it; what is not supported returns fmi2Error",
    ),
    "version": Demand(
        "error",
        "2.1.4",
        "fmi2GetVersion gives 2.0, fmi2GetTypesPlatform default",
        "return those of the headers",
    ),
    "instantiation": Demand(
        "error", "2.1.5", "with the right arguments fmi2Instantiate gives an instance", "see what it logged"
    ),
    "initialisation": Demand(
        "error",
        "2.1.6",
        "fmi2SetupExperiment, Enter- and ExitInitializationMode succeed with the start values",
        "choose start values with which the model can begin",
    ),
    "unload": Demand(
        "error",
        "2.3",
        "with no instance left the library can be unloaded",
        "leave no threads, hooks or handlers behind",
    ),
    "first-step": Demand("error", "4.2.2", "the first step succeeds", "see what it logged"),
}
CHECKS = (
    Check("functions", functions),
    Check("first-step", first_step),
    Check("unload", unload, crash="unload"),
)
