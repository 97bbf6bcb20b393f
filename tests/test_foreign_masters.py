"""Masters that are not ours run native FMUs out of SSPs that we write, and agree with a plain loop of FMPy's.

Each runs in a process of its own (tests/foreign). The loop does what the master does in the same order, so
that rounding is all that may differ: 1e-12 of the largest value, some thousand roundings.
"""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from foreign_masters import SAME, difference, has_libraries, run
from foreign_systems import (
    CONNECTORS,
    DAMPER,
    DAMPING,
    LEFT,
    LINEAR,
    RIGHT,
    STIFFNESS,
    SYSTEM,
    write_pair,
)
from scipy.linalg import expm

from precompute.arrays import Floats
from precompute.cli import main

STEPS, STEP = 1000, 1e-3


def ssp(folder: Path, text: str) -> Path:
    """The SSP of a system file over two oscillators."""
    path = folder / "pair.ssp"
    assert main(["ssp", str(write_pair(folder, text)), "-o", str(path)]) == 0
    return path


@pytest.fixture(scope="module")
def free(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """No connectors of the system itself, which libcosim and ecos do not read; a linear transformation."""
    return ssp(tmp_path_factory.mktemp("free"), SYSTEM + LINEAR)


@pytest.fixture(scope="module")
def driven(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """With connectors of the system; no linear transformation and no start values, which FMPy leaves out."""
    text = "\n".join(line for line in SYSTEM.splitlines() if not line.startswith("start"))
    return ssp(tmp_path_factory.mktemp("driven"), text + CONNECTORS)


@has_libraries
def test_libcosim(free: Path) -> None:
    found, expected = run("libcosim.py", free, STEPS), run("jacobi.py", free, STEPS, STEP, "libcosim")
    assert {*found} == {*expected}
    assert difference(found, expected) <= SAME
    # the control: another order of getting and setting is seen
    assert difference(found, run("jacobi.py", free, STEPS, STEP, "ecos")) > 1e-3


@has_libraries
def test_ecos(free: Path) -> None:
    found, expected = run("ecos.py", free, STEPS, STEP), run("jacobi.py", free, STEPS, STEP, "ecos")
    assert {*found} == {*expected}
    assert difference(found, expected) <= SAME
    assert difference(found, run("jacobi.py", free, STEPS, STEP, "libcosim")) > 1e-3


@has_libraries
def test_ecos_runs_until_a_time(free: Path) -> None:
    """It steps while t + h < T: T = n h gives n - 1 steps, and half a step more those that are meant."""
    found = run("ecos.py", free, STEPS + 0.5, STEP, "until")["left.tip.displacement.x"]
    expected = run("jacobi.py", free, STEPS, STEP, "ecos")["left.tip.displacement.x"]
    assert len(found) == 1
    assert abs(found[0] - expected[-1]) <= SAME * abs(expected).max()


def test_fmpy(driven: Path) -> None:
    found, expected = run("fmpy_ssp.py", driven, STEPS, STEP), run("jacobi.py", driven, STEPS, STEP, "fmpy")
    assert {*found} == {*expected}
    assert difference(found, expected) <= SAME
    assert difference(found, run("jacobi.py", driven, STEPS, STEP, "container")) > 1e-3


def test_container_is_one_fmu(driven: Path) -> None:
    """Two parts and what joins them in one FMU, by fmucontainer, run by FMPy."""
    found, loop = run("container.py", driven, STEPS, STEP), run("jacobi.py", driven, STEPS, STEP, "container")
    expected = {
        "x_left": loop["left.tip.displacement.x"],
        "x_right": loop["right.tip.displacement.x"],
        "pull": loop["mount.a.force.x"],
    }
    assert {*found} == {*expected}
    assert difference(found, expected) <= SAME


def together(t: float) -> Floats:
    """x of left and right at t: M ẍ + D ẋ + K x = (2, 0) as one system from rest, by the exponential."""
    M = np.diag([LEFT[1], RIGHT[1]])
    coupling = np.array([[1.0, -1.0], [-1.0, 1.0]])
    K = np.diag([LEFT[0], RIGHT[0]]) + STIFFNESS * coupling
    D = np.diag([0.6 * LEFT[1], DAMPING]) + DAMPER * coupling  # start = { damping.alpha = 0.6 }
    A = np.zeros((5, 5))
    A[:2, 2:4] = np.eye(2)
    A[2:4, :2], A[2:4, 2:4] = -np.linalg.solve(M, K), -np.linalg.solve(M, D)
    A[2, 4] = 2.0 / LEFT[1]
    return np.asarray((expm(A * t) @ [0, 0, 0, 0, 1.0])[:2])


def test_parts_come_together_as_the_step_goes_to_zero(tmp_path: Path) -> None:
    """What all the masters compute is the system of both, with an error of first order: forces are held."""
    path, exact, errors = ssp(tmp_path, SYSTEM), together(0.5), []
    for steps in (500, 1000, 2000):
        found = run("jacobi.py", path, steps, 0.5 / steps, "libcosim")
        last = np.array([found[f"{part}.tip.displacement.x"][-1] for part in ("left", "right")])
        errors.append(abs(last - exact).max() / abs(exact).max())
    assert errors[-1] < 0.02
    for coarse, fine in pairwise(errors):
        assert 1.8 < coarse / fine < 2.3  # 2 as the step goes to 0


def test_a_damper_that_comes_late_drives_fast_motions(tmp_path: Path) -> None:
    """On average 3/2 steps: −c v(t − 3h/2) has the phase of v beyond ω · 3h/2 = π/2, f = 1/(6h).

    The left one swings at 20 rad/s, 1/(6h) = 3.2 Hz at h = 0.052 s.
    """
    path = ssp(tmp_path, SYSTEM.replace(f"stiffness = {{ x = {STIFFNESS} }}\n", ""))
    for step, grows in ((0.04, False), (0.065, True)):
        x = run("jacobi.py", path, 200, step, "libcosim")["left.tip.velocity.x"]
        assert (abs(x[-50:]).max() > 10 * abs(x[:50]).max()) == grows
