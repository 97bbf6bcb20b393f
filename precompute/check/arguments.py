"""What fmi2Instantiate is given: GUID, resource location, callbacks, memory (section 2.1.5)."""

import ctypes
import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from shutil import copy2, copytree
from tempfile import TemporaryDirectory

from .check import Check, needs
from .driver import Fmu, Refused, Slave
from .finding import Demand, Finding
from .host import Callbacks, Host, overwrite
from .instances import several
from .library import CO_SIMULATION
from .runs import difference, fresh_run, run
from .state import saved

LARGE = 50_000_000  # bytes of resources that are linked and not copied
NO_GUID = "{00000000-0000-0000-0000-000000000000}"


def wrong_guid(fmu: Fmu) -> Iterator[Finding]:
    """A GUID that is not the FMU's."""
    host = Host()
    slave = fmu.instantiate(guid=NO_GUID, host=host)
    if slave:
        yield Finding("guid-mismatch-accepted", f"fmi2Instantiate took the GUID {NO_GUID}")
        slave.free()
    elif not host.log:
        yield Finding(
            "instantiation-silent", "fmi2Instantiate gave NULL for a wrong GUID and logged no reason"
        )


def resource_location(form: str) -> Check:
    """The folder of the resources by a URI of this form."""

    def check(fmu: Fmu) -> Iterator[Finding]:
        expected = fresh_run(fmu, 2)
        with TemporaryDirectory(prefix="check") as place:
            uri = _uri(fmu, form, Path(place))
            try:
                slave = fmu.slave(resources=uri).initialise(fmu.start)
            except Refused as refused:
                yield Finding("resource-location", f"with {form}: {refused}")
                return
            apart = difference(expected, run(fmu, slave, 0, 2))
            slave.free()
        if apart:
            yield Finding("resource-location", f"with {form}: {apart}")

    return Check(f"resource-location {form}", check, several, crash="resource-location")


def _uri(fmu: Fmu, form: str, place: Path) -> str:
    if form == "file:/path":
        return fmu.resources().replace("file://", "file:", 1)
    folder, copy = fmu.folder / "resources", place / "a folder, 100% ä" / "resources"
    if folder.is_dir():
        size = sum(path.stat().st_size for path in folder.rglob("*") if path.is_file())
        copytree(folder, copy, copy_function=copy2 if size < LARGE else os.link)
    else:
        copy.mkdir(parents=True)
    return copy.as_uri()


def free_null(fmu: Fmu) -> Iterator[Finding]:
    """fmi2FreeInstance of NULL does nothing."""
    fmu.library.call("FreeInstance", None)
    yield from ()


def null_callbacks(fmu: Fmu) -> Iterator[Finding]:
    """Without the memory functions that it says it does not use."""
    host = Host()
    try:
        slave = fmu.slave(host=host, callbacks=host.callbacks(memory=False)).initialise(fmu.start)
        run(fmu, slave, 0, 2)
        slave.free()
    except Refused as refused:
        yield Finding("null-callbacks", str(refused))


def pointers_kept(fmu: Fmu) -> Iterator[Finding]:
    """What fmi2Instantiate was given is overwritten when it returns."""
    expected, told = fresh_run(fmu, 2), _told(fmu.slave().initialise(fmu.start), fmu)
    host = Host()
    kept = host.callbacks()  # the functions live on
    struct = Callbacks.from_buffer_copy(kept)
    given = ("checked", fmu.description.guid, fmu.resources())
    texts = [ctypes.create_string_buffer(text.encode()) for text in given]
    arguments = (texts[0], CO_SIMULATION, texts[1], texts[2], ctypes.addressof(struct), 0, 1)
    component = fmu.library.call("Instantiate", *arguments)
    if not component:
        raise Refused("Instantiate", "NULL", host.log[-1].text if host.log else "")
    for text in texts:
        overwrite(text, 0, b"x" * (len(text) - 1))
    ctypes.memset(ctypes.addressof(struct), 0, ctypes.sizeof(struct))
    slave = Slave(fmu.library, component, host, kept).initialise(fmu.start)
    apart = difference(expected, run(fmu, slave, 0, 2))
    names = sorted({message.instance for message in host.log} - {"checked"})
    names += sorted({name for name, _ in _told(slave, fmu)} - {"checked"})
    silent = bool(told) and not host.log
    slave.free()
    if apart:
        yield Finding("pointer-kept", f"with its arguments overwritten, {apart}")
    if silent:
        yield Finding("pointer-kept", "with the callbacks' struct overwritten it logs nothing any more")
    if names:
        yield Finding("pointer-kept", f"with its name overwritten by the host it logs as {names[0]!r}")


