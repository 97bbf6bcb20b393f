"""What the tests of the native FMU's calls share: instances in each mode, arguments, memory that counts."""

import ctypes
import math
from typing import Any

import numpy as np
from driven import part, reduced
from examples import everything, two_ports
from fmpy.fmi2 import calloc, free
from native_fmu import (
    CO_SIMULATION,
    DISCARD,
    ERROR,
    MODEL_EXCHANGE,
    OK,
    EventInfo,
    Host,
    Instance,
    native_fmu,
)
from structures import residual

from fmu_src.runtime.model import ReducedModel

KINDS = [MODEL_EXCHANGE, CO_SIMULATION]
MODES = {
    MODEL_EXCHANGE: ("instantiated", "initialization", "event", "continuous", "terminated"),
    CO_SIMULATION: ("instantiated", "initialization", "step", "failed step", "terminated"),
}
NOT_FINITE = [math.nan, math.inf, -math.inf]


def elastic_ports(initial: str) -> ReducedModel:
    lam = np.array([3.0, 8.0, 30.0, 30.0, 400.0, 9000.0])
    return two_ports(f"elastic_{initial}", lam=lam, initial=initial)


def elastic_everything(initial: str) -> ReducedModel:
    """Every law, feed-through, coupled modes; what is off follows statically."""
    lam = np.array([3.0, 8.0, 30.0, 30.0, 400.0, 9000.0, 2e4])
    return everything(f"elastic_everything_{initial}", lam=lam, initial=initial)


def driven_ports(initial: str) -> ReducedModel:
    """Ports that are moved, modes coupled and dragged by dashpots; what is off follows statically."""
    full = part()
    return reduced(full, name=f"driven_{initial}", initial=initial, **residual(reduced(full)))


def instance_in(kind: int, mode: str, host: Host | None = None) -> Instance:
    x = native_fmu(two_ports).instance(kind, host=host)
    if mode == "instantiated":
        return x
    if mode == "initialization":
        x.must("SetupExperiment", 0, 0.0, 0.0, 0, 0.0)
        x.must("EnterInitializationMode")
        return x
    x.initialise({"modes.velocity[1]": 1.0})
    if mode == "failed step":
        assert x.set({"left.force.x": 1e308}) == OK
        assert x.step(0.0, 1e6) == DISCARD
        assert x.set({"left.force.x": 0.0}) == OK
    elif mode == "continuous":
        x.must("EnterContinuousTimeMode")
    elif mode == "terminated":
        x.must("Terminate")
    return x


def good_arguments(x: Instance, call: str) -> tuple[Any, ...]:
    """With these the call is refused for its mode only."""
    one, place = np.zeros(1), np.zeros(1, np.uint32)
    number, byte, text = np.zeros(1, np.int32), ctypes.c_int(), ctypes.c_char_p()
    states = (np.zeros(2 * x.fmu.modes), 2 * x.fmu.modes)
    saved, state, size = x.save(), ctypes.c_void_p(), ctypes.c_size_t()
    x.must("GetFMUstate", ctypes.byref(state))
    output = np.array(x.fmu.outputs[:1], np.uint32)
    given: dict[str, tuple[Any, ...]] = {
        "SetDebugLogging": (1, 0, None),
        "SetupExperiment": (0, 0.0, 0.0, 0, 0.0),
        "GetReal": (place, 1, one),
        "SetReal": (place, 1, one),
        "GetInteger": (place, 1, number),
        "SetInteger": (place, 1, np.array([x.fmu.modes], np.int32)),
        **{f"{verb}{kind}": (None, 0, None) for verb in ("Get", "Set") for kind in ("Boolean", "String")},
        "GetFMUstate": (ctypes.byref(ctypes.c_void_p()),),
        "SetFMUstate": (state,),
        "FreeFMUstate": (ctypes.byref(state),),
        "SerializedFMUstateSize": (state, ctypes.byref(size)),
        "SerializeFMUstate": (state, ctypes.create_string_buffer(len(saved)), len(saved)),
        "DeSerializeFMUstate": (saved, len(saved), ctypes.byref(ctypes.c_void_p())),
        "GetDirectionalDerivative": (output, 1, place, 1, one, one.copy()),
        "SetRealInputDerivatives": (place, 1, number + 1, one),
        "GetRealOutputDerivatives": (output, 1, number + 1, one),
        "DoStep": (0.0, 0.1, 1),
        "GetStatus": (0, ctypes.byref(byte)),
        "GetRealStatus": (2, one),
        "GetIntegerStatus": (0, number),
        "GetBooleanStatus": (3, ctypes.byref(byte)),
        "GetStringStatus": (1, ctypes.byref(text)),
        "NewDiscreteStates": (ctypes.byref(EventInfo()),),
        "CompletedIntegratorStep": (1, number, number.copy()),
        "SetTime": (0.0,),
        "SetContinuousStates": states,
        "GetDerivatives": states,
        "GetEventIndicators": (None, 0),
        "GetContinuousStates": states,
        "GetNominalsOfContinuousStates": states,
    }
    return given.get(call, ())


class Memory:
    """calloc and free that count, and give nothing at the k-th call (from 0)."""

    def __init__(self, fail_at: int = -1) -> None:
        self.fail_at, self.calls = fail_at, 0
        self.live: set[int] = set()
        self.wrongly_released: list[int | None] = []

    def allocate(self, count: int, size: int) -> int | None:
        self.calls += 1
        if self.calls - 1 == self.fail_at:
            return None
        memory: int = calloc(count, size)
        self.live.add(memory)
        return memory

    def release(self, memory: int | None) -> None:
        if memory in self.live:
            self.live.remove(memory)
            free(memory)
        else:
            self.wrongly_released.append(memory)

    def host(self) -> Host:
        return Host(self.allocate, self.release)

    @property
    def balanced(self) -> bool:
        return not self.live and not self.wrongly_released


def refused(x: Instance, status: int, call: str, *words: str) -> bool:
    """One message of this status, of the call and with these words."""
    (message,) = x.log
    x.log.clear()
    category = {DISCARD: "logStatusDiscard", ERROR: "logStatusError"}[status]
    assert (message.status, message.category) == (status, category)
    assert message.text.startswith(f"fmi2{call}: ")
    assert all(word in message.text for word in words), message.text
    return True
