"""Calls that are not legal where they are made (section 4.2.4): they must not pass unseen.

Unseen is: fmi2OK, and no error in the log. Each call is made to an instance of its own.
"""

import ctypes
from collections.abc import Iterator, Mapping
from ctypes import c_double, c_uint

from .check import Check
from .description import Description
from .driver import Fmu, Slave
from .finding import Demand, Finding
from .runs import run


def _in_mode(fmu: Fmu, mode: str) -> Slave:
    slave = fmu.slave()
    if mode == "instantiated":
        return slave
    slave.setup(fmu.start)
    slave.must("EnterInitializationMode")
    if mode == "initialising":
        return slave
    slave.must("ExitInitializationMode")
    run(fmu, slave, 0, 1)
    if mode == "terminated":
        slave.must("Terminate")
    return slave


def illegal(name: str, mode: str, call: str, said: str) -> Check:
    """fmi2<call> in a mode in which the table has no cross."""

    def check(fmu: Fmu) -> Iterator[Finding]:
        slave = _in_mode(fmu, mode)
        if slave.unnoticed(call, *_arguments(fmu, mode, call)):
            yield Finding(name, f"fmi2{call} {said} gave fmi2OK, and nothing was logged")
        slave.free()

    def hindrance(description: Description) -> str | None:
        asks = call in ("GetReal", "SetReal") and all(v.type != "Real" for v in description.variables)
        return "there is no Real" if asks else None

    return Check(f"{name} {said}", check, hindrance, crash=name)


def _arguments(fmu: Fmu, mode: str, call: str) -> tuple[object, ...]:
    if call == "DoStep":
        return fmu.point(1 if mode == "terminated" else 0), fmu.h, 1
    if call == "SetupExperiment":
        return 0, 0.0, fmu.start, 0, 0.0
    if call in ("GetReal", "SetReal"):
        reals = [v for v in fmu.description.variables if v.type == "Real"]
        wanted = "input" if call == "SetReal" else "output"
        chosen = [v for v in reals if v.causality == wanted][:1] or reals[:1]
        return (c_uint * 1)(*(v.reference for v in chosen)), len(chosen), (c_double * 1)(0.0)
    return ()


def step_size(name: str, h: float, said: str) -> Check:
    """A step of a size that is none."""

    def check(fmu: Fmu) -> Iterator[Finding]:
        slave = _in_mode(fmu, "stepping")
        if slave.unnoticed("DoStep", fmu.point(1), h * fmu.h, 1):
            yield Finding(name, f"fmi2DoStep with communicationStepSize = {h * fmu.h:g} gave fmi2OK")
        slave.free()

    return Check(f"{name} {said}", check, crash=name)


def point_mismatch(name: str, steps: int, said: str) -> Check:
    """A step that does not begin where the last one ended."""

    def check(fmu: Fmu) -> Iterator[Finding]:
        slave = _in_mode(fmu, "stepping")
        run(fmu, slave, 1, 3)
        if slave.unnoticed("DoStep", fmu.point(4 + steps), fmu.h, 1):
            yield Finding(
                name, f"fmi2DoStep from {fmu.point(4 + steps):g} s, {said} {fmu.point(4):g} s, gave fmi2OK"
            )
        slave.free()

    return Check(name, check, crash=name)


def past_stop_time(fmu: Fmu) -> Iterator[Finding]:
    """A step beyond the stop time that fmi2SetupExperiment fixed."""
    slave = fmu.slave().initialise(fmu.start, fmu.point(2))
    run(fmu, slave, 0, 2)
    if slave.unnoticed("DoStep", fmu.point(2), fmu.h, 1):
        yield Finding("past-stop-time", f"a step from stopTime = {fmu.point(2):g} s on gave fmi2OK")
    slave.free()


def unknown_reference(call: str) -> Check:
    """A value reference that no variable has."""

    def check(fmu: Fmu) -> Iterator[Finding]:
        slave = _in_mode(fmu, "stepping")
        used = {v.reference for v in fmu.description.variables}
        for reference in (max(used, default=0) + 1, 0xFFFFFFFE):
            values = ctypes.create_string_buffer(64)
            if slave.unnoticed(call, (c_uint * 1)(reference), 1, values):
                yield Finding(
                    "unknown-reference-accepted", f"fmi2{call} of the value reference {reference} gave fmi2OK"
                )
                break
        slave.free()

    return Check(f"unknown-reference {call}", check, crash="unknown-reference-accepted")


