"""Reference results in the FMU (FMI-LS-REF): FMPy repeats them, their form is the standard's."""

import zipfile
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np
import pytest
from driven import driven
from examples import everything, oscillator, two_ports
from scipy.integrate import solve_ivp
from small_part import write_part

from fmu_src.native_fmu import build_native_fmu
from fmu_src.python_fmu import build_python_fmu
from fmu_src.runtime.model import Floats, Port, ReducedModel
from precompute.check.process import run_group
from precompute.check.unpack import unpack
from precompute.errors import ModelError
from precompute.experiments import (
    CELLS,
    OUTPUTS,
    STEPS,
    TOLERANCE,
    Experiment,
    difference,
    reference_experiments,
)
from precompute.fmu_face import read_face
from precompute.ls_ref import EXPERIMENTS, FOLDER, MANIFEST, NAMESPACE, read_experiments, write_experiments
from precompute.part import read_part
from precompute.pipeline import package, reduce_part
from precompute.simulation import simulate


def repeated(fmu: Path) -> dict[str, float]:
    """The largest difference of each experiment, run by FMPy, as a part of its tolerance."""
    face = read_face(fmu)
    units = {name: face.unit(name) for name in face.outputs}
    found = {}
    for e in read_experiments(fmu):
        result = simulate(face, e.stimuli, stop=e.stop, step=e.step).result
        np.testing.assert_allclose(result["time"], e.references["time"], rtol=1e-12)
        found[e.name] = max(difference(e, result, units).values()) / e.tolerance
    return found


def with_references(model: ReducedModel, path: Path, of: ReducedModel | None = None) -> Path:
    """The native FMU of a model with the reference results of this one, or of another."""
    return build_native_fmu(model, path, write_experiments(reference_experiments(of or model)))


@pytest.mark.parametrize("make", [oscillator, two_ports, everything, driven])
def test_the_native_fmu_gives_its_reference_results(make: type, tmp_path: Path) -> None:
    found = repeated(with_references(make(), tmp_path / "part.fmu"))
    assert found.keys() == {"step", "signals"}
    assert max(found.values()) <= 1.0


def test_a_static_start_begins_in_equilibrium_with_the_first_inputs(tmp_path: Path) -> None:
    elastic = everything(lam=np.array([3.0, 7.0, 30.0, 30.0, 400.0, 9000.0, 2e4]), initial="static")
    found = repeated(with_references(elastic, tmp_path / "part.fmu"))
    assert found.keys() == {"signals"}  # nothing moves under a constant force
    assert found["signals"] <= 1.0
    moving = replace(elastic, initial="rest")
    assert repeated(with_references(moving, tmp_path / "part.fmu", of=elastic))["signals"] > 1e6


def test_an_output_that_is_only_rounding_is_left_out() -> None:
    """Two equal modes that move against each other: the first output cancels, the second one adds up."""
    model = two_ports()
    B, C = np.ones((6, 3)), np.zeros((5, 6))
    C[0, 2:4] = (1 / 3, -1 / 3)
    C[1:, 2:4] = 1 / 3
    lam = np.array([0.0, 0.0, 30.0, 30.0 * (1 + 1e-15), 400.0, 9000.0])
    symmetric = replace(model, lam=lam, D_rest=np.zeros((6, 6)), B=B, C=C)
    for e in reference_experiments(symmetric):
        assert "left.displacement.x" in e.outputs  # beside another one in m it is 0
    ports = (model.ports[0], replace(model.ports[1], outputs=()))
    alone = replace(symmetric, ports=ports, C=C[:3], R=model.R[:3])
    for e in reference_experiments(alone):
        assert e.outputs == ["left.velocity.z", "left.acceleration.z"]


@pytest.mark.parametrize(
    ("changed", "by"),
    [("lam", 1 + 1e-6), ("B", 1 + 1e-6), ("C", 1 + 1e-6), ("D_rest", 1 + 1e-4)],
)
def test_another_model_does_not_give_them(changed: str, by: float, tmp_path: Path) -> None:
    """The control: each array a little wrong, as much as only a thousand tolerances show."""
    model = two_ports()
    other = replace(model, **{changed: getattr(model, changed) * by})
    found = repeated(with_references(other, tmp_path / "part.fmu", of=model))
    assert max(found.values()) > 100.0


def test_an_input_that_does_little_is_not_lost(tmp_path: Path) -> None:
    """A pressure of 1 Pa beside a force of 1 N: a wrong column is noticed all the same."""
    scale = np.array([1.0, 1e-7, 1.0])
    model = two_ports()
    small = replace(model, B=model.B * scale)
    wrong = replace(model, B=model.B * scale * (1.0, 1 + 1e-6, 1.0))
    assert max(repeated(with_references(small, tmp_path / "good.fmu")).values()) <= 1.0
    assert max(repeated(with_references(wrong, tmp_path / "bad.fmu", of=small)).values()) > 10.0


