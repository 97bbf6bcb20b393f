"""The native FMU through ctypes: every call gives its status as a number, every message is kept."""

import ctypes
import tempfile
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from ctypes import c_char_p, c_double, c_int, c_size_t, c_uint, c_void_p
from dataclasses import dataclass, field
from functools import cache
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
from fmpy import extract, platform, read_model_description, sharedLibraryExtension

from fmu_src.native_fmu import build_native_fmu
from fmu_src.runtime.model import Floats, ReducedModel

OK, WARNING, DISCARD, ERROR, FATAL, PENDING = range(6)
MODEL_EXCHANGE, CO_SIMULATION = range(2)

# the arguments of fmi2XXX behind the component
POINTER, SIZE, REFERENCE, REAL, INTEGER = c_void_p, c_size_t, c_uint, c_double, c_int
ARRAYS = (POINTER, SIZE, POINTER)
CALLS: Mapping[str, tuple[type, ...]] = {
    "SetDebugLogging": (INTEGER, SIZE, POINTER),
    "SetupExperiment": (INTEGER, REAL, REAL, INTEGER, REAL),
    "EnterInitializationMode": (),
    "ExitInitializationMode": (),
    "Terminate": (),
    "Reset": (),
    **{
        f"{verb}{kind}": ARRAYS
        for verb in ("Get", "Set")
        for kind in ("Real", "Integer", "Boolean", "String")
    },
    "GetFMUstate": (POINTER,),
    "SetFMUstate": (POINTER,),
    "FreeFMUstate": (POINTER,),
    "SerializedFMUstateSize": (POINTER, POINTER),
    "SerializeFMUstate": (POINTER, POINTER, SIZE),
    "DeSerializeFMUstate": (POINTER, SIZE, POINTER),
    "GetDirectionalDerivative": (POINTER, SIZE, POINTER, SIZE, POINTER, POINTER),
    "SetRealInputDerivatives": (POINTER, SIZE, POINTER, POINTER),
    "GetRealOutputDerivatives": (POINTER, SIZE, POINTER, POINTER),
    "DoStep": (REAL, REAL, INTEGER),
    "CancelStep": (),
    **{f"Get{kind}Status": (INTEGER, POINTER) for kind in ("", "Real", "Integer", "Boolean", "String")},
    "EnterEventMode": (),
    "NewDiscreteStates": (POINTER,),
    "EnterContinuousTimeMode": (),
    "CompletedIntegratorStep": (INTEGER, POINTER, POINTER),
    "SetTime": (REAL,),
    "SetContinuousStates": (POINTER, SIZE),
    "GetDerivatives": (POINTER, SIZE),
    "GetEventIndicators": (POINTER, SIZE),
    "GetContinuousStates": (POINTER, SIZE),
    "GetNominalsOfContinuousStates": (POINTER, SIZE),
}

# a message that is whole has no arguments behind it, so the callback needs no variable list of them
Logger = ctypes.CFUNCTYPE(None, c_void_p, c_char_p, c_int, c_char_p, c_char_p)
Allocate = ctypes.CFUNCTYPE(c_void_p, c_size_t, c_size_t)
Release = ctypes.CFUNCTYPE(None, c_void_p)


class Callbacks(ctypes.Structure):
    """fmi2CallbackFunctions"""

    _fields_ = (
        ("logger", Logger),
        ("allocate", Allocate),
        ("release", Release),
        ("step_finished", c_void_p),
        ("environment", c_void_p),
    )


class EventInfo(ctypes.Structure):
    """fmi2EventInfo"""

    _fields_ = (
        ("new_discrete_states_needed", c_int),
        ("terminate", c_int),
        ("nominals_changed", c_int),
        ("states_changed", c_int),
        ("next_event_defined", c_int),
        ("next_event", c_double),
    )


@dataclass(frozen=True)
class Message:
    instance: str
    status: int
    category: str
    text: str
    format: bytes  # the text as the logger gets it


@dataclass
class Host:
    """The callbacks of a master: its log, and its memory where `allocate` and `release` are given."""

    allocate: Callable[[int, int], int | None] | None = None
    release: Callable[[int], None] | None = None
    silent: bool = False
    log: list[Message] = field(default_factory=list)

    def callbacks(self) -> Callbacks:
        return Callbacks(
            Logger() if self.silent else Logger(self._note),
            Allocate(self.allocate) if self.allocate else Allocate(),
            Release(self.release) if self.release else Release(),
        )

    def _note(self, environment: int, instance: bytes, status: int, category: bytes, message: bytes) -> None:
        text = message.decode(errors="replace").replace("%%", "%").replace("##", "#")
        self.log.append(Message(instance.decode(), status, category.decode(), text, message))


