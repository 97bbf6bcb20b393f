"""`modalfmu simulate`: every run in a process of its own, as Python FMUs share one interpreter."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from xml.etree import ElementTree as ET

import meshio
import numpy as np
import pytest
from fmpy.util import read_csv
from pythonfmu import FmuBuilder
from small_part import CELLS, LENGTH, WIDTH, YOUNG, bar, write_part

from precompute.cli import main
from precompute.deformed_series import drawn_instants
from precompute.errors import ModalFmuError
from precompute.fmu_face import read_face, read_settings
from precompute.plot import figure, panels
from precompute.signals import read_signals
from precompute.simulation import Simulation

FORCE = 1000.0  # N
OTHER = '''
from pythonfmu import Fmi2Causality, Fmi2Slave, Real
from pythonfmu.enums import Fmi2Status


class Stubborn(Fmi2Slave):
    """y = t + u until 0.05 s, then no more."""

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.u, self.y = 0.0, 0.0
        self.register_variable(Real("u", causality=Fmi2Causality.input))
        self.register_variable(Real("y", causality=Fmi2Causality.output))

    def do_step(self, time, step):
        if time > 0.05:
            self.log("the spring broke", Fmi2Status.error)
            return False
        self.y = time + step + self.u
        return True
'''


@pytest.fixture(scope="module")
def fmu(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """All modes of the bar, from equilibrium with the start values of its inputs."""
    folder = tmp_path_factory.mktemp("bar")
    part = write_part(folder, ("count = 8", f'count = {12 * CELLS}\ninitial = "static"'))
    assert main(["build", str(part), "-o", str(folder)]) == 0
    return folder / "bar.fmu"


@pytest.fixture(scope="module")
def stubborn(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An FMU that is not ours and gives up."""
    folder = tmp_path_factory.mktemp("other")
    script = folder / "stubborn.py"
    script.write_text(OTHER)
    made: Path = FmuBuilder.build_FMU(script, dest=folder)
    return made


def simulate(*arguments: object, cwd: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "precompute.cli", "simulate", *map(str, arguments)],
        capture_output=True,
        text=True,
        encoding="utf-8",
        cwd=cwd,
        timeout=120,
    )


def ran(*arguments: object, cwd: Path) -> str:
    done = simulate(*arguments, cwd=cwd)
    assert done.returncode == 0, done.stderr
    return done.stdout


def frames(series: Path) -> list[tuple[float, meshio.Mesh]]:
    """What ParaView would play."""
    listed = ET.parse(series).getroot().iter("DataSet")
    return [(float(f.attrib["timestep"]), meshio.read(series.parent / f.attrib["file"])) for f in listed]


def test_static_equilibrium_is_the_closed_form(fmu: Path, tmp_path: Path) -> None:
    """Under F at its end the bar stretches by u(x) = F x/(E A), exact in linear cells, and stays so."""
    shown = ran(
        fmu, "--set", f"tip.force.x={FORCE}", "tip.force.z=0", "--stop-time", 0.01, "--step", 1e-3,
        "--output", "out.csv", "--vtu", "bar.pvd", "--scale", 1000, cwd=tmp_path,
    )  # fmt: skip
    stretch = FORCE / (YOUNG * WIDTH**2)
    result = read_csv(tmp_path / "out.csv")
    # rounding times the condition number of K, 1e4
    np.testing.assert_allclose(result["tip.displacement.x"], stretch * LENGTH, rtol=1e-9)
    np.testing.assert_allclose(result["time"], np.arange(11) * 1e-3, atol=1e-15)
    assert "10 steps to 0.01 s" in shown
    row = next(line.split() for line in shown.splitlines() if "tip.displacement.x" in line)
    assert row == ["tip.displacement.x", "m", *[f"{stretch * LENGTH:.6g}"] * 3]
    played = frames(tmp_path / "bar.pvd")
    assert [t for t, _ in played] == result["time"].tolist()
    points = bar()[0]
    for _, frame in played:
        nearest = np.linalg.norm(frame.points[:, None] - points, axis=2).argmin(axis=1)
        p = points[nearest]
        u = np.outer(p[:, 0] * stretch, [1.0, 0.0, 0.0])
        # single precision, of the displacement and of the position
        np.testing.assert_allclose(frame.point_data["displacement"], u, atol=1e-6 * stretch)
        np.testing.assert_allclose(frame.points, p + 1000 * u, atol=1e-6)
        assert frame.cells_dict["quad"].shape == (4 * CELLS + 2, 4)
    assert np.abs(frame.points - p).max() > 1e-4  # the scale was not lost


