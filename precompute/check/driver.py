"""An FMU that is driven: its instances, each call with its status as it is."""

import _ctypes
import ctypes
import sys
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from ctypes import c_double, c_int, c_uint
from functools import cached_property
from pathlib import Path
from typing import Any

from .description import Description, Value, Variable
from .host import Callbacks, Host
from .library import (
    CO_SIMULATION,
    DISCARD,
    ELEMENT,
    GUARDS,
    KINDS,
    OK,
    PENDING,
    TERMINATED,
    UNTOUCHED,
    WARNING,
    Library,
    library_suffix,
    platform_folder,
    status_name,
)

MOST = 1 << 30  # steps, where the stop time is far away


class Refused(Exception):
    """A legal call was not answered by fmi2OK or fmi2Warning."""

    def __init__(self, call: str, status: str, said: str) -> None:
        words = f": {' '.join(said.split())}" if said else ", and said nothing"
        super().__init__(f"fmi2{call} gave {status}{words}")


class NotLoaded(Exception):
    """The library cannot be loaded."""


class OnlyOnce(Exception):
    """The FMU says that a process can have one instance of it, and it has had that."""


class Ended(Exception):
    """The FMU wants the simulation to end; it may."""


class Slave:
    """One instance. What must succeed raises Refused; `call` gives the status as it is."""

    def __init__(self, library: Library, component: int, host: Host, callbacks: Callbacks) -> None:
        self._library, self.component, self.host = library, component, host
        self.overrun = ""  # what a getter wrote behind its array
        self.callbacks = callbacks  # as long as the instance

    def call(self, name: str, *arguments: Any) -> int:
        """The status of fmi2<name>."""
        return int(self._library.call(name, self.component, *arguments))

    def must(self, name: str, *arguments: Any) -> None:
        """The same, for a call that is legal."""
        before = len(self.host.log)
        status = self.call(name, *arguments)
        if status not in (OK, WARNING):
            said = [message.text for message in self.host.log[before:]]
            raise Refused(name, status_name(status), said[-1] if said else "")

    def unnoticed(self, name: str, *arguments: Any) -> bool:
        """Whether a call that is not legal is taken without a word, by its status and in the log."""
        before = len(self.host.log)
        status = self.call(name, *arguments)
        logged = any(message.status >= DISCARD for message in self.host.log[before:])
        return status == OK and not logged

    def free(self) -> None:
        """fmi2FreeInstance"""
        self._library.call("FreeInstance", self.component)

    # from mode to mode
    def setup(self, start: float, stop: float | None = None) -> None:
        """fmi2SetupExperiment without a tolerance."""
        self.must("SetupExperiment", 0, 0.0, start, int(stop is not None), stop or 0.0)

    def initialise(self, start: float, stop: float | None = None) -> "Slave":
        """From instantiated to step mode."""
        self.setup(start, stop)
        self.must("EnterInitializationMode")
        self.must("ExitInitializationMode")
        return self

    def step(self, point: float, h: float) -> None:
        """fmi2DoStep. Raises Refused; Ended where the FMU wants to stop."""
        before = len(self.host.log)
        status = self.call("DoStep", point, h, 1)
        while status == PENDING:
            time.sleep(1e-3)
            done = c_int(PENDING)
            self.must("GetStatus", 0, ctypes.byref(done))
            status = done.value
        if status == DISCARD:
            wants = c_int(0)
            if self.call("GetBooleanStatus", TERMINATED, ctypes.byref(wants)) == OK and wants.value:
                raise Ended
        if status not in (OK, WARNING):
            said = [message.text for message in self.host.log[before:]]
            raise Refused("DoStep", status_name(status), said[-1] if said else "")

    # variables
    def set(self, values: Mapping[Variable, Value]) -> None:
        """Each by its type."""
        for kind in KINDS:
            chosen = [v for v in values if v.getter == kind]
            if chosen:
                self.must(
                    f"Set{kind}", *arrays(kind, [v.reference for v in chosen], [values[v] for v in chosen])
                )

    def get(self, variables: Iterable[Variable]) -> dict[Variable, Value]:
        """Each by its type."""
        listed = list(variables)
        found: dict[Variable, Value] = {}
        for kind in KINDS:
            chosen = [v for v in listed if v.getter == kind]
            if chosen:
                found |= dict(zip(chosen, self._get(kind, [v.reference for v in chosen]), strict=True))
        return {v: found[v] for v in listed}

    def _get(self, kind: str, references: Sequence[int]) -> list[Value]:
        count = len(references)
        values = (ELEMENT[kind] * (count + GUARDS))()
        ctypes.memset(values, UNTOUCHED, ctypes.sizeof(values))
        self.must(f"Get{kind}", (c_uint * count)(*references), count, values)
        size = ctypes.sizeof(ELEMENT[kind])
        if bytes(values)[count * size :] != bytes([UNTOUCHED]) * (GUARDS * size):
            self.overrun = f"fmi2Get{kind} of {count} values wrote behind the last of them"
        if kind == "String":
            return [(values[k] or b"").decode(errors="replace") for k in range(count)]
        return list(values[:count])

    # derivatives
    def directional(
        self, unknowns: Sequence[int], knowns: Sequence[int], seed: Sequence[float]
    ) -> list[float]:
        """fmi2GetDirectionalDerivative, by value references."""
        n, m = len(unknowns), len(knowns)
        result = (c_double * n)()
        self.must(
            "GetDirectionalDerivative",
            *((c_uint * n)(*unknowns), n, (c_uint * m)(*knowns), m),
            *((c_double * m)(*seed), result),
        )
        return list(result)

    def output_rates(self, references: Sequence[int], order: int) -> list[float]:
        """fmi2GetRealOutputDerivatives"""
        n = len(references)
        result = (c_double * n)()
        self.must("GetRealOutputDerivatives", (c_uint * n)(*references), n, (c_int * n)(*[order] * n), result)
        return list(result)

    def set_rates(self, *rates: Mapping[Variable, float]) -> None:
        """fmi2SetRealInputDerivatives, of the orders 1, 2, … in one call."""
        given = [(v.reference, i, rate) for i, of_it in enumerate(rates, 1) for v, rate in of_it.items()]
        n = len(given)
        references, orders, values = zip(*given, strict=True)
        self.must(
            "SetRealInputDerivatives",
            *((c_uint * n)(*references), n, (c_int * n)(*orders), (c_double * n)(*values)),
        )


