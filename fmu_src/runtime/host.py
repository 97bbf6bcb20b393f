"""Two faults of pythonfmu 0.7.0's library, mended from inside the payload."""

import _ctypes
import ctypes
import os
import sys
from pathlib import Path
from typing import Any

_kept: list[dict[str, Any]] = []


def keep(namespace: dict[str, Any]) -> None:
    """Hold one more reference to the entry module's namespace.

    The library runs the entry module's text at every instantiation and then gives back a reference
    to its namespace that it never took; the second instance would find the module emptied.
    """
    _kept.append(namespace)


def release_interpreter(resources: Path, model_identifier: str) -> None:
    """Let the library forget the interpreter that the host owns, while that is still safe.

    On Linux the library drops its interpreter state when it is unloaded, twice: the second time its memory
    has been freed, and the host's heap may be damaged. Dropped now, there is nothing left to drop.
    Only where the host is a Python program: elsewhere the library owns the interpreter and must keep it.
    """
    if sys.platform != "linux" or Path("/proc/self/exe").resolve() != Path(sys.executable or "").resolve():
        return
    library = resources.parent / "binaries" / "linux64" / f"{model_identifier}.so"
    try:
        loaded = ctypes.PyDLL(str(library), mode=os.RTLD_NOLOAD)
    except OSError:
        return  # not loaded from there: this is the build, or another host's layout
    loaded.finalizePythonInterpreter()
    _ctypes.dlclose(loaded._handle)
