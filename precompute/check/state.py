"""The FMU's state: saved, restored, serialised (section 2.1.8)."""

import ctypes
from collections.abc import Iterator, Mapping
from ctypes import c_size_t, c_void_p

from .check import Check, needs
from .description import Description
from .driver import Fmu, Slave
from .finding import Demand, Finding
from .host import GUARD, overwrite
from .runs import SMALL, difference, run, size_of, tuned


def saved(slave: Slave, into: c_void_p | None = None) -> c_void_p:
    """fmi2GetFMUstate, into a state that is there already or a new one."""
    state = c_void_p() if into is None else into
    slave.must("GetFMUstate", ctypes.byref(state))
    return state


def serialised(slave: Slave, state: c_void_p) -> tuple[bytes, bool]:
    """The state as bytes, and whether the FMU kept to the size that it named."""
    size = c_size_t()
    slave.must("SerializedFMUstateSize", state, ctypes.byref(size))
    buffer = ctypes.create_string_buffer(size.value + len(GUARD))
    overwrite(buffer, size.value, GUARD)
    slave.must("SerializeFMUstate", state, buffer, size)
    return buffer.raw[: size.value], buffer.raw[size.value :] == GUARD


def deserialised(slave: Slave, content: bytes) -> c_void_p:
    """fmi2DeSerializeFMUstate"""
    state = c_void_p()
    slave.must(
        "DeSerializeFMUstate",
        ctypes.create_string_buffer(content, len(content)),
        len(content),
        ctypes.byref(state),
    )
    return state


def started(fmu: Fmu) -> tuple[Slave, int]:
    """An instance half-way through its run, and the number of steps that it made."""
    half = fmu.steps // 2
    slave = fmu.slave().initialise(fmu.start)
    run(fmu, slave, 0, half)
    return slave, half


def restore(fmu: Fmu) -> Iterator[Finding]:
    """What follows a restored state is what followed it the first time, as often as one likes."""
    slave, half = started(fmu)
    state = saved(slave)
    here = slave.get(fmu.description.variables)
    first = run(fmu, slave, half, half)
    for attempt in ("first", "second"):
        slave.must("SetFMUstate", state)
        apart = difference([here], [slave.get(fmu.description.variables)])
        apart = apart or difference(first, run(fmu, slave, half, half))
        if apart:
            yield Finding("state-restore", f"restored for the {attempt} time, {apart}")
            break
    slave.free()


def inputs_in_state(fmu: Fmu) -> Iterator[Finding]:
    """The values of the inputs, and their derivatives for the next step, are part of the state."""
    slave, half = started(fmu)
    ramps = {v: SMALL * size_of(v) / fmu.h for v in fmu.description.real_inputs}
    if ramps and fmu.description.can("canInterpolateInputs"):
        slave.set_rates(ramps)
    state = saved(slave)
    slave.step(fmu.point(half), fmu.h)
    held = slave.get(fmu.description.variables)
    run(fmu, slave, half + 1, 2, phase=2.0)
    slave.must("SetFMUstate", state)
    slave.step(fmu.point(half), fmu.h)
    apart = difference([held], [slave.get(fmu.description.variables)])
    if apart:
        yield Finding("state-inputs", f"with the inputs not set again, {apart}")
    slave.free()


def parameters_in_state(fmu: Fmu) -> Iterator[Finding]:
    """The values of the parameters are part of the state."""
    slave, half = started(fmu)
    state = saved(slave)
    expected = run(fmu, slave, half, 2)
    slave.must("SetFMUstate", state)
    slave.set(tuned(fmu.description))
    run(fmu, slave, half, 2)
    slave.must("SetFMUstate", state)
    apart = difference(expected, run(fmu, slave, half, 2))
    if apart:
        yield Finding("state-parameters", f"tuned after it was saved, the state restored, {apart}")
    slave.free()


