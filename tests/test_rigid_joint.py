"""Two bars end to end without a spring: refused where neither end is told how to move, right where one is."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from foreign_masters import SAME, has_libraries, run
from scipy.linalg import expm
from small_part import CELLS, DENSITY, LENGTH, WIDTH, YOUNG, write_part

from precompute.arrays import Floats
from precompute.cli import main

FORCE, TIME = 1000.0, 8e-4  # N at the joint from t = 0; s, one period of the left bar alone

CLAMP = 'at = { plane = { normal = "x", at = 0.0 } }\nfix = ["x", "y", "z"]\n'
GUIDES = (
    'at = { box = [[0.0, 0.0, 0.0], [1.0, 1.0, 1.0]] }\nfix = ["y", "z"]\n'  # all nodes: it moves in x only
)
TIP = 'inputs = ["force.x", "force.z"]\noutputs = ["displacement.x", "displacement.z", "velocity.z"]\n'
PULLED = 'inputs = ["force.x"]\noutputs = ["displacement.x", "acceleration.x"]\n'
DRIVEN = 'inputs = ["motion.x"]\noutputs = ["displacement.x", "acceleration.x", "reaction.x", "action.x"]\n'
UNDAMPED = ("[damping]\nratio = 0.02\n", "[damping]\nalpha = 0.0\n")


def end(name: str, at: float, variables: str) -> str:
    return f'[[port]]\nname = "{name}"\nat = {{ plane = {{ normal = "x", at = {at} }} }}\n{variables}'


def write_bars(folder: Path, tip: str = PULLED) -> None:
    """left: clamped, its tip with these variables; right: driven at its root. Both have all axial modes."""
    for name, support, port in (
        (
            "left",
            f'{CLAMP}name = "clamp"\noutputs = ["reaction.x"]\n\n[[support]]\n{GUIDES}',
            end("tip", LENGTH, tip) + end("push", LENGTH, 'inputs = ["force.x"]\n'),
        ),
        ("right", GUIDES, end("root", 0.0, DRIVEN) + end("tip", LENGTH, PULLED)),
    ):
        (folder / name).mkdir()
        write_part(
            folder / name,
            (CLAMP, support),
            (end("tip", LENGTH, TIP), port),
            ("count = 8", f"count = {CELLS}"),
            UNDAMPED,
        )


def package(folder: Path, *wires: tuple[str, str, float]) -> int:
    """The exit code of the command, for connections (from, to, factor)."""
    text = '[system]\nname = "bars"\n'
    text += f'[[component]]\nname = "left"\npart = "left"\nstart = {{ push.force.x = {FORCE} }}\n'
    text += '[[component]]\nname = "right"\npart = "right"\n'
    for source, target, factor in wires:
        text += f'[[connection]]\nfrom = "{source}"\nto = "{target}"\nfactor = {factor}\n'
    (folder / "system.toml").write_text(text, encoding="utf-8")
    return main(["ssp", str(folder), "-o", str(folder / "bars.ssp"), "--no-certificate"])


def one_bar(t: float) -> Floats:
    """u of the middle and the end of one bar of twice the length at t: linear elements, consistent mass."""
    n, a = 2 * CELLS + 1, LENGTH / CELLS
    K, M = np.zeros((n, n)), np.zeros((n, n))
    for k in range(n - 1):
        K[k : k + 2, k : k + 2] += YOUNG * WIDTH**2 / a * np.array([[1.0, -1.0], [-1.0, 1.0]])
        M[k : k + 2, k : k + 2] += DENSITY * WIDTH**2 * a / 6 * np.array([[2.0, 1.0], [1.0, 2.0]])
    free = slice(1, n)
    r = n - 1
    load = np.zeros(r)
    load[CELLS - 1] = FORCE
    A = np.zeros((2 * r + 1, 2 * r + 1))
    A[:r, r:-1] = np.eye(r)
    A[r:-1, :r] = -np.linalg.solve(M[free, free], K[free, free])
    A[r:-1, -1] = np.linalg.solve(M[free, free], load)
    state = expm(A * t)[:, -1]
    return np.asarray(state[[CELLS - 1, r - 1]])


def test_one_end_is_told_how_to_move(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """What the message of a refused joint says to do gives the bar of twice the length, to first order.

    The reduced bars have all their axial modes, so that the step is all that is left of the difference.
    """
    write_bars(tmp_path)
    joint = (
        ("left.tip.acceleration.x", "right.root.motion.x", 1.0),
        ("right.root.action.x", "left.tip.force.x", 1.0),
    )
    assert package(tmp_path, *joint) == 0
    assert "each depends on the one before at once" in capsys.readouterr().err
    errors, exact = [], one_bar(TIME)
    for steps in (500, 1000, 2000):
        found = run("jacobi.py", tmp_path / "bars.ssp", steps, TIME / steps, "libcosim")
        last = [found["left.tip.displacement.x"][-1], found["right.tip.displacement.x"][-1]]
        errors.append(abs(last - exact).max() / abs(exact).max())
    assert errors[-1] < 0.1
    for coarse, fine in pairwise(errors):
        assert 1.8 < coarse / fine < 2.2
    # the control: without the way back the left bar swings as if it were alone
    assert package(tmp_path, joint[0]) == 0
    alone = run("jacobi.py", tmp_path / "bars.ssp", 1000, TIME / 1000, "libcosim")
    assert abs(alone["left.tip.displacement.x"][-1] / exact[0] - 1) > 0.3


@has_libraries
def test_libcosim_and_ecos_run_the_joint(tmp_path: Path) -> None:
    """They go round the loop at their start as often as they do, 4 times and twice, and then once a step."""
    write_bars(tmp_path)
    joint = (
        ("left.tip.acceleration.x", "right.root.motion.x", 1.0),
        (
            "right.root.reaction.x",
            "left.tip.force.x",
            -0.3,
        ),  # a gain of 0.3, as of a lighter bar
    )
    assert package(tmp_path, *joint) == 0
    text = (tmp_path / "system.toml").read_text(encoding="utf-8")
    text = text.replace('part = "right"', 'part = "right"\nstart = { root.start_velocity.x = 1e-3 }')
    (tmp_path / "system.toml").write_text(f"{text}[experiment]\nstep = 1e-6\n", encoding="utf-8")
    path = tmp_path / "bars.ssp"
    assert main(["ssp", str(tmp_path), "-o", str(path), "--no-certificate"]) == 0
    for script, master, exchanges in (("libcosim.py", "libcosim", 4), ("ecos.py", "ecos", 2)):
        found = run(script, path, 300, 1e-6)
        expected, once_more = (
            run("jacobi.py", path, 300, 1e-6, master, k) for k in (exchanges, exchanges + 1)
        )
        assert {*found} == {*expected}
        for name, values in found.items():
            assert abs(values - expected[name]).max() <= SAME * abs(expected[name]).max(), name
        # the control: one more exchange is seen
        name = "right.root.reaction.x"
        assert abs(found[name] - once_more[name]).max() > 1e-3 * abs(found[name]).max()


def test_rigid_joints_that_are_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """By the dependencies that the FMUs of real parts tell."""
    for folder, tip in (("pulled", PULLED), ("driven", DRIVEN)):
        (tmp_path / folder).mkdir()
        write_bars(tmp_path / folder, tip)
    for folder, wires, expected in (
        (
            "pulled",
            [("left.tip.acceleration.x", "right.tip.force.x", 1.0)],
            "left.tip.acceleration.x is in m/s2, right.tip.force.x in N, expected a force or moment",
        ),
        (
            "pulled",
            [
                ("left.clamp.reaction.x", "right.tip.force.x", 1.0),
                ("right.root.reaction.x", "left.tip.force.x", 1.0),
            ],
            "a rigid loop without motion, ",
        ),
        (
            "driven",
            [
                ("left.tip.acceleration.x", "right.root.motion.x", 1.0),
                ("right.root.acceleration.x", "left.tip.motion.x", 1.0),
            ],
            "a rigid loop without force, ",
        ),
    ):
        capsys.readouterr()
        assert package(tmp_path / folder, *wires) == 2
        errors = [line for line in capsys.readouterr().err.splitlines() if line.startswith("error: ")]
        assert len(errors) == 1
        assert expected in errors[0]
