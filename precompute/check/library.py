"""An FMU's library by ctypes: its functions, with their arguments; every call is noted before it is made."""

import ctypes
import platform
import sys
from collections.abc import Callable, Mapping
from ctypes import c_char_p, c_double, c_int, c_size_t, c_void_p
from pathlib import Path
from typing import Any

OK, WARNING, DISCARD, ERROR, FATAL, PENDING = range(6)
STATUS = ("fmi2OK", "fmi2Warning", "fmi2Discard", "fmi2Error", "fmi2Fatal", "fmi2Pending")
CO_SIMULATION = 1
LAST_SUCCESSFUL_TIME, TERMINATED = 2, 3  # of fmi2StatusKind
KINDS = ("Real", "Integer", "Boolean", "String")
GUARDS, UNTOUCHED = 4, 0x5A  # elements behind the array of a getter, and their bytes
ELEMENT: Mapping[str, Any] = {"Real": c_double, "Integer": c_int, "Boolean": c_int, "String": c_char_p}

# the arguments behind the component, of the functions that a co-simulation FMU must have (section 2.3)
_POINTER, _ARRAYS = c_void_p, (c_void_p, c_size_t, c_void_p)
CALLS: Mapping[str, tuple[Any, ...]] = {
    "SetDebugLogging": (c_int, c_size_t, _POINTER),
    "SetupExperiment": (c_int, c_double, c_double, c_int, c_double),
    "EnterInitializationMode": (),
    "ExitInitializationMode": (),
    "Terminate": (),
    "Reset": (),
    **{f"{verb}{kind}": _ARRAYS for verb in ("Get", "Set") for kind in KINDS},
    "GetFMUstate": (_POINTER,),
    "SetFMUstate": (_POINTER,),
    "FreeFMUstate": (_POINTER,),
    "SerializedFMUstateSize": (_POINTER, _POINTER),
    "SerializeFMUstate": (_POINTER, _POINTER, c_size_t),
    "DeSerializeFMUstate": (_POINTER, c_size_t, _POINTER),
    "GetDirectionalDerivative": (_POINTER, c_size_t, _POINTER, c_size_t, _POINTER, _POINTER),
    "SetRealInputDerivatives": (_POINTER, c_size_t, _POINTER, _POINTER),
    "GetRealOutputDerivatives": (_POINTER, c_size_t, _POINTER, _POINTER),
    "DoStep": (c_double, c_double, c_int),
    "CancelStep": (),
    **{f"Get{kind}Status": (c_int, _POINTER) for kind in ("", *KINDS)},
}
FUNCTIONS = ("GetTypesPlatform", "GetVersion", "Instantiate", "FreeInstance", *CALLS)


def platform_folder() -> str:
    """The folder of this machine's binaries (section 2.3)."""
    bits = "64" if sys.maxsize > 2**32 else "32"
    machine = platform.machine().lower()
    if machine in ("arm64", "aarch64"):
        return {"Darwin": "darwin64", "Windows": "aarch64-windows"}.get(platform.system(), "aarch64-linux")
    return {"Darwin": "darwin", "Windows": "win"}.get(platform.system(), "linux") + bits


def library_suffix() -> str:
    """The ending of a shared library's name."""
    return {"Darwin": ".dylib", "Windows": ".dll"}.get(platform.system(), ".so")


class Library:
    """The functions of an FMU's library. Raises OSError where it cannot be loaded."""

    def __init__(self, path: Path, note: Callable[[str], None]) -> None:
        self._note = note
        note("loading the library")
        self.handle = ctypes.CDLL(str(path))
        self.missing = [name for name in FUNCTIONS if not hasattr(self.handle, f"fmi2{name}")]
        for name, arguments in CALLS.items():
            if name not in self.missing:
                getattr(self.handle, f"fmi2{name}").argtypes = (c_void_p, *arguments)
        if "Instantiate" not in self.missing:
            self.handle.fmi2Instantiate.argtypes = (
                c_char_p,
                c_int,
                c_char_p,
                c_char_p,
                c_void_p,
                c_int,
                c_int,
            )
            self.handle.fmi2Instantiate.restype = c_void_p
        if "FreeInstance" not in self.missing:
            self.handle.fmi2FreeInstance.argtypes = (c_void_p,)
            self.handle.fmi2FreeInstance.restype = None
        for name in ("GetVersion", "GetTypesPlatform"):
            if name not in self.missing:
                getattr(self.handle, f"fmi2{name}").restype = c_char_p

    def call(self, name: str, *arguments: Any) -> Any:
        """fmi2<name>"""
        self._note(f"fmi2{name}")
        result = getattr(self.handle, f"fmi2{name}")(*arguments)
        self._note("")
        return result


def status_name(status: int) -> str:
    """fmi2OK …, or the number where it is none of them."""
    return STATUS[status] if 0 <= status < len(STATUS) else f"the status {status}"
