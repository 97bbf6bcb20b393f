"""A parameter study of one FMU on a Dask cluster: damping, level of detail and force of the cantilever.

    modalfmu build models/cantilever
    python models/sweep/sweep.py cantilever.fmu [--scheduler ADDRESS] [--compare] [--every N] [-o FILE]

Without --scheduler the workers are processes on this machine, one for each processor. Copy it and change what
stands in capitals; it needs nothing of modalfmu, only `pip install fmpy distributed pyarrow`.
"""

import argparse
import os
import shutil
import threading
import time
from collections.abc import Iterable
from io import BytesIO
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from distributed import Client, Worker, WorkerPlugin, get_worker, progress
from fmpy import extract, instantiate_fmu, read_model_description, simulate_fmu

Row = dict[str, Any]

GRID: dict[str, Iterable[float]] = {
    "damping.alpha": np.linspace(0.0, 40.0, 10).tolist(),  # 1/s, on top of the part's own 2 %
    "modes.active": (1, 2, 3, 4, 5, 7, 10, 12, 15, 20),
    "tip.force.z": np.linspace(1.0, 10.0, 10).tolist(),  # N, from t = 0
}
OUTPUT = "tip.displacement.z"
STEP, STOP = 5e-4, 0.5  # s
TASK = 10  # runs, of some 10 ms each; a task costs Dask some milliseconds


def cases() -> list[Row]:
    """Every combination of the values: start values of the FMU by name."""
    return [dict(zip(GRID, values, strict=True)) for values in product(*GRID.values())]


class Part(WorkerPlugin):
    """The FMU on a worker. Its bytes travel with this object, also to workers that come later or come again;
    there it is unzipped once, and each thread keeps an instance that is reset between runs."""

    name = "part"

    def __init__(self, fmu: Path) -> None:
        self.content = fmu.read_bytes()

    def setup(self, worker: Worker | None = None) -> None:
        self.folder = extract(BytesIO(self.content))
        self.description = read_model_description(self.folder)
        self.thread, self.instances = threading.local(), []

    def teardown(self, worker: Worker | None = None) -> None:
        for instance in self.instances:
            instance.freeInstance()
        shutil.rmtree(self.folder, ignore_errors=True)

    def instance(self) -> Any:
        """This thread's, as new; `thread.said` is what it said last."""
        if hasattr(self.thread, "instance"):
            self.thread.instance.reset()
        else:
            self.thread.instance = instantiate_fmu(
                self.folder, self.description, "CoSimulation", logger=self.listen
            )
            self.instances.append(self.thread.instance)
        self.thread.said = ""
        return self.thread.instance

    def listen(self, environment: Any, name: bytes, status: int, category: bytes, message: bytes) -> None:
        self.thread.said = message.decode(errors="replace")

    def run(self, case: Row) -> Row:
        """The case with its response, or with the reason why there is none."""
        try:
            result = simulate_fmu(
                self.folder,
                model_description=self.description,
                fmu_instance=self.instance(),
                start_values=case,
                output=[OUTPUT],
                output_interval=STEP,
                stop_time=STOP,
                step_finished=stopwatch(),
            )
        except Exception as error:  # noqa: BLE001 - FMPy raises Exception itself, and it shall cost one run only
            said = getattr(self.thread, "said", "")
            return case | {"reason": f"{error} {said}".strip()}
        t, u = result["time"], result[OUTPUT]
        if t[-1] < STOP - 0.5 * STEP:
            return case | {"reason": f"the FMU discarded the step from t = {t[-1]:g} s"}
        return case | {"peak": float(np.abs(u).max()), "time": t.tolist(), OUTPUT: u.tolist()}


def stopwatch() -> Any:
    """For FMPy, which repeats a step that the FMU discards without end: go on while the time does."""
    before = -1.0

    def goes_on(t: float, recorder: Any) -> bool:
        nonlocal before
        before, last = t, before
        return t > last

    return goes_on


def run(cases: list[Row]) -> list[Row]:
    """The task of a worker."""
    part: Part = get_worker().plugins[Part.name]
    return [part.run(case) for case in cases]