def lives(fmu: Fmu) -> Iterator[Finding]:
    """A state can be overwritten, freed, and freed when there is none."""
    slave, half = started(fmu)
    state = saved(slave)
    run(fmu, slave, half, 1)
    later = slave.get(fmu.description.variables)
    state = saved(slave, state)
    run(fmu, slave, half + 1, 1)
    slave.must("SetFMUstate", state)
    apart = difference([later], [slave.get(fmu.description.variables)])
    if apart:
        yield Finding("state-overwrite", f"saved into a state that was there already, {apart}")
    slave.must("FreeFMUstate", ctypes.byref(state))
    if state.value:
        yield Finding("state-free", "fmi2FreeFMUstate left its pointer as it was")
    nothing = c_void_p()
    if slave.call("FreeFMUstate", ctypes.byref(nothing)) > 1:
        yield Finding("state-free", "fmi2FreeFMUstate refused a NULL state")
    slave.free()


def after_terminate(fmu: Fmu) -> Iterator[Finding]:
    """A state brings a terminated instance back between its steps."""
    slave, half = started(fmu)
    state = saved(slave)
    expected = run(fmu, slave, half, 1)
    slave.must("Terminate")
    slave.must("SetFMUstate", state)
    apart = difference(expected, run(fmu, slave, half, 1))
    if apart:
        yield Finding("state-restore", f"restored after fmi2Terminate, {apart}")
    slave.free()


def roundtrip(fmu: Fmu) -> Iterator[Finding]:
    """Bytes make the same state again, in the instance they came from and in another one."""
    slave, half = started(fmu)
    content, kept = serialised(slave, saved(slave))
    if not kept:
        yield Finding("serialise-size", "fmi2SerializeFMUstate wrote behind the size it was given")
    expected = run(fmu, slave, half, half)
    other = fmu.slave("another").initialise(fmu.start)
    for who, made in (("the same instance", slave), ("another instance", other)):
        again = deserialised(made, content)
        made.must("SetFMUstate", again)
        apart = difference(expected, run(fmu, made, half, half))
        if apart:
            yield Finding("serialise-roundtrip", f"set from its bytes in {who}, {apart}")
            break
        made.must("FreeFMUstate", ctypes.byref(again))
    other.free()
    slave.free()


def serialises(description: Description) -> str | None:
    """The check needs both capabilities."""
    return needs("canGetAndSetFMUstate")(description) or needs("canSerializeFMUstate")(description)


def _tunable(description: Description) -> str | None:
    found = needs("canGetAndSetFMUstate")(description)
    return found or (None if tuned(description) else "no Real parameter is tunable")


DEMANDS: Mapping[str, Demand] = {
    "state-restore": Demand(
        "error",
        "2.1.8",
        "what follows a restored state is what followed it before, to the bit",
        "save and restore everything that a later call reads",
    ),
    "state-inputs": Demand(
        "error", "2.1.8", "the state holds the values of the inputs", "save the inputs too"
    ),
    "state-parameters": Demand(
        "error",
        "2.1.8",
        "the state holds the values of the parameters",
        "save them, and what was made of them",
    ),
    "state-overwrite": Demand(
        "error",
        "2.1.8",
        "fmi2GetFMUstate into a state that is there puts the actual one into it",
        "copy into it",
    ),
    "state-free": Demand(
        "error",
        "2.1.8",
        "fmi2FreeFMUstate ignores a NULL state and gives a null pointer back",
        "set *FMUstate to NULL",
    ),
    "serialise-size": Demand(
        "error",
        "2.1.8",
        "fmi2SerializeFMUstate keeps to the size that it named",
        "name the size that is written",
    ),
    "serialise-roundtrip": Demand(
        "error",
        "2.1.8",
        "a state made from its bytes is the state they were made of",
        "write values, not pointers, and all of them",
    ),
}
CHECKS = (
    Check("state-restore", restore, needs("canGetAndSetFMUstate")),
    Check("state-inputs", inputs_in_state, needs("canGetAndSetFMUstate")),
    Check("state-parameters", parameters_in_state, _tunable),
    Check("state-lives", lives, needs("canGetAndSetFMUstate")),
    Check("state-after-terminate", after_terminate, needs("canGetAndSetFMUstate")),
    Check("serialise", roundtrip, serialises),
)
