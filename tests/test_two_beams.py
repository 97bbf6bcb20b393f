"""The two beams of models/: packaged by the command, run by three masters, beside theory."""

import os
import subprocess
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest
from foreign_masters import SAME, difference, has_libraries, run
from ready_parts import MODELS, table

from precompute.arrays import Floats
from precompute.cli import main
from precompute.part import read_part
from precompute.pipeline import reduce_part

SPRING = 1000.0  # N/m, of system.toml
STEP = 2e-4


@pytest.fixture(scope="module")
def system(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("two_beams") / "two_beams.ssp"
    assert main(["ssp", str(MODELS / "two_beams"), "-o", str(path), "--no-certificate"]) == 0
    return path


def rises(x: Floats) -> float:
    """The frequency of a signal by the times at which it rises through its mean."""
    x = x - x.mean()
    k = np.flatnonzero((x[:-1] < 0) & (x[1:] >= 0))
    times = k - x[k] / (x[k + 1] - x[k])
    return float((len(times) - 1) / (times[-1] - times[0]) / STEP)


@has_libraries
def test_libcosim_and_ecos_run_real_parts(system: Path) -> None:
    """Both take the start value of the push; the beams beat as the eigenvalues of one matrix say."""
    found, steps = run("libcosim.py", system, 10_000), 1000
    first = {key: values[:steps] for key, values in found.items()}
    assert difference(first, run("jacobi.py", system, steps, STEP, "libcosim")) <= SAME
    left, right = found["left.tip.displacement.z"], found["right.tip.displacement.z"]
    model = reduce_part(read_part(MODELS / "two_beams" / "beam.toml")).model
    b = model.B[:, model.inputs.index("tip.force.z")]
    alone = model.frequency[0]
    held = np.sqrt(np.linalg.eigvalsh(np.diag(model.lam) + 2 * SPRING * np.outer(b, b))[0]) / (2 * np.pi)
    # the joint's damper, the delay of the force and the higher modes in the signal move them by 2e-4
    assert rises(left + right) == pytest.approx(alone, rel=5e-4)
    assert rises(left - right) == pytest.approx(held, rel=5e-4)
    assert held > 1.05 * alone
    assert (
        difference(run("ecos.py", system, steps, STEP), run("jacobi.py", system, steps, STEP, "ecos")) <= SAME
    )


def test_one_fmu_of_both(system: Path, tmp_path: Path) -> None:
    """A container of two instances of one part and their joint, by fmucontainer, run by FMPy."""
    text = (MODELS / "two_beams" / "system.toml").read_text(encoding="utf-8")
    with zipfile.ZipFile(system) as archive:
        archive.extractall(tmp_path)
    text = text.replace('part = "beam.toml"', f'fmu = "{tmp_path.as_posix()}/resources/left.fmu"')
    text += '[[input]]\nname = "push"\nto = ["left.push.force.z"]\n'
    names = {"z_left": "left.tip.displacement.z", "z_right": "right.tip.displacement.z"}
    text += "".join(f'[[output]]\nname = "{key}"\nfrom = "{name}"\n' for key, name in names.items())
    (tmp_path / "system.toml").write_text(text, encoding="utf-8")
    path = tmp_path / "two_beams.ssp"
    assert main(["ssp", str(tmp_path), "-o", str(path)]) == 0
    found, loop = (run(script, path, 1000, STEP, "container") for script in ("container.py", "jacobi.py"))
    assert {*found} == {*names}
    assert difference(found, {key: loop[name] for key, name in names.items()}) <= SAME


def test_demo_and_the_table(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, str(MODELS / "two_beams" / "demo.py"), str(tmp_path / "out")],
        capture_output=True,
        text=True,
        encoding="utf-8",
        cwd=tmp_path,
        timeout=120,
        env={**os.environ, "MPLBACKEND": "agg", "PYTHONIOENCODING": "utf-8"},
    )
    assert done.returncode == 0, done.stderr
    assert {path.name for path in (tmp_path / "out").iterdir()} == {"two_beams.ssp", "beats.png"}
    for row in table("two_beams", ""):
        assert row["FMUs"] in done.stdout, row
        assert row["theory"] in done.stdout, row
        assert abs(float(row["FMUs"]) / float(row["theory"]) - 1) < 3e-3