def test_series_moves_as_the_outputs_do(fmu: Path, tmp_path: Path) -> None:
    """A bending blow: the mean of Uq over the tip's four nodes is the output tip.displacement.z."""
    (tmp_path / "blow.csv").write_text("time,tip.force.z\n0,0\n0.001,1000\n0.002,0\n")
    ran(
        fmu, "--input", "blow.csv", "--output", "out.csv", "--vtu", "blow.vtu",
        "--stop-time", 0.02, "--step", 5e-5, cwd=tmp_path,
    )  # fmt: skip
    result = read_csv(tmp_path / "out.csv")
    played = frames(tmp_path / "blow.pvd")
    assert len(played) == 200
    assert played[0][0] == 0.0
    assert played[-1][0] == result["time"][-1]
    at = np.searchsorted(result["time"], [t for t, _ in played])
    tip = np.isclose(played[0][1].points[:, 0], LENGTH)
    assert tip.sum() == 4
    drawn = np.array([frame.point_data["displacement"][tip, 2].mean() for _, frame in played])
    largest = np.abs(result["tip.displacement.z"]).max()
    assert largest > 1e-5
    # single precision of shape and file
    np.testing.assert_allclose(drawn, result["tip.displacement.z"][at], atol=2e-6 * largest)


def test_csv_goes_round(fmu: Path, tmp_path: Path) -> None:
    """The same force by --set and by a CSV of one row, of two, and in columns of another order."""
    common = ("--stop-time", 0.005, "--step", 1e-4)
    ran(fmu, "--set", "tip.force.z=7", "--output", "a.csv", *common, cwd=tmp_path)
    texts = {
        "one row": "time,tip.force.z\n0,7\n",
        "two rows": "\ufefftime, tip.force.z, tip.force.x\r\n0, 7, 0\r\n\r\n1, 7, 0\r\n",
        "quoted": '"time","tip.force.x","tip.force.z"\n0,0,7\n0.001,0,7\n',
    }
    first = read_csv(tmp_path / "a.csv")
    assert first.dtype.names == ("time", "tip.displacement.x", "tip.displacement.z", "tip.velocity.z")
    for name, text in texts.items():
        (tmp_path / "in.csv").write_text(text, encoding="utf-8", newline="")
        ran(fmu, "--input", "in.csv", "--output", "b.csv", *common, cwd=tmp_path)
        again = read_csv(tmp_path / "b.csv")
        assert again["time"].tolist() == first["time"].tolist()
        # FMPy's interpolation of 7 between 7 and 7 is 7 to rounding
        z, once_more = first["tip.displacement.z"], again["tip.displacement.z"]
        assert z[0] > 0
        np.testing.assert_allclose(once_more, z, rtol=1e-12, err_msg=name)


def test_parameters_change_over_time(fmu: Path, tmp_path: Path) -> None:
    """With no mode left from 2 ms on, nothing moves any more."""
    (tmp_path / "in.csv").write_text("time,modes.active\n0,72\n0.002,0\n")
    ran(
        fmu, "--set", "tip.force.x=5", "--input", "in.csv", "--output", "out.csv",
        "--stop-time", 0.004, "--step", 1e-3, cwd=tmp_path,
    )  # fmt: skip
    moved = read_csv(tmp_path / "out.csv")["tip.displacement.x"]
    assert (moved[:3] > 0).all()
    assert moved[3:].tolist() == [0.0, 0.0]