def test_the_references_are_the_solution_of_the_equations_of_motion() -> None:
    """An oracle that shares nothing with the twins: an adaptive integrator of order 8, step by step."""
    model = oscillator()
    for e in reference_experiments(model):
        u, t = e.stimuli["tip.force.x"], e.references["time"]
        y = np.zeros((len(t), 2))
        for k in range(len(t) - 1):

            def rate(_: float, y: Floats, force: float = u[k]) -> list[float]:
                return [y[1], force - 0.4 * y[1] - 400.0 * y[0]]

            y[k + 1] = solve_ivp(rate, (0, e.step), y[k], method="DOP853", rtol=1e-11, atol=1e-14).y[:, -1]
        for column, name in enumerate(("displacement", "velocity")):
            reference = e.references[f"tip.{name}.x"]
            np.testing.assert_allclose(reference, y[:, column], atol=1e-8 * np.abs(y[:, column]).max())


def test_both_runtimes_carry_the_same_ones_after_build(tmp_path: Path) -> None:
    part = reduce_part(read_part(write_part(tmp_path)))
    native = package(part, tmp_path / "native.fmu")
    python = package(part, tmp_path / "python.fmu", build=build_python_fmu)
    assert files_of(native) == files_of(python)
    assert max(repeated(native).values()) <= 1.0
    unpack(python, tmp_path / "python")  # which runs in a process of its own
    checked = run_group(tmp_path / "python", "references", 2, 60.0)
    assert not checked.findings
    assert not checked.skipped
    again = package(part, tmp_path / "again.fmu")
    assert again.read_bytes() == native.read_bytes()
    with zipfile.ZipFile(native) as archive:
        assert 'href="fmi-ls-ref.txt"' in archive.read("documentation/index.html").decode()
        assert "documentation/fmi-ls-ref.txt" in archive.namelist()


def files_of(fmu: Path) -> dict[str, bytes]:
    with zipfile.ZipFile(fmu) as archive:
        return {name: archive.read(name) for name in archive.namelist() if name.startswith(FOLDER)}


def test_the_manifest_is_that_of_the_standard() -> None:
    """FMI-LS-REF 1.0.0-beta.1, tables 1 to 3; all its sources are there, all that is there is told."""
    files = write_experiments(reference_experiments(two_ports()))
    root = ET.fromstring(files[MANIFEST])
    assert root.tag == "fmiReferences"
    assert root.attrib == {
        f"{{{NAMESPACE}}}fmi-ls-name": "org.fmi-standard.fmi-ls-ref",
        f"{{{NAMESPACE}}}fmi-ls-version": "1.0.0-alpha.1",
        f"{{{NAMESPACE}}}fmi-ls-description": (
            "Layered Standard providing information on related files included in an FMU."
        ),
    }
    assert b"fmi-ls:fmi-ls-name" in files[MANIFEST]
    (related,) = root
    assert related.get("type") == "application/x-ma-hs-experiments"
    assert related.get("role") == "experiment/validation"
    source = related.get("source")
    experiments = ET.fromstring(files[f"{FOLDER}/{source}"])
    sources = {child.get("source") for one in experiments for child in one}
    told = {MANIFEST, f"{FOLDER}/{source}", *(f"{FOLDER}/{name}" for name in sources)}
    assert told == {name for name in files if name.startswith("extra/")}


def test_they_come_back_as_they_were_written(tmp_path: Path) -> None:
    model = everything()
    written = reference_experiments(model)
    read = read_experiments(with_references(model, tmp_path / "part.fmu"))
    with zipfile.ZipFile(tmp_path / "part.fmu") as archive:
        archive.extractall(tmp_path / "part")
    unpacked = read_experiments(tmp_path / "part")
    for one, back, other in zip(written, read, unpacked, strict=True):
        np.testing.assert_array_equal(other.references, back.references)
        assert (one.start, one.stop, one.step) == (back.start, back.stop, back.step)
        assert (one.name, one.description, one.tolerance) == (back.name, back.description, back.tolerance)
        np.testing.assert_array_equal(back.stimuli, one.stimuli)
        for name in one.outputs:  # twelve digits
            np.testing.assert_allclose(back.references[name], one.references[name], rtol=5e-12)


def many(outputs: int) -> ReducedModel:
    rng = np.random.default_rng(0)
    ports = tuple(Port(f"p{k}", ("force.x",) if k == 0 else (), ("displacement.x",)) for k in range(outputs))
    model = oscillator()
    C, R = rng.standard_normal((outputs, 1)), np.zeros((outputs, 1))
    return replace(model, C=C, R=R, ports=ports)


