"""The command as a user meets it: exit codes, what goes to stdout and what to stderr."""

import json
import os
import subprocess
import sys
import tomllib
import zipfile
from collections.abc import Callable
from pathlib import Path

import meshio
import numpy as np
import pytest
from small_part import CELLS, DENSITY, LENGTH, WIDTH, YOUNG, bar, beside, write_mesh, write_part

from fmu_src import native_library
from fmu_src.toolchain import host_platform
from precompute.cli import main
from precompute.console import notices
from precompute.notice import notice, warning

STEEL = f'name = "steel"\nyoung = {YOUNG}\npoisson = 0.0\ndensity = {DENSITY}\n'


def command(*arguments: object, cwd: Path, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "precompute.cli", *map(str, arguments)],
        capture_output=True,
        text=True,
        cwd=cwd,
        timeout=120,
        env={**os.environ, **environment},
        encoding="utf-8",
    )


def refused(capsys: pytest.CaptureFixture[str], *arguments: object) -> str:
    """Run a command that must be refused; gives its one line."""
    capsys.readouterr()
    assert main([*map(str, arguments)]) == 2
    said = capsys.readouterr()
    assert said.out == ""
    errors = [line for line in said.err.splitlines() if not line.startswith(("note: ", "warning: "))]
    assert len(errors) == 1, said.err
    assert errors[0].startswith("error: ")
    return errors[0]


FREE = ('[[support]]\nat = { plane = { normal = "x", at = 0.0 } }\nfix = ["x", "y", "z"]\n', "")


# --- what must work