def test_plot_has_axes_and_units(fmu: Path, tmp_path: Path) -> None:
    ran(fmu, "--set", "tip.force.z=1", "--stop-time", 0.001, "--plot", "tip.png", cwd=tmp_path)
    png = (tmp_path / "tip.png").read_bytes()
    assert png[:8] == b"\x89PNG\r\n\x1a\n"
    assert len(png) > 20_000  # an empty figure of this size has 5 kB
    face = read_face(fmu)
    names = ["time", *face.inputs, *face.outputs]
    result = np.zeros(3, dtype=[(name, float) for name in names])
    result["time"], result["tip.force.z"] = [0, 1, 2], 1.0
    simulation = Simulation(face, result, np.zeros((3, 0)))
    assert [panel.label for panel in panels(simulation)] == [
        "force / N",
        "displacement / m",
        "velocity / m/s",
    ]
    drawn = figure(simulation)
    assert [axes.get_ylabel() for axes in drawn.axes] == [p.label for p in panels(simulation)]
    assert drawn.axes[-1].get_xlabel() == "time / s"
    assert drawn.get_suptitle() == "bar: a steel bar"
    legends = [[text.get_text() for text in axes.get_legend().get_texts()] for axes in drawn.axes]
    assert legends == [["tip.force.z"], ["tip.displacement.x", "tip.displacement.z"], ["tip.velocity.z"]]


def test_default_experiment(fmu: Path, tmp_path: Path) -> None:
    """The FMU's own stop time; its own step would be finer than a first look needs, and a note says so."""
    done = simulate(fmu, cwd=tmp_path)
    face = read_face(fmu)
    assert done.returncode == 0, done.stderr
    assert f"to {face.stop:g} s" in done.stdout
    assert "note: no input was given, all keep their start values; add --set tip.force.x=1" in done.stderr
    assert "\x1b" not in done.stdout + done.stderr
    steps = round(face.stop / face.step)
    if steps > 20_000:
        assert "note: " in done.stderr
    else:
        assert f"{steps} steps" in done.stdout


def test_another_fmu_and_its_own_words(stubborn: Path, tmp_path: Path) -> None:
    shown = ran(stubborn, "--set", "u=1", "--stop-time", 0.04, "--step", 0.01, cwd=tmp_path)
    assert "1.04" in shown
    done = simulate(stubborn, "--stop-time", 0.1, "--step", 0.01, "--output", "out.csv", cwd=tmp_path)
    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr == "error: Stubborn.fmu: stopped at 0.06 s: the spring broke\n"
    assert list(tmp_path.iterdir()) == []
    done = simulate(stubborn, "--vtu", "x.pvd", cwd=tmp_path)
    assert done.returncode == 2
    assert "mode shapes" in done.stderr


@pytest.mark.skipif(sys.platform == "win32", reason="Ctrl-C of a child process is another thing there")
def test_ctrl_c_during_the_run(fmu: Path, tmp_path: Path) -> None:
    """Ctrl-C ends the run between two steps; the FMU, which is Python too, does not take it for its fault."""
    arguments = [str(fmu), "--stop-time", "1", "--step", "1e-6", "--set", "tip.force.z=1"]
    with subprocess.Popen(
        [sys.executable, "-m", "precompute.cli", "simulate", *arguments],
        stderr=subprocess.PIPE,
        text=True,
        cwd=tmp_path,
        env={**os.environ, "TMPDIR": str(tmp_path)},
    ) as process:
        deadline = time.monotonic() + 60
        while not any(tmp_path.glob("*/binaries")) and time.monotonic() < deadline:  # the FMU is unpacked
            time.sleep(0.05)
        time.sleep(0.5)
        process.send_signal(signal.SIGINT)
        said = process.communicate(timeout=60)[1]
    assert process.returncode == 130
    assert said.splitlines()[-1] == "error: interrupted"
    assert "Traceback" not in said
    assert not any(tmp_path.glob("*/binaries"))


