"""A serialised state in another process, as after a night on a disk: python -m precompute.check.elsewhere …

FMU: the unpacked folder; STEPS: of a run; STATE: the bytes; the values after each step go to stdout, as JSON.
"""

import json
import os
import signal
import subprocess
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from tempfile import TemporaryDirectory

from .check import Check
from .description import read_description
from .driver import Fmu, Refused
from .finding import Demand, Finding
from .runs import difference, run
from .state import deserialised, saved, serialised, serialises, started

PATIENCE = 30.0  # s


def elsewhere(fmu: Fmu) -> Iterator[Finding]:
    """The run goes on in a new process as it does here."""
    slave, half = started(fmu)
    content, _ = serialised(slave, saved(slave))
    expected = run(fmu, slave, half, half)
    slave.free()
    with TemporaryDirectory(prefix="check") as place:
        file, values = Path(place) / "state", Path(place) / "values"
        file.write_bytes(content)
        arguments = [str(fmu.folder), str(fmu.steps), str(file), str(values)]
        command = [sys.executable, "-m", "precompute.check.elsewhere", *arguments]
        try:
            done = subprocess.run(command, capture_output=True, check=False, timeout=PATIENCE)
        except subprocess.TimeoutExpired:
            yield Finding(
                "serialise-elsewhere", f"the process that took the state up gave no answer for {PATIENCE:g} s"
            )
            return
        rows = json.loads(values.read_text(encoding="utf-8")) if values.exists() else None
    name = "serialise-elsewhere"
    if isinstance(rows, str):
        yield Finding(name, rows)
    elif rows is None:
        yield Finding(name, f"the process that took the state up ended with {done.returncode}")
    elif apart := difference(
        expected, [dict(zip(fmu.description.variables, row, strict=True)) for row in rows]
    ):
        yield Finding(name, f"taken up in another process, {apart}")


def main(folder: str, steps: str, state: str, values: str) -> None:
    """Take up the state and go on."""
    if hasattr(signal, "alarm"):  # it ends by itself, should the process that waits for it be ended before
        signal.alarm(int(PATIENCE) + 1)
    fmu = Fmu(Path(folder), read_description(Path(folder)), int(steps), lambda call: None)
    slave = fmu.slave().initialise(fmu.start)
    told: object
    try:
        slave.must("SetFMUstate", deserialised(slave, Path(state).read_bytes()))
        half = fmu.steps // 2
        told = [list(row.values()) for row in run(fmu, slave, half, half)]
    except Refused as refused:
        told = str(refused)
    Path(values).write_text(json.dumps(told), encoding="utf-8")


DEMANDS: Mapping[str, Demand] = {
    "serialise-elsewhere": Demand(
        "error",
        "2.1.8",
        "the bytes of a state can be stored, and taken up by another process",
        "write values, not addresses",
    ),
}
CHECKS = (Check("serialise-elsewhere", elsewhere, serialises),)


if __name__ == "__main__":
    main(*sys.argv[1:])
    os._exit(0)
