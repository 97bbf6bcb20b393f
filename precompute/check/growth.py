"""Memory over many lives, steps and states (section 2.1.5): it must not grow.

Bytes in use by malloc, where glibc tells them, to the byte; else the resident pages of the process. After a
warm-up, blocks of repetitions: what all of them but one grow by is a leak, not chance.
"""

import ctypes
import gc
import platform
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import pairwise
from pathlib import Path

from .check import Check, always, needs
from .description import Description
from .driver import Fmu, Slave
from .finding import Demand, Finding
from .runs import inputs_at
from .state import deserialised, saved, serialised

BLOCKS = 6
ROUNDS = 3  # of blocks, each of which must grow: a long warm-up is no leak
LEAST = 8.0  # bytes of malloc per repetition that are no chance: its smallest block is larger
PAGES = 4096.0  # resident bytes per repetition


class _Mallinfo(ctypes.Structure):
    """struct mallinfo2 of glibc 2.33"""

    _fields_ = tuple(
        (name, ctypes.c_size_t)
        for name in (
            "arena",
            "ordblks",
            "smblks",
            "hblks",
            "hblkhd",
            "usmblks",
            "fsmblks",
            "uordblks",
            "f",
            "k",
        )
    )


def in_use() -> tuple[float, float]:
    """Bytes that malloc has given out, NaN where nobody knows; resident bytes."""
    gc.collect()
    heap = float("nan")
    if platform.libc_ver()[0] == "glibc":
        mallinfo = getattr(ctypes.CDLL(None), "mallinfo2", None)
        if mallinfo is not None:
            mallinfo.restype = _Mallinfo
            info = mallinfo()
            heap = float(info.uordblks + info.hblkhd)
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    return heap, pages * 4096.0


def growing(
    name: str,
    said: str,
    each: Callable[[Fmu, Slave, int], None],
    repetitions: int,
    hindrance: Callable[[Description], str | None] = always,
) -> Check:
    """Something done over and over, by one instance."""

    def check(fmu: Fmu) -> Iterator[Finding]:
        slave = fmu.slave(logging=False).initialise(fmu.start)
        counter = 0
        for _ in range(ROUNDS):
            rows = []
            for _ in range(BLOCKS + 2):
                for _ in range(repetitions):
                    each(fmu, slave, counter)
                    counter += 1
                slave.host.log.clear()
                rows.append(in_use())
            kept = _kept(rows[1:], repetitions)
            if kept is None:  # what grew before was a warm-up
                break
        slave.free()
        if kept is not None:
            yield Finding("memory-growth", f"each {said} takes {kept} and keeps them")

    def why(description: Description) -> str | None:
        known = Path("/proc/self/statm").exists()
        return hindrance(description) if known else "this platform does not tell how much memory is in use"

    return Check(f"memory-growth {name}", check, why)


def _kept(rows: Sequence[tuple[float, float]], repetitions: int) -> str | None:
    """What a repetition keeps in all blocks but one."""
    for place, least, what in ((0, LEAST, "bytes of the heap"), (1, PAGES, "resident bytes")):
        grown = sorted((b[place] - a[place]) / repetitions for a, b in pairwise(rows))
        if grown[1] >= least:
            return f"{grown[1]:.0f} {what}"
    return None


def life(fmu: Fmu, _: Slave, __: int) -> None:
    """From fmi2Instantiate to fmi2FreeInstance."""
    slave = fmu.slave(logging=False).initialise(fmu.start)
    for k in range(3):
        slave.set(inputs_at(fmu, k))
        slave.step(fmu.point(k), fmu.h)
    slave.must("Terminate")
    slave.free()


def step(fmu: Fmu, slave: Slave, counter: int) -> None:
    """Inputs, a step, outputs; from the beginning where the stop time comes."""
    k = counter % min(fmu.most, 1 << 20)
    if k == 0 and counter:
        slave.must("Reset")
        slave.initialise(fmu.start)
    slave.set(inputs_at(fmu, k % 16))
    slave.step(fmu.point(k), fmu.h)
    slave.get(fmu.description.real_outputs)


def state(fmu: Fmu, slave: Slave, _: int) -> None:
    """Saved, set, serialised where that is declared, freed."""
    held = saved(slave)
    slave.must("SetFMUstate", held)
    if fmu.description.can("canSerializeFMUstate"):
        content, _kept = serialised(slave, held)
        again = deserialised(slave, content)
        slave.must("FreeFMUstate", ctypes.byref(again))
    slave.must("FreeFMUstate", ctypes.byref(held))


def reset(fmu: Fmu, slave: Slave, _: int) -> None:
    """Begun anew."""
    slave.must("Reset")
    slave.initialise(fmu.start)


DEMANDS: Mapping[str, Demand] = {
    "memory-growth": Demand(
        "error",
        "2.1.5",
        "what is repeated takes no more memory each time",
        "free it; valgrind or a sanitizer names it",
    ),
}
CHECKS = (
    growing("over lives", "life of an instance", life, 8),
    growing("over steps", "step", step, 60),
    growing("over resets", "fmi2Reset", reset, 16),
    growing("over states", "state that is saved and freed", state, 16, needs("canGetAndSetFMUstate")),
)