def _told(slave: Slave, fmu: Fmu) -> list[tuple[str, str]]:
    """What is logged of a step of negative size: instance and text."""
    before = len(slave.host.log)
    slave.call("DoStep", fmu.point(2), -1.0, 1)
    return [(message.instance, message.text) for message in slave.host.log[before:]]


def memory(fmu: Fmu) -> Iterator[Finding]:
    """The host's memory functions: bounds kept, everything given back."""
    host = Host()
    slave = fmu.slave(host=host).initialise(fmu.start)
    run(fmu, slave, 0, fmu.steps)
    if fmu.description.can("canGetAndSetFMUstate"):
        before = host.held
        state = saved(slave)
        slave.must("FreeFMUstate", ctypes.byref(state))
        if host.held > before:
            yield Finding("memory-leak", f"after fmi2FreeFMUstate {host.held - before} bytes are still held")
    slave.must("Terminate")
    slave.free()
    host.inspect()
    for misuse in dict.fromkeys(host.misuse):
        yield Finding("memory-misuse", misuse)
    if host.held:
        yield Finding(
            "memory-leak", f"after fmi2FreeInstance {host.held} bytes of allocateMemory are still held"
        )
    if fmu.description.can("canNotUseMemoryManagementFunctions") and host.allocations:
        yield Finding(
            "memory-functions", f"declared not to be used, allocateMemory was called {host.allocations} times"
        )


DEMANDS: Mapping[str, Demand] = {
    "guid-mismatch-accepted": Demand(
        "error",
        "2.1.5",
        "fmi2Instantiate compares the GUID with its own and gives NULL where it is another",
        "compile the GUID in, or read it from the resources, and compare",
    ),
    "instantiation-silent": Demand(
        "warning",
        "2.1.5",
        "where fmi2Instantiate gives NULL, the logger is told why",
        "call the logger before",
    ),
    "resource-location": Demand(
        "error",
        "2.1.5",
        "fmuResourceLocation is a URI: file:///path and file:/path, with escaped characters",
        "take the scheme off and undo the %xx",
    ),
    "free-null": Demand("error", "2.1.5", "fmi2FreeInstance of NULL does nothing", "return at once"),
    "null-callbacks": Demand(
        "error",
        "2.1.5",
        "with canNotUseMemoryManagementFunctions allocateMemory and freeMemory may be NULL",
        "do not call them, or take the flag off",
    ),
    "pointer-kept": Demand(
        "error",
        "2.1.5",
        "arguments of fmi2Instantiate, the callbacks' struct too, are valid during the call only",
        "copy the struct and the texts",
    ),
    "memory-misuse": Demand(
        "error",
        "2.1.5",
        "memory of allocateMemory is used within its bounds and freed once",
        "find it with a sanitizer",
    ),
    "memory-leak": Demand(
        "error", "2.1.5", "fmi2FreeInstance frees all that allocateMemory gave", "free what is named"
    ),
    "memory-functions": Demand(
        "warning",
        "2.1.5",
        "with canNotUseMemoryManagementFunctions the host's functions are not called",
        "take the flag off",
    ),
}
CHECKS = (
    Check("wrong-guid", wrong_guid),
    resource_location("file:/path"),
    resource_location("escaped characters"),
    Check("free-null", free_null, crash="free-null"),
    Check("null-callbacks", null_callbacks, needs("canNotUseMemoryManagementFunctions"), "null-callbacks"),
    Check("pointer-kept", pointers_kept, several, crash="pointer-kept"),
    Check("memory-functions", memory),
)
