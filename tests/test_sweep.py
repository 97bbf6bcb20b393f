"""The parameter study of models/sweep on real clusters: whole, the same as a loop, and robust."""

import os
import re
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest
from distributed import Client, LocalCluster, Scheduler
from examples import oscillator
from ready_parts import MODELS, reduction, table

from fmu_src.native_fmu import build_native_fmu
from fmu_src.runtime.model import Port
from precompute.part import read_part

sys.path.insert(0, str(MODELS / "sweep"))
import sweep

OMEGA, ZETA = 100.0, 0.02  # of the first mode; C = B = 1
GOOD = sweep.cases()[::17]  # 59 runs of all values
BAD = [
    GOOD[3] | {"damping.alpha": -1.0},
    GOOD[5] | {"modes.active": 30},
    GOOD[7] | {"tip.force.z": float("nan")},
    GOOD[9] | {"tip.force.z": 1e308},
]
REASONS = [
    "a damping parameter of -1",
    "modes.active = 30",
    "tip.force.z is nan",
    "discarded the step from t = 0 s",
]


@pytest.fixture(scope="module")
def fmu(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Twenty modes between the variables of the cantilever's tip."""
    lam = (OMEGA * np.arange(1, 21.0)) ** 2
    model = oscillator(
        "tip_only",
        lam=lam,
        alpha=0.0,
        D_rest=np.diag(2 * ZETA * np.sqrt(lam)),
        B=np.ones((20, 1)),
        C=np.ones((1, 20)),
        ports=(Port("tip", ("force.z",), ("displacement.z",)),),
    )
    return build_native_fmu(model, tmp_path_factory.mktemp("fmu") / "tip_only.fmu")


@pytest.fixture(scope="module")
def expected(fmu: Path) -> list[sweep.Row]:
    return sweep.serial(fmu, GOOD)


@pytest.fixture(scope="module")
def client() -> Iterator[Client]:
    cluster = LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=":0", silence_logs=50)
    with cluster, Client(cluster) as found:
        yield found


def in_memory(dask_scheduler: Scheduler) -> int:
    """Results that are there."""
    return sum(task.state == "memory" for task in dask_scheduler.tasks.values())


def workers(client: Client) -> set[int]:
    """Their process numbers; one that is dying does not answer."""
    return set(client.run(os.getpid, on_error="ignore").values())


def kill_a_worker(client: Client, killed: list[int]) -> None:
    """Once some tasks are through."""
    victim = min(workers(client))
    while (done := client.run_on_scheduler(in_memory)) < 3:
        time.sleep(0.02)
    os.kill(victim, signal.SIGKILL)
    killed += [victim, done]


def sweep_with_a_kill(client: Client, fmu: Path, cases: list[sweep.Row], size: int) -> list[sweep.Row]:
    killed: list[int] = []
    killer = threading.Thread(target=kill_a_worker, args=(client, killed))
    killer.start()
    found = sweep.sweep(client, fmu, cases, size)
    killer.join(timeout=60)
    victim, done = killed
    assert done * size < len(cases)
    while victim in (there := workers(client)) or len(there) < 2:  # until the nanny has started another
        time.sleep(0.2)
    return found


def test_the_variables_are_those_of_the_cantilever() -> None:
    (tip,) = read_part(MODELS / "cantilever").ports
    assert sweep.OUTPUT.removeprefix(f"{tip.name}.") in tip.outputs
    inputs = {f"{tip.name}.{key}" for key in tip.inputs}
    assert set(sweep.GRID) <= inputs | {"damping.alpha", "modes.active"}
    assert len(sweep.cases()) == 1000


def test_readme_says_what_is_computed(tmp_path: Path) -> None:
    """Of the cantilever itself; printed with two decimals."""
    fmu = build_native_fmu(reduction("cantilever").model, tmp_path / "cantilever.fmu")
    rows = table("sweep", "damping.alpha")
    alphas = [
        alpha
        for alpha in sweep.GRID["damping.alpha"]
        if any(row["damping.alpha"] == f"{alpha:.2f}" for row in rows)
    ]
    for row, alpha in zip(rows, alphas, strict=True):
        cases = [{"damping.alpha": alpha, "modes.active": r, "tip.force.z": 10.0} for r in (1, 3, 5, 20)]
        found = [1e6 * run["peak"] / 10.0 for run in sweep.serial(fmu, cases)]
        printed = [float(row[key]) for key in row if key.endswith(("1 mode", " modes"))]
        np.testing.assert_allclose(printed, found, rtol=0, atol=0.0051)
        zeta = 0.02 + alpha / (4 * np.pi * reduction("cantilever").model.frequency[0])
        theory = 79.389 * (1 + np.exp(-np.pi * zeta / np.sqrt(1 - zeta**2)))
        assert float(row["theory"]) == pytest.approx(theory, abs=0.0051)
        assert float(row["20 modes, difference"].rstrip("%")) / 100 == pytest.approx(
            found[-1] / theory - 1, abs=5.1e-4
        )