def nothing_asked(fmu: Fmu) -> Iterator[Finding]:
    """Getters and setters of no variables, without arrays."""
    slave = _in_mode(fmu, "stepping")
    for call in ("GetReal", "SetReal", "GetInteger", "SetInteger"):
        status = slave.call(call, None, 0, None)
        if status > 1:
            yield Finding("empty-call-refused", f"fmi2{call} of 0 variables was refused")
    slave.free()


DEMANDS: Mapping[str, Demand] = {
    "step-before-initialisation": Demand(
        "warning",
        "4.2.4",
        "fmi2DoStep is legal after fmi2ExitInitializationMode only",
        "keep the mode, and return fmi2Error in others",
    ),
    "step-after-terminate": Demand(
        "warning", "4.2.4", "fmi2DoStep is not legal after fmi2Terminate", "return fmi2Error"
    ),
    "set-after-terminate": Demand(
        "warning", "4.2.4", "fmi2SetXXX is not legal after fmi2Terminate", "return fmi2Error"
    ),
    "get-before-initialisation": Demand(
        "warning", "4.2.4", "fmi2GetXXX is legal from fmi2EnterInitializationMode on", "return fmi2Error"
    ),
    "wrong-mode": Demand(
        "warning",
        "4.2.4",
        "each call is legal in the modes of the table only",
        "keep the mode, return fmi2Error",
    ),
    "step-zero": Demand(
        "warning", "4.2.2", "communicationStepSize is greater than 0", "return fmi2Error where it is not"
    ),
    "time-going-back": Demand(
        "warning",
        "4.2.2",
        "currentCommunicationPoint is where the last step ended, unless a state was restored",
        "keep the time, and return fmi2Error where it differs by more than rounding",
    ),
    "time-gap": Demand(
        "warning",
        "4.2.2",
        "currentCommunicationPoint is where the last step ended",
        "keep the time, and return fmi2Error where it differs by more than rounding",
    ),
    "past-stop-time": Demand(
        "error",
        "2.1.6",
        "a step past the stop time of fmi2SetupExperiment is fmi2Error",
        "keep stopTime and compare",
    ),
    "unknown-reference-accepted": Demand(
        "warning",
        "2.1.7",
        "value references are those of the model description",
        "return fmi2Error for others",
    ),
    "empty-call-refused": Demand(
        "note", "2.1.7", "a call for no variables does nothing", "return fmi2OK where nvr is 0"
    ),
}
CHECKS = (
    illegal("step-before-initialisation", "instantiated", "DoStep", "before fmi2EnterInitializationMode"),
    illegal("step-before-initialisation", "initialising", "DoStep", "in initialization mode"),
    illegal("step-after-terminate", "terminated", "DoStep", "after fmi2Terminate"),
    illegal("set-after-terminate", "terminated", "SetReal", "after fmi2Terminate"),
    illegal("get-before-initialisation", "instantiated", "GetReal", "before fmi2EnterInitializationMode"),
    illegal("wrong-mode", "instantiated", "ExitInitializationMode", "without EnterInitializationMode"),
    illegal("wrong-mode", "stepping", "EnterInitializationMode", "between steps"),
    illegal("wrong-mode", "stepping", "SetupExperiment", "between steps"),
    illegal("wrong-mode", "instantiated", "Terminate", "before initialisation"),
    illegal("wrong-mode", "stepping", "CancelStep", "without a pending step"),
    step_size("step-zero", 0.0, "of no length"),
    step_size("step-zero", -1.0, "backwards"),
    point_mismatch("time-going-back", -2, "after steps up to"),
    point_mismatch("time-gap", 3, "after steps up to"),
    Check("past-stop-time", past_stop_time),
    *(unknown_reference(f"{verb}{kind}") for verb in ("Get", "Set") for kind in ("Real", "Integer")),
    Check("empty-call", nothing_asked, crash="empty-call-refused"),
)