def arrays(kind: str, references: Sequence[int], values: Sequence[Any]) -> tuple[Any, int, Any]:
    """The three arguments of a setter."""
    count = len(references)
    given = [v.encode() if isinstance(v, str) else v for v in values]
    return (c_uint * count)(*references), count, (ELEMENT[kind] * count)(*given)


class Fmu:
    """An unpacked FMU that is being checked.

    folder: where it lies; start, h: of its runs, in s; steps: how many a run takes; most: up to its end.
    """

    def __init__(
        self, folder: Path, description: Description, steps: int, note: Callable[[str], None]
    ) -> None:
        self.folder, self.description, self._note = folder, description, note
        self.instantiated = False
        self.start = description.start or 0.0
        length = None if description.stop is None else description.stop - self.start
        usual = length / 1000 if length is not None and length > 0 else 1e-2
        self.h = description.step if description.step is not None and description.step > 0 else usual
        most = float(MOST) if length is None or length <= 0 else length / self.h * (1 + 1e-9)
        self.most = max(2, int(min(most, MOST)))
        self.steps = min(steps, self.most)

    @property
    def guessed(self) -> str:
        """What to say of a step that the FMU may not be made for; empty where it names its size."""
        return "" if self.description.step else f"; the FMU names no stepSize, so {self.h:g} s were tried"

    @property
    def spent(self) -> bool:
        """No more instances can be had in this process."""
        return self.instantiated and self.description.can("canBeInstantiatedOnlyOncePerProcess")

    @cached_property
    def library(self) -> Library:
        """Loaded when it is first needed. Raises NotLoaded where it cannot be."""
        try:
            return Library(binary(self.folder, self.description), self._note)
        except OSError as error:
            raise NotLoaded(str(error)) from None

    def unload(self) -> None:
        """Take the library out of the process; it is loaded again where it is needed again."""
        handle = self.library.handle._handle
        self._note("unloading the library")
        if sys.platform == "win32":
            _ctypes.FreeLibrary(handle)
        else:
            _ctypes.dlclose(handle)
        self._note("")
        del self.__dict__["library"]

    def resources(self) -> str:
        """The URI of the folder of the resources."""
        return (self.folder / "resources").as_uri()

    def instantiate(
        self,
        name: str = "checked",
        *,
        guid: str | None = None,
        resources: str | None = None,
        logging: bool = True,
        host: Host | None = None,
        callbacks: Callbacks | None = None,
    ) -> Slave | None:
        """None where the FMU refuses. guid, resources: None for the right ones."""
        if self.spent:
            raise OnlyOnce
        self.instantiated = True
        host = host or Host()
        callbacks = callbacks or host.callbacks()
        component = self.library.call(
            "Instantiate",
            *(name.encode(), CO_SIMULATION, (self.description.guid if guid is None else guid).encode()),
            *((self.resources() if resources is None else resources).encode(), ctypes.addressof(callbacks)),
            *(0, int(logging)),
        )
        return Slave(self.library, component, host, callbacks) if component else None

    def slave(self, name: str = "checked", **options: Any) -> Slave:
        """An instance that must come about."""
        host: Host = options.setdefault("host", Host())
        made = self.instantiate(name, **options)
        if made is None:
            raise Refused("Instantiate", "NULL", host.log[-1].text if host.log else "")
        return made

    def point(self, k: int) -> float:
        """The k-th communication point."""
        return self.start + k * self.h


def binary(folder: Path, description: Description) -> Path:
    """Where the library of this platform must be."""
    return folder / "binaries" / platform_folder() / f"{description.identifier}{library_suffix()}"