def test_one_mode_overshoots_as_it_must(fmu: Path) -> None:
    """Peak: F/λ (1 + exp(−πζ/√(1 − ζ²))); missed by at most 1 − cos(ωh/2) of it between samples."""
    cases = [case for case in sweep.cases() if case["modes.active"] == 1][::9]
    for row in sweep.serial(fmu, cases):
        zeta = ZETA + row["damping.alpha"] / (2 * OMEGA)
        peak = row["tip.force.z"] / OMEGA**2 * (1 + np.exp(-np.pi * zeta / np.sqrt(1 - zeta**2)))
        assert 0 <= 1 - row["peak"] / peak <= 1 - np.cos(OMEGA * sweep.STEP / 2)


def test_a_sweep_with_bad_runs_and_a_killed_worker(
    client: Client, fmu: Path, expected: list[sweep.Row], tmp_path: Path
) -> None:
    """Equal to the loop bit for bit; what failed is told, in its place, and costs nothing else."""
    found = sweep_with_a_kill(client, fmu, [*GOOD[:30], *BAD, *GOOD[30:]], size=2)
    assert found[:30] + found[34:] == expected
    for row, case, words in zip(found[30:34], BAD, REASONS, strict=True):
        assert words in row["reason"]
        assert row.keys() == {*case, "reason"}
    path = tmp_path / "sweep.parquet"
    sweep.write(sweep.table(fmu, found), path)
    written = pq.read_table(path)
    units = {field.name: field.metadata[b"unit"].decode() for field in written.schema}
    assert units == {
        "damping.alpha": "1/s",
        "modes.active": "1",
        "tip.force.z": "N",
        "peak": "m",
        "time": "s",
        "tip.displacement.z": "m",
        "reason": "",
    }
    whole = [{key: value for key, value in row.items() if value is not None} for row in written.to_pylist()]
    assert whole[:30] + whole[34:] == expected
    assert [row["reason"] for row in whole[30:34]] == [row["reason"] for row in found[30:34]]
    assert [*tmp_path.iterdir()] == [path]


def test_runs_that_kill_their_workers_are_told(client: Client, fmu: Path, expected: list[sweep.Row]) -> None:
    """After as many deaths as the scheduler allows, here none; runs of one task have a chance each."""
    client.run_on_scheduler(lambda dask_scheduler: setattr(dask_scheduler, "allowed_failures", 0))
    assert sweep_with_a_kill(client, fmu, GOOD[:36], size=3) == expected[:36]
    found = sweep_with_a_kill(client, fmu, GOOD[:36], size=1)
    lost = [row for row in found if "reason" in row]
    assert 1 <= len(lost) <= 4  # what the worker had at the time
    assert all("workers died while running it" in row["reason"] for row in lost)
    assert [row for row in found if "reason" not in row] == [
        row for row, got in zip(expected[:36], found, strict=True) if "reason" not in got
    ]


@contextmanager
def running(folder: Path, *command: object) -> Iterator[subprocess.Popen[bytes]]:
    """A process of Dask that is ended with the block."""
    words = [sys.executable, "-I", "-m", "dask", *map(str, command)]
    with subprocess.Popen(words, cwd=folder, stderr=subprocess.DEVNULL) as process:
        try:
            yield process
        finally:
            process.kill()


def address_in(told: Path, scheduler: subprocess.Popen[bytes]) -> str:
    """What the scheduler writes once it is there."""
    while not (found := told.exists() and re.search(r'"(tcp://[^"]+)"', told.read_text())):
        assert scheduler.poll() is None
        time.sleep(0.02)
    return found[1]


def test_a_scheduler_of_other_machines(fmu: Path, tmp_path: Path) -> None:
    """The program as users run it; the worker has neither it nor the FMU, and no folder in common."""
    elsewhere, told, output = tmp_path / "elsewhere", tmp_path / "scheduler.json", tmp_path / "found.parquet"
    elsewhere.mkdir()
    with (
        running(
            elsewhere, "scheduler", "--port", "0", "--no-dashboard", "--scheduler-file", told
        ) as scheduler,
        running(elsewhere, "worker", "--scheduler-file", told, "--no-nanny", "--nthreads", "2"),
    ):
        options = ("--scheduler", address_in(told, scheduler), "--every", "50", "-o", output)
        done = subprocess.run(
            [sys.executable, "-I", MODELS / "sweep" / "sweep.py", fmu.name, *options],
            cwd=fmu.parent,
            capture_output=True,
            text=True,
        )
    assert done.returncode == 0, done.stderr
    assert "20 runs, 0 of them failed" in done.stdout
    assert pq.read_table(output).drop_columns("reason").to_pylist() == sweep.serial(fmu, sweep.cases()[::50])
