"""States that are damaged, or those of others: refused with nothing changed, or else legal ones."""

import ctypes
import struct
from collections.abc import Callable

import numpy as np
import pytest
from examples import two_ports
from native_fmu import (
    CO_SIMULATION,
    ERROR,
    MODEL_EXCHANGE,
    OK,
    Instance,
    alone,
    native_fmu,
)
from native_modes import NOT_FINITE, elastic_ports, instance_in, refused


def test_damaged_states() -> None:
    alone(_damaged_states)


def _damaged_states() -> None:
    for kind, mode in (
        (CO_SIMULATION, "initialization"),
        (CO_SIMULATION, "step"),
        (MODEL_EXCHANGE, "continuous"),
    ):
        x = instance_in(kind, mode)
        if kind == CO_SIMULATION:
            assert x.set_rates([0, 1], [1, 2], [1.0, 2.0]) == OK
        _try_damaged(x, x.save(), (1, 0x80, 0xFF))
        x.free()
    x = native_fmu(elastic_ports, initial="static").instance()
    _try_damaged(x, x.save(), (1, 0x80, 0xFF))
    x.free()


def _try_damaged(x: Instance, good: bytes, patterns: tuple[int, ...]) -> None:
    accepted = 0
    for place in range(len(good)):
        for pattern in patterns:
            bad = bytearray(good)
            bad[place] ^= pattern
            assert x.restore(good) == OK
            status = x.restore(bytes(bad))
            assert status in (OK, ERROR), place
            if status == ERROR:
                assert x.save() == good, place
            else:
                accepted += 1
                assert x.restore(x.save()) == OK, place
                _use(x)
    assert 0 < accepted < len(good) * len(patterns)  # numbers may be others, heads may not


@pytest.mark.parametrize("mode", ["initialization", "step"])
@pytest.mark.parametrize("value", NOT_FINITE)
def test_states_with_numbers_that_cannot_be(value: float, mode: str) -> None:
    """Each number of the instance is found in the bytes by its value; only an input may be anything."""
    x = instance_in(CO_SIMULATION, "initialization")
    numbers = {
        "left.force.z": 0.123,
        "damping.alpha": 1.123,
        "damping.beta": 2.123,
        "modes.amplitude[2]": 3.123,
        "modes.velocity[6]": 4.123,
    }
    assert x.set(numbers) == OK
    if mode == "step":
        x.must("ExitInitializationMode")
    assert x.set_rates([0, 1], [1, 2], [5.123, 6.123]) == OK
    good = x.save()
    for number in (*numbers.values(), 5.123, 6.123):
        found = struct.pack("d", number)
        assert good.count(found) == 1
        expected = OK if number == numbers["left.force.z"] else ERROR
        assert x.restore(good.replace(found, struct.pack("d", value))) == expected, number
        if number in (1.123, 2.123):
            assert x.restore(good.replace(found, struct.pack("d", -number))) == ERROR
        assert x.restore(good) == OK
        assert x.save() == good
    x.free()


def _use(x: Instance) -> None:
    """Run on, wherever that leads."""
    for call in ("EnterInitializationMode", "ExitInitializationMode", "EnterContinuousTimeMode"):
        x.call(call)
    values, references = np.zeros(x.fmu.size), np.arange(x.fmu.size, dtype=np.uint32)
    x.call("GetReal", references, x.fmu.size, values)
    x.call("GetDerivatives", values, 2 * x.fmu.modes)
    time = np.zeros(1)
    x.call("GetRealStatus", 2, time)
    x.step(time[0], 0.1)


@pytest.mark.parametrize("change", [lambda s: s[:-1], lambda s: s + b"\0", lambda s: b"", lambda s: s[:8]])
def test_states_of_another_length(change: Callable[[bytes], bytes]) -> None:
    x = instance_in(CO_SIMULATION, "step")
    good = x.save()
    x.log.clear()
    assert x.restore(change(good)) == ERROR
    assert refused(x, ERROR, "DeSerializeFMUstate", f"expected {len(good)}")
    assert x.save() == good
    x.free()


def test_states_of_others() -> None:
    """Of another part, of an equal part with another damping, of the other use of the same FMU."""
    x = instance_in(CO_SIMULATION, "step")
    others = [
        native_fmu(elastic_ports, initial="rest").instance(),
        native_fmu(two_ports, alpha=0.5).instance(),
        native_fmu(two_ports).instance(MODEL_EXCHANGE),
    ]
    good = x.save()
    for other in others:
        x.log.clear()
        assert x.restore(other.save()) == ERROR
        assert refused(x, ERROR, "DeSerializeFMUstate", "no state of this FMU")
        state = ctypes.c_void_p()
        other.must("GetFMUstate", ctypes.byref(state))
        assert x.call("SetFMUstate", state) == ERROR
        assert refused(x, ERROR, "SetFMUstate", "no state of this FMU")
        other.must("FreeFMUstate", ctypes.byref(state))
        assert x.save() == good
        other.free()
    x.free()


def test_too_little_room_for_a_serialised_state() -> None:
    x = instance_in(CO_SIMULATION, "step")
    state, size = ctypes.c_void_p(), len(x.save())
    x.must("GetFMUstate", ctypes.byref(state))
    room = ctypes.create_string_buffer(b"\7" * size, size + 8)
    x.log.clear()
    assert x.call("SerializeFMUstate", state, room, size - 1) == ERROR
    assert refused(x, ERROR, "SerializeFMUstate", "fmi2SerializedFMUstateSize")
    assert room.raw[:size] == b"\7" * size
    x.must("SerializeFMUstate", state, room, size + 8)
    assert room.raw[:size] == x.save()
    x.must("FreeFMUstate", ctypes.byref(state))
    x.must("FreeFMUstate", ctypes.byref(state))  # NULL by now: ignored
    x.free()


def test_a_status_that_is_none() -> None:
    """What a refused step changes is the status of the last step: fmi2OK … fmi2Error are 0 … 3."""
    x = instance_in(CO_SIMULATION, "step")
    before = x.save()
    assert x.step(0.0, -1.0) == ERROR
    after = bytearray(x.save())
    (place,) = (k for k in range(0, len(after), 8) if after[k : k + 8] != before[k : k + 8])
    assert after[place] == ERROR
    assert x.restore(bytes(after)) == OK
    after[place] = ERROR + 1
    assert x.restore(bytes(after)) == ERROR
    x.free()