class Instance:
    """One fmi2Component. Statuses are returned; only a getter that is not fmi2OK raises."""

    def __init__(self, fmu: "NativeFmu", kind: int, component: int, host: Host, callbacks: Callbacks) -> None:
        self.fmu, self.kind, self.component, self.host = fmu, kind, component, host
        self._callbacks = callbacks  # must live as long as the component

    @property
    def log(self) -> list[Message]:
        return self.host.log

    def call(self, name: str, *arguments: Any) -> int:
        """fmi2<name>; an array of numpy stands for a pointer, None for NULL."""
        return self.fmu.call(name, self.component, *arguments)

    def must(self, name: str, *arguments: Any) -> None:
        status = self.call(name, *arguments)
        assert status == OK, (name, status, self.log[-1:])

    def free(self) -> None:
        self.fmu.library.fmi2FreeInstance(self.component)
        self.component = 0

    # variables, by reference and by name
    def set_real(self, references: Iterable[int], values: Iterable[float]) -> int:
        vr, value = np.array([*references], np.uint32), np.array([*values], float)
        return self.call("SetReal", vr, len(vr), value)

    def get_real(self, references: Iterable[int]) -> Floats:
        vr = np.array([*references], np.uint32)
        value = np.full(len(vr), -7.0)
        self.must("GetReal", vr, len(vr), value)
        return value

    def set(self, values: Mapping[str, float]) -> int:
        return self.set_real([self.fmu.reference[name] for name in values], values.values())

    def get(self, *names: str) -> Floats:
        return self.get_real([self.fmu.reference[name] for name in names])

    def reals(self) -> Floats:
        """All Reals."""
        return self.get_real(range(self.fmu.size))

    def set_active(self, active: int) -> int:
        return self.call("SetInteger", np.zeros(1, np.uint32), 1, np.array([active], np.int32))

    def get_active(self) -> int:
        value = np.full(1, -7, np.int32)
        self.must("GetInteger", np.zeros(1, np.uint32), 1, value)
        return int(value[0])

    # from mode to mode
    def initialise(self, values: Mapping[str, float] | None = None, start: float = 0.0) -> "Instance":
        """Into step mode or event mode."""
        self.must("SetupExperiment", 0, 0.0, start, 0, 0.0)
        self.must("EnterInitializationMode")
        assert self.set(values or {}) == OK
        self.must("ExitInitializationMode")
        return self

    # co-simulation
    def step(self, time: float, h: float) -> int:
        return self.call("DoStep", time, h, 1)

    def set_rates(self, references: Iterable[int], orders: Iterable[int], values: Iterable[float]) -> int:
        """fmi2SetRealInputDerivatives"""
        vr, order, value = (
            np.array([*references], np.uint32),
            np.array([*orders], np.int32),
            np.array([*values], float),
        )
        return self.call("SetRealInputDerivatives", vr, len(vr), order, value)

    def get_rates(self, references: Iterable[int], orders: Iterable[int]) -> Floats:
        """fmi2GetRealOutputDerivatives"""
        vr, order = np.array([*references], np.uint32), np.array([*orders], np.int32)
        value = np.full(len(vr), -7.0)
        self.must("GetRealOutputDerivatives", vr, len(vr), order, value)
        return value

    # model exchange
    def set_states(self, x: Sequence[float] | Floats) -> int:
        return self.call("SetContinuousStates", np.array(x, float), len(x))

    def get_states(self, what: str = "GetContinuousStates") -> Floats:
        """Also GetDerivatives and GetNominalsOfContinuousStates."""
        x = np.full(2 * self.fmu.coordinates, -7.0)
        self.must(what, x, len(x))
        return x

    def new_discrete_states(self) -> EventInfo:
        info = EventInfo(*5 * [7], -7.0)
        self.must("NewDiscreteStates", ctypes.byref(info))
        return info

    # derivatives and states
    def directional(
        self, unknowns: Iterable[int], knowns: Iterable[int], direction: Iterable[float]
    ) -> Floats:
        u, k = np.array([*unknowns], np.uint32), np.array([*knowns], np.uint32)
        dk, du = np.array([*direction], float), np.full(len(u), -7.0)
        self.must("GetDirectionalDerivative", u, len(u), k, len(k), dk, du)
        return du

    def save(self) -> bytes:
        """The state, serialised."""
        state, size = c_void_p(), c_size_t()
        self.must("GetFMUstate", ctypes.byref(state))
        self.must("SerializedFMUstateSize", state, ctypes.byref(size))
        buffer = ctypes.create_string_buffer(size.value)
        self.must("SerializeFMUstate", state, buffer, size)
        self.must("FreeFMUstate", ctypes.byref(state))
        return buffer.raw

    def restore(self, saved: bytes) -> int:
        """De-serialise and set; the status of the first that is not fmi2OK."""
        state = c_void_p()
        status = self.call("DeSerializeFMUstate", saved, len(saved), ctypes.byref(state))
        if status == OK:
            status = self.call("SetFMUstate", state)
            self.must("FreeFMUstate", ctypes.byref(state))
        return status