@pytest.mark.parametrize(
    ("text", "named"),
    [
        ("time,tip.forc.z\n0,1\n", "'tip.force.z'"),
        ("time,tip.displacement.z\n0,1\n", "no input"),
        ("t,tip.force.z\n0,1\n", "'time'"),
        ("tip.force.z\n1\n", "'time'"),
        ("time;tip.force.z\n0;1\n", "commas"),
        ("time,tip.force.z,tip.force.z\n0,1,1\n", "twice"),
        ("time,tip.force.z\n0,1\n1,two\n", "line 3"),
        ("time,tip.force.z\n0,nan\n", "line 2"),
        ("time,tip.force.z\n0,1\n\n1\n", "line 4"),
        ("time,tip.force.z\n0,1\n2,1\n1,1\n", "line 4"),
        ("time,tip.force.z\n", "row"),
        ("", "empty"),
    ],
)
def test_bad_signals(fmu: Path, tmp_path: Path, text: str, named: str) -> None:
    file = tmp_path / "in.csv"
    file.write_text(text)
    with pytest.raises(ModalFmuError, match=r"^in\.csv: [^\n]+$") as caught:
        read_signals(file, read_face(fmu))
    assert named in str(caught.value)


@pytest.mark.parametrize(
    ("setting", "named"),
    [
        ("tip.forc.z=1", "'tip.force.z'"),
        ("tip.force.z", "name=value"),
        ("tip.force.z=much", "number"),
        ("tip.force.z=inf", "finite"),
        ("tip.displacement.z=1", "calculated"),
        ("modes.frequency[1]=1", "calculated"),
        ("modes.active=1.5", "whole"),
        ("modes.active=73", "at most 72"),
        ("damping.alpha=-1", "at least 0"),
    ],
)
def test_bad_settings(fmu: Path, setting: str, named: str) -> None:
    with pytest.raises(ModalFmuError, match=r"^--set: [^\n]+$") as caught:
        read_settings([setting], read_face(fmu))
    assert named in str(caught.value)


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        (("--step", "0"), "--step"),
        (("--step", "nan"), "--step"),
        (("--step", "1e-12"), "steps"),
        (("--stop-time", "0"), "--stop-time"),
        (("--stop-time", "inf"), "--stop-time"),
        (("--scale", "nan", "--vtu", "x.pvd"), "--scale"),
        (("--plot", "x.csv"), ".png"),
        (("--output", "nowhere/x.csv"), "nowhere"),
        (("--input", "nowhere.csv"), "nowhere.csv"),
    ],
)
def test_bad_arguments(
    fmu: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    arguments: tuple[str, ...],
    named: str,
) -> None:
    """All found before the FMU is loaded."""
    monkeypatch.chdir(tmp_path)
    assert main(["simulate", str(fmu), *arguments]) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.startswith("error: ")
    assert said.err.count("\n") == 1
    assert named in said.err
    assert list(tmp_path.iterdir()) == []


def test_not_an_fmu(fmu: Path, tmp_path: Path) -> None:
    half = tmp_path / "half.fmu"
    half.write_bytes(fmu.read_bytes()[: fmu.stat().st_size // 2])
    for path, named in (
        (half, "whole"),
        (tmp_path / "none.fmu", "No such file"),
        (tmp_path, "cannot be read"),
    ):
        with pytest.raises(ModalFmuError, match=named):
            read_face(path)


def test_drawn_instants_keep_both_ends() -> None:
    assert drawn_instants(5, 200).tolist() == [0, 1, 2, 3, 4]
    assert drawn_instants(1, 200).tolist() == [0]
    many = drawn_instants(12345, 200)
    assert (many[0], many[-1], len(many)) == (0, 12344, 200)
    assert np.ptp(np.diff(many)) <= 1