@pytest.mark.parametrize(("outputs", "steps", "kept"), [(100, 100, 100), (300, 50, 300), (900, 50, 300)])
def test_large_parts_have_small_tables(outputs: int, steps: int, kept: int) -> None:
    for e in reference_experiments(many(outputs)):
        assert len(e.references) == steps + 1
        assert len(e.outputs) == kept <= OUTPUTS
        assert (kept + 1) * steps <= CELLS
    assert sorted(STEPS, reverse=True) == list(STEPS)


def test_a_part_without_inputs_or_outputs_has_none(tmp_path: Path) -> None:
    model = two_ports()
    deaf = replace(
        model, B=np.zeros((6, 0)), R=np.zeros((5, 0)), R_in=np.zeros((0, 0)), ports=no_inputs(model)
    )
    assert write_experiments(reference_experiments(deaf)) == {}
    assert read_experiments(build_native_fmu(deaf, tmp_path / "part.fmu")) == ()


def no_inputs(model: ReducedModel) -> tuple[Port, ...]:
    return tuple(replace(port, inputs=()) for port in model.ports)


def archive_with(path: Path, files: Mapping[str, bytes]) -> Path:
    with zipfile.ZipFile(path, "w") as archive:
        for name, content in files.items():
            archive.writestr(name, content)
    return path


def test_the_other_way_to_write_an_experiment_is_read_too(tmp_path: Path) -> None:
    """The latest draft of the schema has the times in an element of their own."""
    files = write_experiments(reference_experiments(oscillator()))
    name = f"{FOLDER}/{EXPERIMENTS}"
    text = files[name].decode()
    root = ET.fromstring(text)
    for one in root:
        times = {key: one.attrib.pop(key) for key in ("startTime", "stopTime", "stepSize")}
        one.insert(0, ET.Element("TransientSimulation", times))
    other = read_experiments(archive_with(tmp_path / "a.fmu", {**files, name: ET.tostring(root)}))
    same = read_experiments(archive_with(tmp_path / "b.fmu", files))
    assert [about(e) for e in other] == [about(e) for e in same]
    with_parameters = text.replace("<Stimuli", '<Parameters source="p.ssv" /><Stimuli', 1)
    kept = read_experiments(archive_with(tmp_path / "c.fmu", {**files, name: with_parameters.encode()}))
    assert [e.name for e in kept] == ["signals"]


def about(e: Experiment) -> tuple[str, float, float, float, float]:
    return e.name, e.start, e.stop, e.step, e.tolerance


@pytest.mark.parametrize(
    ("name", "old", "new"),
    [
        ("fmi-ls-manifest.xml", b"</fmiReferences>", b""),
        ("fmi-ls-manifest.xml", b"experiments.exp", b"others.exp"),
        (EXPERIMENTS, b'stepSize="', b'stepSize="-'),
        (EXPERIMENTS, b'tolerance="', b'tolerance="x'),
        (EXPERIMENTS, b"step-ref.csv", b"gone-ref.csv"),
        ("step-ref.csv", b"time,", b"t,"),
        ("step-ref.csv", b"0.0,", b"0.0,1.0,"),
        ("step-ref.csv", b"0.0,", b"nan,"),
        ("step-in.csv", b"0.0,1", b"0.0,one"),
    ],
)
def test_damaged_files_are_refused(name: str, old: bytes, new: bytes, tmp_path: Path) -> None:
    files = write_experiments(reference_experiments(oscillator()))
    place = f"{FOLDER}/{name}"
    assert old in files[place]
    damaged = archive_with(tmp_path / "part.fmu", {**files, place: files[place].replace(old, new, 1)})
    with pytest.raises(ModelError, match=r"^part\.fmu: its reference results cannot be read \(."):
        read_experiments(damaged)


def test_files_outside_the_archive_are_not_looked_for(tmp_path: Path) -> None:
    files = write_experiments(reference_experiments(oscillator()))
    for source in (b"https://example.org/e.exp", b"../../../e.exp", b"/etc/e.exp"):
        manifest = files[MANIFEST].replace(b"experiments.exp", source)
        assert read_experiments(archive_with(tmp_path / "a.fmu", {**files, MANIFEST: manifest})) == ()


def test_the_difference_is_a_part_of_the_peak_of_the_unit() -> None:
    (e, _) = reference_experiments(two_ports())
    result = e.references.copy()
    peak = np.abs(e.references["left.displacement.x"]).max()
    result["right.displacement.y"][7] += 0.25 * peak
    units = {name: "m" if "displacement" in name else name for name in e.outputs}
    largest = max(peak, np.abs(e.references["right.displacement.y"]).max())
    found = difference(e, result, units)
    assert found.pop("right.displacement.y") == pytest.approx(0.25 * peak / largest)
    assert {*found.values()} == {0.0}
    result["left.velocity.z"][3] = np.nan
    assert difference(e, result, units)["left.velocity.z"] == np.inf
    assert e.tolerance == TOLERANCE