def sweep(client: Client, fmu: Path, cases: list[Row], size: int = TASK) -> list[Row]:
    """A row for each case, in their order: of what failed, and of what killed its workers, the reason."""
    client.register_plugin(Part(fmu))
    return rows(client, cases, size)


def rows(client: Client, cases: list[Row], size: int) -> list[Row]:
    """So many runs a task; those of a task that killed its workers once more, each by itself."""
    tasks = [cases[k : k + size] for k in range(0, len(cases), size)]
    futures = client.map(run, tasks, pure=False)
    progress(futures, notebook=False)
    print()
    done = iter(client.gather(futures, errors="skip"))  # waits once more for what a dying worker took along
    found = []
    for task, future in zip(tasks, futures, strict=True):
        if future.status != "error":
            found += next(done)
        elif size > 1:
            found += rows(client, task, 1)
        else:
            found.append(task[0] | {"reason": str(future.exception())})
    return found


def serial(fmu: Path, cases: list[Row]) -> list[Row]:
    """The same in a loop."""
    part = Part(fmu)
    part.setup()
    found = [part.run(case) for case in cases]
    part.teardown()
    return found


def table(fmu: Path, rows: list[Row]) -> pa.Table:
    """A column for each variable, with the unit that the FMU gives it."""
    unit = {v.name: v.unit or "1" for v in read_model_description(str(fmu)).modelVariables}
    integer = {v.name for v in read_model_description(str(fmu)).modelVariables if v.type == "Integer"}
    columns = [(name, pa.int32() if name in integer else pa.float64(), unit[name]) for name in GRID]
    columns += [("peak", pa.float64(), unit[OUTPUT]), ("time", pa.list_(pa.float64()), "s")]
    columns += [(OUTPUT, pa.list_(pa.float64()), unit[OUTPUT]), ("reason", pa.string(), "")]
    return pa.Table.from_pylist(
        rows, pa.schema([pa.field(name, kind, metadata={"unit": u}) for name, kind, u in columns])
    )


def write(rows: pa.Table, path: Path) -> None:
    """Whole or not at all."""
    beside = path.with_name(f"{path.name}.part")
    pq.write_table(rows, beside)
    os.replace(beside, path)


def connected(scheduler: str | None) -> Client:
    """The line that changes for other machines: the address of their scheduler, as "tcp://node1:8786"."""
    return Client(scheduler) if scheduler else Client(threads_per_worker=1, dashboard_address=":0")


def main() -> None:
    """Sweep, write, tell how fast it was and what failed."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("fmu", type=Path)
    parser.add_argument("--scheduler", metavar="ADDRESS", help="such as tcp://node1:8786")
    parser.add_argument("--compare", action="store_true", help="with a loop in this process")
    parser.add_argument("--every", type=int, default=1, metavar="N", help="a first look: each N-th run only")
    parser.add_argument("-o", "--output", type=Path, default=Path("sweep.parquet"))
    given = parser.parse_args()
    todo = cases()[:: given.every]
    with connected(given.scheduler) as client:
        client.wait_for_workers(1, timeout=60)
        workers = len(client.nthreads())
        begin = time.perf_counter()
        found = sweep(client, given.fmu, todo)
        taken = time.perf_counter() - begin
    failed = [row for row in found if row.get("reason")]
    write(table(given.fmu, found), given.output)
    print(f"{given.output}: {len(found)} runs, {len(failed)} of them failed", *failed[:3], sep="\n  ")
    print(f"{workers} workers: {taken:.1f} s, {len(found) / taken:.0f} runs/s")
    if given.compare:
        begin = time.perf_counter()
        same = serial(given.fmu, todo) == found
        loop = time.perf_counter() - begin
        print(f"a loop: {loop:.1f} s, {len(found) / loop:.0f} runs/s, {loop / taken:.2f} times as long")
        print(f"the same to the last bit: {'yes' if same else 'no'}")


if __name__ == "__main__":
    main()