class NativeFmu:
    """The library of one unpacked FMU, and its variables by name."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.description = read_model_description(folder)
        self.guid = self.description.guid
        name = self.description.coSimulation.modelIdentifier
        self.library = ctypes.CDLL(str(folder / "binaries" / platform / f"{name}{sharedLibraryExtension}"))
        reals = [v for v in self.description.modelVariables if v.type == "Real"]
        self.reference = {v.name: int(v.valueReference) for v in self.description.modelVariables}
        self.size = len(reals)  # value references are 0 … size - 1
        self.modes = sum(name.startswith("modes.frequency[") for name in self.reference)
        self.coordinates = len(self.description.derivatives) // 2  # and prescribed motions
        self.inputs = [self.reference[v.name] for v in reals if v.causality == "input"]
        self.outputs = [self.reference[v.name] for v in reals if v.causality == "output"]
        for call, arguments in CALLS.items():
            getattr(self.library, f"fmi2{call}").argtypes = (c_void_p, *arguments)
        self.library.fmi2FreeInstance.argtypes = (c_void_p,)
        self.library.fmi2FreeInstance.restype = None
        instantiate = self.library.fmi2Instantiate
        instantiate.argtypes = (c_char_p, c_int, c_char_p, c_char_p, c_void_p, c_int, c_int)
        instantiate.restype = c_void_p

    def call(self, name: str, component: int | None, *arguments: Any) -> int:
        pointers = (a.ctypes if isinstance(a, np.ndarray) else a for a in arguments)
        status: int = getattr(self.library, f"fmi2{name}")(component, *pointers)
        return status

    @property
    def resources(self) -> str:
        return (self.folder / "resources").as_uri()

    def instantiate(
        self,
        kind: int = CO_SIMULATION,
        name: bytes | None = b"one",
        *,
        guid: bytes | str | None = "",
        resources: bytes | str | None = "",
        host: Host | None = None,
        logging: bool = True,
    ) -> Instance | None:
        """guid, resources: "" for the right ones. None where the FMU refuses; `host.log` says why."""
        host = host or Host()
        callbacks = host.callbacks()
        component = self.library.fmi2Instantiate(
            name,
            kind,
            self.guid.encode() if guid == "" else guid,
            self.resources.encode() if resources == "" else resources,
            ctypes.addressof(callbacks),
            0,
            logging,
        )
        return Instance(self, kind, component, host, callbacks) if component else None

    def instance(self, kind: int = CO_SIMULATION, **options: Any) -> Instance:
        """An instance that must come about."""
        made = self.instantiate(kind, **options)
        assert made is not None
        return made


_FOLDERS = tempfile.TemporaryDirectory(prefix="native_fmu", ignore_cleanup_errors=True)


@cache
def native_fmu(make: Callable[..., ReducedModel], **changes: str | float) -> NativeFmu:
    """The FMU of make(**changes), built and unpacked once."""
    model = make(**changes)
    folder = Path(tempfile.mkdtemp(prefix=model.name, dir=_FOLDERS.name))
    path = build_native_fmu(model, folder / f"{model.name}.fmu")
    extract(path, folder / "unpacked")
    return NativeFmu(folder / "unpacked")


def alone(function: Callable[..., Any], *arguments: Any) -> Any:
    """What a function of a test gives in a process of its own; a crash there is a failed test here."""
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        return pool.submit(function, *arguments).result()