def test_json_is_one_object_and_right(tmp_path: Path) -> None:
    """Axial modes of linear cells with consistent mass are known in closed form:
    ω² = (6 c²/a²)(1 − cos ka)/(2 + cos ka), k = π/2L (Hughes, The Finite Element Method, 9.1)."""
    done = command("modes", write_part(tmp_path), "--json", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    assert set(found) == {
        *("frequencies", "damping_ratios", "rigid_body_modes", "effective_mass"),
        *("total_mass", "dominance", "dofs", "solver"),
    }
    a, ka = LENGTH / CELLS, np.pi / (2 * CELLS)
    omega = np.sqrt(6 * YOUNG / DENSITY * (1 - np.cos(ka)) / (2 + np.cos(ka))) / a
    axial = int(np.argmax(found["effective_mass"]["x"]))
    # rounding of K, 1e-16, times its condition number, 1e4, with room to spare
    assert found["frequencies"][axial] == pytest.approx(omega / (2 * np.pi), rel=1e-9)
    assert found["frequencies"][axial] != pytest.approx(np.sqrt(YOUNG / DENSITY) / (4 * LENGTH), rel=1e-4)
    assert found["total_mass"] == pytest.approx(DENSITY * LENGTH * WIDTH**2, rel=1e-12)
    assert found["dofs"] == 3 * 4 * CELLS
    assert found["rigid_body_modes"] == 0
    assert found["damping_ratios"] == pytest.approx([0.02] * 8, rel=1e-12)
    assert all(line.startswith("note: ") for line in done.stderr.splitlines())


def test_rigid_modes_have_no_ratio_and_move_all_the_mass(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    part = write_part(tmp_path, FREE)
    assert main(["modes", str(part), "--json"]) == 0
    said = capsys.readouterr()
    found = json.loads(said.out)
    assert found["rigid_body_modes"] == 6
    assert found["frequencies"][:6] == [0.0] * 6
    assert found["damping_ratios"][:6] == [None] * 6
    assert found["damping_ratios"][6] == pytest.approx(0.02)
    for axis in "xyz":
        assert sum(found["effective_mass"][axis][:6]) == pytest.approx(found["total_mass"], rel=1e-9)
    assert "rigid modes" in said.err
    assert main(["modes", str(part)]) == 0
    rows = capsys.readouterr().out.splitlines()
    assert sum("rigid" in row for row in rows) == 6
    assert "100.0" in next(row for row in rows if row.split()[:1] == ["sum"])


def test_build_shows_the_modes_and_writes_the_fmu(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    write_part(tmp_path)
    (tmp_path / "out").mkdir()
    monkeypatch.chdir(tmp_path)
    assert main(["build", "."]) == 0
    shown = capsys.readouterr().out
    assert "bar.fmu: " in shown
    assert f"native runtime ({host_platform()}" in shown
    assert f"{12 * CELLS} degrees of freedom → 8 modes" in shown
    assert "\x1b" not in shown  # no colours in a pipe
    assert main(["build", "part.toml", "-o", "out"]) == 0
    assert main(["build", "part.toml", "-o", "out/other.fmu", "--runtime", "python"]) == 0
    assert "python runtime (linux64, win64)" in capsys.readouterr().out
    first = (tmp_path / "bar.fmu").read_bytes()
    assert (tmp_path / "out" / "bar.fmu").read_bytes() == first
    with zipfile.ZipFile("bar.fmu") as native, zipfile.ZipFile("out/other.fmu") as python:
        assert "sources/modalfmu.c" in native.namelist()
        assert "documentation/index.html" in native.namelist()
        assert "resources/slavemodule.txt" in python.namelist()
    assert sorted(p.name for p in (tmp_path / "out").iterdir()) == ["bar.fmu", "other.fmu"]


def test_build_for_chosen_platforms(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(native_library, "cache_folder", lambda: tmp_path / "cache")
    fmu = tmp_path / "bar.fmu"
    part = write_part(tmp_path)
    assert main(["build", str(part), "-o", str(fmu), "--platform", "aarch64-linux,linux64"]) == 0
    assert "native runtime (linux64, aarch64-linux)" in capsys.readouterr().out
    with zipfile.ZipFile(fmu) as archive:
        binaries = [name for name in archive.namelist() if name.startswith("binaries/")]
    assert binaries == ["binaries/aarch64-linux/bar.so", "binaries/linux64/bar.so"]


def test_mode_shapes_for_paraview(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "shapes.vtu"
    assert main(["modes", str(write_part(tmp_path)), "--json", "--vtu", str(file)]) == 0
    found = json.loads(capsys.readouterr().out)
    mesh = meshio.read(file)
    points, cells = bar()
    np.testing.assert_array_equal(mesh.cells_dict["hexahedron"], cells)
    assert list(mesh.point_data) == [
        f"mode {i:02d} {f:.2f} Hz" for i, f in enumerate(found["frequencies"], start=1)
    ]
    diagonal = np.linalg.norm(np.ptp(points, axis=0))
    for shape in mesh.point_data.values():
        # single precision
        assert np.linalg.norm(shape, axis=1).max() == pytest.approx(0.05 * diagonal, rel=1e-6)
        assert np.abs(shape[points[:, 0] == 0.0]).max() == 0.0
    axial = [*mesh.point_data.values()][int(np.argmax(found["effective_mass"]["x"]))]
    # the lowest axial mode is sin(πx/2L) at the nodes, for linear cells too
    np.testing.assert_allclose(
        np.abs(axial[:, 0]), 0.05 * diagonal * np.sin(np.pi * points[:, 0] / 2 / LENGTH), atol=1e-6 * diagonal
    )


def test_inspect_gives_a_part_file_that_builds(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    points, cells = bar()
    write_mesh(tmp_path, 1000 * points, cells, np.array([1, 1, 2, 2, 2, 2]))
    monkeypatch.chdir(tmp_path)
    assert main(["inspect", "bar.vtu", "--length-unit", "mm"]) == 0
    shown = capsys.readouterr().out
    for expected in ("28 nodes", "6 hex8", "[1000, 100, 100] mm", "420000 mm²", "group 1", "group 2"):
        assert expected in shown, shown
    text = shown[shown.index("[part]") :]
    assert tomllib.loads(text)["part"]["length_unit"] == "mm"
    Path("part.toml").write_text(text, encoding="utf-8")
    assert main(["modes", ".", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["dofs"] == 3 * 4 * CELLS


def test_inspect_hints_at_sets_by_their_names(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    points, cells = bar()
    lines = ["*NODE", *(f"{i}, {x}, {y}, {z}" for i, (x, y, z) in enumerate(points.tolist(), start=1))]
    lines += ["*ELEMENT, TYPE=C3D8, ELSET=BODY"]
    lines += [", ".join(map(str, (i, *(c + 1)))) for i, c in enumerate(cells, start=1)]
    for name, x in (("LOAD", LENGTH), ("CLAMP", 0.0)):
        rows = np.flatnonzero(points[:, 0] == x) + 1
        lines += [f"*NSET, NSET={name}", ", ".join(map(str, rows))]
    deck = tmp_path / "bar.inp"
    deck.write_text("\n".join(lines) + "\n")
    assert main(["inspect", str(deck)]) == 0
    shown = capsys.readouterr().out
    hint = tomllib.loads(shown[shown.index("[part]") :])
    assert hint["support"][0]["at"] == "CLAMP"
    assert hint["port"][0]["at"] == "LOAD"
    assert "BODY" in shown


def test_help_and_version(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--version"]) == 0
    assert capsys.readouterr().out.startswith("modalfmu ")
    for name in ("build", "modes", "inspect", "simulate"):
        assert main([name, "--help"]) == 0
        assert f"modalfmu {name} " in capsys.readouterr().out.split("Usage:")[1].split("\n", 1)[1]


def test_a_closed_pipe_is_no_fault(tmp_path: Path) -> None:
    part = write_part(tmp_path)
    reading, writing = os.pipe()
    os.close(reading)
    done = subprocess.run(
        [sys.executable, "-m", "precompute.cli", "modes", str(part)],
        stdout=writing,
        stderr=subprocess.PIPE,
        text=True,
        timeout=120,
    )
    os.close(writing)
    assert done.returncode == 0
    assert "Traceback" not in done.stderr
    assert "BrokenPipe" not in done.stderr


def test_ascii_terminals(tmp_path: Path) -> None:
    done = command("modes", write_part(tmp_path), cwd=tmp_path, PYTHONIOENCODING="ascii")
    assert done.returncode == 0, done.stderr
    assert "damping ratio" in done.stdout


def test_a_fault_of_ours_keeps_its_traceback(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*_: object, **__: object) -> None:
        raise ZeroDivisionError

    monkeypatch.setattr("precompute.reduced_basis.solve_modes", broken)
    with pytest.raises(ZeroDivisionError):
        main(["modes", str(write_part(tmp_path))])


def test_ctrl_c_is_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def pressed(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("precompute.reduced_basis.solve_modes", pressed)
    assert main(["modes", str(write_part(tmp_path))]) == 130
    assert capsys.readouterr().err.splitlines()[-1] == "error: interrupted"


# --- mistakes in the part file

MISTAKES = {
    "missing key": (("young = 210000000000.0\n", ""), "young"),
    "missing table": (("[modes]\ncount = 8\n", ""), "modes"),
    "unknown key": (("poisson", "poison"), "poisson"),
    "unknown table": (("[damping]", "[dampings]"), "damping"),
    "negative density": (("density = 7850.0", "density = -7850.0"), "density"),
    "no density": (("density = 7850.0", "density = 0.0"), "density"),
    "incompressible": (("poisson = 0.0", "poisson = 0.5"), "poisson"),
    "NaN": (("poisson = 0.0", "poisson = nan"), "poisson"),
    "infinite": (("young = 210000000000.0", "young = inf"), "young"),
    "text for a number": (("ratio = 0.02", 'ratio = "2 %"'), "ratio"),
    "unknown unit": (('length_unit = "m"', 'length_unit = "yd"'), "length_unit"),
    "no identifier": (('name = "bar"', 'name = "my bar"'), "name"),
    "no such mesh": (('mesh = "bar.vtu"', 'mesh = "bars.vtu"'), "bars.vtu"),
    "mesh of another kind": (('mesh = "bar.vtu"', 'mesh = "part.toml"'), "part.toml"),
    "empty selection": (("at = 0.0 }", "at = 0.05 }"), "support[1].at"),
    "no such set": (('at = { plane = { normal = "x", at = 0.0 } }', 'at = "clamp"'), "clamp"),
    "port on no node": (("at = 1.0 }", "at = 2.0 }"), "port[1].at"),
    "port on an unknown node": (
        ('at = { plane = { normal = "x", at = 1.0 } }', "at = { nodes = [999] }"),
        "999",
    ),
    "no such cell set": (('name = "steel"\n', 'name = "steel"\ncells = "body"\n'), "body"),
    "material without cells left": (
        ("[[support]]", f"[[material]]\n{STEEL.replace('steel', 'iron')}\n[[support]]"),
        "material",
    ),
    "too many modes": (("count = 8", "count = 73"), "72"),
    "no mode in the range": (("count = 8", "max_frequency = 1.0"), "Hz"),
    "unknown start": (("count = 8", 'count = 8\ninitial = "statics"'), "initial"),
    "two forms of damping": (("ratio = 0.02", "ratio = 0.02\nalpha = 1.0"), "damping"),
    "damaged TOML": (("[modes]", "[modes"), "part.toml"),
}


@pytest.mark.parametrize(("change", "named"), MISTAKES.values(), ids=MISTAKES)
def test_a_mistake_in_the_part_is_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], change: tuple[str, str], named: str
) -> None:
    part = write_part(tmp_path, change)
    assert named in refused(capsys, "build", part, "-o", tmp_path / "bar.fmu")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["bar.vtu", "part.toml"]


def _inverted(folder: Path) -> None:
    points, cells = bar()
    cells[2] = cells[2][[4, 5, 6, 7, 0, 1, 2, 3]]
    write_mesh(folder, points, cells)


def _loose(folder: Path) -> None:
    write_mesh(folder, *beside(*bar(), (2 * LENGTH, 0.0, 0.0)))


def _hinged(folder: Path) -> None:
    """Two bars that share the nodes of one edge turn about it; only the first is held."""
    write_mesh(folder, *beside(*bar(), (LENGTH, WIDTH, 0.0)))


def _cut(folder: Path) -> None:
    file = folder / "bar.vtu"
    file.write_bytes(file.read_bytes()[: file.stat().st_size // 2])


def _empty(folder: Path) -> None:
    (folder / "bar.vtu").write_bytes(b"")


def _flat(folder: Path) -> None:
    points, _ = bar()
    meshio.Mesh(points, [("triangle", np.array([[0, 1, 2]]))]).write(folder / "bar.vtu")


MESHES: dict[str, tuple[Callable[[Path], None], str]] = {
    "inverted cell": (_inverted, "cell 3"),
    "loose piece": (_loose, "piece"),
    "hinge": (_hinged, "hinge"),
    "cut in half": (_cut, "cut off"),
    "empty file": (_empty, "empty"),
    "no solid cell": (_flat, "solid"),
}


@pytest.mark.parametrize(("spoil", "named"), MESHES.values(), ids=MESHES)
def test_a_mistake_in_the_mesh_is_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], spoil: Callable[[Path], None], named: str
) -> None:
    part = write_part(tmp_path)
    spoil(tmp_path)
    assert named in refused(capsys, "build", part, "-o", tmp_path / "bar.fmu")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["bar.vtu", "part.toml"]


def test_cells_without_material(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    part = write_part(tmp_path, ('name = "steel"\n', 'name = "steel"\ncells = "group 1"\n'))
    write_mesh(tmp_path, *bar(), np.array([1, 1, 1, 1, 1, 2]))
    assert "material" in refused(capsys, "build", part, "-o", tmp_path / "bar.fmu")
    write_mesh(tmp_path, *bar(), np.array([1, 1, 1, 1, 1, 1]))
    assert main(["build", str(part), "-o", str(tmp_path)]) == 0


# --- mistakes on the command line


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        (["biuld", "part.toml"], '"build"'),
        (["build"], "PART"),
        (["build", "part.toml", "extra"], "extra"),
        (["build", "part.toml", "--runtime", "fortran"], "fortran"),
        (["build", "part.toml", "--platform", "linux64,amiga"], "win64"),
        (["build", "part.toml", "--platform", ""], "win64"),
        (["build", "part.toml", "--runtime", "python", "--platform", "linux64"], "leave it out"),
        (["modes", "part.toml", "--jsn"], "--json"),
        (["inspect", "bar.vtu", "--length-unit", "yd"], "yd"),
        (["inspect", "missing.vtu"], "missing.vtu"),
        (["build", "missing.toml"], "missing.toml"),
        (["build", "empty"], "part.toml"),
        (["build", "part.toml", "-o", "nowhere"], "nowhere"),
        (["build", "part.toml", "-o", "nowhere/bar.fmu"], "nowhere"),
        (["modes", "part.toml", "--vtu", "shapes.png"], ".vtu"),
        (["modes", "part.toml", "--vtu", "nowhere/shapes.vtu"], "nowhere"),
    ],
)
def test_a_mistake_on_the_command_line_is_one_line(
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    arguments: list[str],
    named: str,
) -> None:
    def too_late(*_: object, **__: object) -> None:
        pytest.fail("the mistake was found after the computation began")

    monkeypatch.setattr("precompute.pipeline.reduce_part", too_late)
    write_part(tmp_path)
    (tmp_path / "empty").mkdir()
    monkeypatch.chdir(tmp_path)
    assert named in refused(capsys, *arguments)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["bar.vtu", "empty", "part.toml"]


def test_static_start_of_a_free_body(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    static = ("count = 8", 'count = 8\ninitial = "static"')
    assert "support" in refused(capsys, "build", write_part(tmp_path, static, FREE), "-o", tmp_path)


def test_an_older_fmu_survives_a_failed_build(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    fmu = tmp_path / "bar.fmu"
    fmu.write_bytes(b"the older one")
    refused(capsys, "build", write_part(tmp_path, ("count = 8", "count = 800")), "-o", fmu)
    assert fmu.read_bytes() == b"the older one"


def test_what_was_said_is_not_said_again(capsys: pytest.CaptureFixture[str]) -> None:
    """A stage that runs twice, as the search for an error does, repeats its notices."""
    with notices():
        for text in ("K is soft", "M is small", "K is soft"):
            notice(text)
        warning("K is soft")
    assert capsys.readouterr().err == "note: K is soft\nnote: M is small\nwarning: K is soft\n"


def test_exit_code_and_streams_of_the_process(tmp_path: Path) -> None:
    done = command("build", "nowhere.toml", cwd=tmp_path)
    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr.startswith("error: ")
    assert done.stderr.count("\n") == 1
