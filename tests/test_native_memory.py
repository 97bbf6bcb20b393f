"""Instances that do not come about, and memory that fails: the reason is told, and all memory given back."""

import ctypes
import re
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from examples import everything, two_ports
from native_fmu import (
    ERROR,
    OK,
    Host,
    native_fmu,
)
from native_modes import KINDS, Memory

from fmu_src.runtime.model import ReducedModel


@pytest.mark.parametrize(
    ("options", "word"),
    [
        ({"name": None}, "instanceName"),
        ({"name": b""}, "instanceName"),
        ({"name": b" \t\r\n"}, "instanceName"),
        ({"kind": 2}, "fmuType"),
        ({"kind": -1}, "fmuType"),
        ({"guid": None}, "GUID"),
        ({"guid": b""}, "GUID"),
        ({"guid": b"{00000000-0000-0000-0000-000000000000}"}, "GUID"),
        ({"guid": b"%s%n%n%s #r1#"}, "%s%n%n%s #r1#"),
        ({"guid": b"\xc3\xbc" * 1_000_000}, "GUID"),
        ({"resources": None}, "resource"),
        ({"resources": b""}, "resource"),
        ({"resources": b"no URI"}, "guid.txt"),
        ({"resources": b"http://example.org/resources"}, "file"),
        ({"resources": b"file:"}, "resource"),
        ({"resources": b"file:///%"}, "fmuResourceLocation"),
        ({"resources": b"file:///%00"}, "fmuResourceLocation"),
        ({"resources": b"file:///not/there"}, "guid.txt"),
        *(({"resources": f"file:///{k * 'a'}{300 * 'ü'}".encode()}, "fmi2Instantiate") for k in range(2)),
        ({"resources": b"file:///" + 1_000_000 * b"a"}, "fmi2Instantiate"),
    ],
)
def test_refused_instantiation(options: dict[str, Any], word: str) -> None:
    memory = Memory()
    host = memory.host()
    assert native_fmu(two_ports).instantiate(host=host, logging=False, **options) is None
    (message,) = host.log
    assert (message.status, message.category) == (ERROR, "logStatusError")
    assert word in message.text
    assert len(message.format.decode()) < 1000  # no character is cut in two
    assert memory.balanced


def test_the_guid_must_be_equal_to_its_end() -> None:
    fmu = native_fmu(two_ports)
    for guid in (fmu.guid[:-1], fmu.guid + "x", fmu.guid + " "):
        assert fmu.instantiate(guid=guid.encode()) is None


def test_no_callbacks() -> None:
    assert native_fmu(two_ports).library.fmi2Instantiate(b"one", 1, b"", b"", None, 0, 0) is None


def test_one_of_the_memory_functions_is_missing() -> None:
    for host in (Host(allocate=Memory().allocate), Host(release=Memory().release)):
        assert native_fmu(two_ports).instantiate(host=host) is None
        assert "allocateMemory and freeMemory" in host.log[0].text


def test_neither_logger_nor_memory() -> None:
    fmu = native_fmu(two_ports)
    assert fmu.instantiate(host=Host(silent=True), guid=b"wrong") is None
    x = fmu.instance(host=Host(silent=True))
    assert x.step(0.0, 0.1) == ERROR
    x.initialise()
    assert x.step(0.0, -1.0) == ERROR
    assert x.step(0.0, 0.1) == OK
    x.free()


@pytest.mark.parametrize("name", [b"%s%n%d%%", b"#r1# ##", "größe ∞".encode(), b"n" * 1_000_000])
def test_any_instance_name(name: bytes) -> None:
    memory = Memory()
    x = native_fmu(two_ports).instance(name=name, host=memory.host())
    assert x.step(0.0, 0.1) == ERROR
    assert x.call("SetDebugLogging", 1, 1, (ctypes.c_char_p * 1)(name)) == ERROR
    for message in x.log:
        assert message.instance == name.decode()
        assert re.fullmatch(r"([^%#]|%%|##)*", message.format.decode())
    x.free()
    assert memory.balanced


def whole_life(memory: Memory, kind: int) -> None:
    """Everything that may allocate; what is refused for lack of memory changes nothing."""
    x = native_fmu(two_ports).instantiate(kind, host=memory.host())
    if x is None:
        return
    x.initialise({"left.force.x": 1.0})
    states = []
    for _ in range(2):
        state, before = ctypes.c_void_p(), x.reals()
        status = x.call("GetFMUstate", ctypes.byref(state))
        assert status in (OK, ERROR)
        assert (status == OK) == (state.value is not None)
        np.testing.assert_array_equal(x.reals(), before)
        states.append(state)
    if states[0].value is not None:
        size = ctypes.c_size_t()
        x.must("SerializedFMUstateSize", states[0], ctypes.byref(size))
        saved = ctypes.create_string_buffer(size.value)
        x.must("SerializeFMUstate", states[0], saved, size)
        again = ctypes.c_void_p()
        if x.call("DeSerializeFMUstate", saved, size, ctypes.byref(again)) == OK:
            x.must("SetFMUstate", again)
        states.append(again)
    for state in states:
        x.must("FreeFMUstate", ctypes.byref(state))
        assert state.value is None
    x.must("Reset")
    x.initialise()
    x.must("Terminate")
    x.free()


@pytest.mark.parametrize("kind", KINDS)
def test_every_allocation_may_fail(kind: int) -> None:
    memory = Memory()
    whole_life(memory, kind)
    assert memory.balanced
    for k in range(memory.calls):
        failing = Memory(fail_at=k)
        whole_life(failing, kind)
        assert failing.calls > k
        assert failing.balanced, k
    assert memory.calls > 10  # the component, its name, the model's arrays, the instance, three states


@pytest.mark.parametrize("make", [two_ports, everything])
def test_a_run_allocates_nothing(make: Callable[[], ReducedModel]) -> None:
    """Not even new step sizes, nor modes that are coupled again."""
    memory = Memory()
    x = native_fmu(make).instance(host=memory.host()).initialise()
    state = ctypes.c_void_p()
    x.must("GetFMUstate", ctypes.byref(state))
    before, t = memory.calls, 0.0
    for k in range(50):
        h = 0.1 / (k + 1)
        assert x.set({"left.force.x": k, "damping.alpha": 0.1 * k}) == OK
        assert x.set_active(k % 7) == OK
        assert x.set_rates([0], [1], [1.0]) == OK
        assert x.step(t, h) == OK
        t += h
        x.must("GetFMUstate", ctypes.byref(state))  # into the memory it already has
        x.must("SetFMUstate", state)
        x.directional(x.fmu.outputs, x.fmu.inputs, np.arange(len(x.fmu.inputs)))
        x.reals()
    x.must("Reset")
    assert memory.calls == before
    x.must("FreeFMUstate", ctypes.byref(state))
    x.free()
    assert memory.balanced
