"""modalfmu ssp: what a system file becomes, and what is refused."""

import tomllib
import zipfile
from collections.abc import Iterable, Mapping
from pathlib import Path

import fmpy.ssp
import pytest
from described_fmus import UNITS, describe_fmu
from fmpy.ssp.ssd import Component, read_ssd
from foreign_systems import LINEAR, SYSTEM, write_pair
from lxml import etree
from small_part import write_part

import precompute
from fmu_src.native_fmu import build_native_fmu
from fmu_src.runtime.model import ReducedModel
from precompute.cli import main
from precompute.pipeline import silent
from precompute.ssp_elements import read_elements
from precompute.ssp_file import SystemFile, read_system_file

NS = {
    "ssc": "http://ssp-standard.org/SSP1/SystemStructureCommon",
    "ssd": "http://ssp-standard.org/SSP1/SystemStructureDescription",
    "ssv": "http://ssp-standard.org/SSP1/SystemStructureParameterValues",
}


def system_of(names: Iterable[str], *tables: str) -> str:
    """A system file over NAME.fmu and further tables."""
    components = "".join(f'[[component]]\nname = "{name}"\nfmu = "{name}.fmu"\n' for name in names)
    return '[system]\nname = "s"\n' + components + "\n".join(tables)


def wire(source: str, target: str, more: str = "") -> str:
    return f'[[connection]]\nfrom = "{source}"\nto = "{target}"\n{more}\n'


def packaged(folder: Path, text: str) -> Path:
    """The SSP of a system file that is right."""
    file = folder / "system.toml"
    file.write_text(text, encoding="utf-8")
    path = folder / "s.ssp"
    assert main(["ssp", str(file), "-o", str(path), "--no-certificate"]) == 0
    return path


def structure(path: Path) -> etree._Element:
    """SystemStructure.ssd, valid by FMPy's schema."""
    read_ssd(str(path), validate=True)
    with zipfile.ZipFile(path) as archive:
        return etree.fromstring(archive.read("SystemStructure.ssd"))


def refused(capsys: pytest.CaptureFixture[str], folder: Path, text: str) -> str:
    """The one line that refuses a system file; nothing is written."""
    file = folder / "system.toml"
    file.write_text(text, encoding="utf-8")
    capsys.readouterr()
    assert main(["ssp", str(file), "-o", str(folder / "s.ssp"), "--no-certificate"]) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert not (folder / "s.ssp").exists()
    errors = [line for line in said.err.splitlines() if not line.startswith(("note: ", "warning: "))]
    assert len(errors) == 1, said.err
    return errors[0].removeprefix("error: ").removeprefix(f"{file}: ")


@pytest.fixture
def two(tmp_path: Path) -> Path:
    """A folder with two FMUs that tell their dependencies: forces in, motions out; and one that does not."""
    for name in ("left", "right"):
        describe_fmu(
            tmp_path / f"{name}.fmu",
            {"tip.force.x": "N", "tip.force.z": "N", "root.motion.x": "m/s2"},
            {"tip.displacement.x": "m", "tip.acceleration.x": "m/s2", "root.reaction.x": "N"},
            depends={
                "tip.displacement.x": [],
                "tip.acceleration.x": ["tip.force.x", "root.motion.x"],
                "root.reaction.x": ["tip.force.x", "root.motion.x"],
            },
            others='<ScalarVariable name="mode" valueReference="9" causality="parameter" variability="fixed">'
            '<Integer start="0" min="0" max="3"/></ScalarVariable>'
            '<ScalarVariable name="on" valueReference="9" causality="input" variability="discrete">'
            '<Boolean start="false"/></ScalarVariable>',
        )
    describe_fmu(
        tmp_path / "other.fmu",
        {"x": "mm", "t": "K", "plain": "", "odd": "furlong"},
        {"f": "kN", "temperature": "degC", "number": "", "odder": "furlong", "f_odd": "pond"},
    )
    return tmp_path


# --- what is written


def test_package_is_read_by_fmpy(tmp_path: Path) -> None:
    path = tmp_path / "pair.ssp"
    assert main(["ssp", str(write_pair(tmp_path, SYSTEM + LINEAR)), "-o", str(path)]) == 0
    system = read_ssd(str(path), validate=True).system
    assert [(c.name, c.source) for c in system.elements if isinstance(c, Component)] == [
        (name, f"resources/{name}.fmu") for name in ("left", "right", "mount")
    ]
    found = {(c.startElement, c.startConnector, c.endElement, c.endConnector) for c in system.connections}
    assert found == {
        ("mount", "a.force.x", "right", "push.force.x"),
        ("left", "tip.displacement.x", "mount", "a.displacement.x"),
        ("left", "tip.velocity.x", "mount", "a.velocity.x"),
        ("mount", "a.force.x", "left", "tip.force.x"),
        ("right", "tip.displacement.x", "mount", "b.displacement.x"),
        ("right", "tip.velocity.x", "mount", "b.velocity.x"),
        ("mount", "b.force.x", "right", "tip.force.x"),
    }
    values = system.elements[0].parameterBindings[0].parameterValues[0].parameters
    assert {(p.name, p.type, p.value) for p in values} == {
        ("push.force.x", "Real", "2.0"),
        ("damping.alpha", "Real", "0.6"),
    }
    with zipfile.ZipFile(path) as archive:
        assert archive.read("resources/left.fmu") == (tmp_path / "left.fmu").read_bytes()


def test_same_bytes(tmp_path: Path) -> None:
    file = write_pair(tmp_path)
    first, second = tmp_path / "first.ssp", tmp_path / "second.ssp"
    for path in (first, second):
        assert main(["ssp", str(file), "-o", str(path)]) == 0
    assert first.read_bytes() == second.read_bytes()


def test_connectors_units_and_the_experiment(two: Path) -> None:
    """Inputs that nothing is joined to are left out; all Real outputs are there, with their units."""
    text = system_of(
        ["left", "other"],
        wire("left.tip.displacement.x", "other.x"),
        wire("other.f", "left.tip.force.x"),
        '[[output]]\nname = "tip"\nfrom = "left.tip.displacement.x"\n',
        '[[input]]\nname = "pull"\nto = ["left.tip.force.z"]\n',
        "[experiment]\nstop = 3.0\nstep = 0.25\n",
    )
    root = structure(packaged(two, text))
    left = root.find("ssd:System/ssd:Elements/ssd:Component[@name='left']", NS)
    connectors = {
        c.get("name"): (c.get("kind"), c.find("ssc:Real", NS).get("unit"))
        for c in left.findall("ssd:Connectors/ssd:Connector", NS)
    }
    assert connectors == {
        "tip.force.x": ("input", "N"),
        "tip.force.z": ("input", "N"),
        "tip.displacement.x": ("output", "m"),
        "tip.acceleration.x": ("output", "m/s2"),
        "root.reaction.x": ("output", "N"),
    }
    outside = {
        c.get("name"): (c.get("kind"), c.find("ssc:Real", NS).get("unit"))
        for c in root.findall("ssd:System/ssd:Connectors/ssd:Connector", NS)
    }
    assert outside == {"pull": ("input", "N"), "tip": ("output", "m")}
    units = {u.get("name"): dict(u.find("ssc:BaseUnit", NS).attrib) for u in root.iterfind(".//ssc:Unit", NS)}
    assert units == {
        "N": {"kg": "1", "m": "1", "s": "-2"},
        "kN": {"kg": "1", "m": "1", "s": "-2", "factor": "1000.0"},
        "m": {"m": "1"},
        "mm": {"m": "1", "factor": "0.001"},
        "m/s2": {"m": "1", "s": "-2"},
        "degC": {"K": "1", "offset": "273.15"},
    }
    experiment = root.find("ssd:DefaultExperiment", NS)
    assert experiment.get("stopTime") == "3.0"
    assert b'baseStepSize="0.25"' in etree.tostring(experiment)


@pytest.mark.parametrize(
    ("source", "target", "more", "factor", "offset"),
    [
        ("left.tip.displacement.x", "other.x", "", 1000.0, 0.0),
        ("other.f", "left.tip.force.x", "", 1000.0, 0.0),
        ("other.f", "left.tip.force.x", "factor = -2.0\noffset = 5.0", -2000.0, 5.0),
        ("other.temperature", "other.t", "", 1.0, 273.15),
        ("other.temperature", "other.t", "factor = 2.0\noffset = 1.0", 2.0, 2 * 273.15 + 1.0),
    ],
)
def test_units_are_converted(
    two: Path, source: str, target: str, more: str, factor: float, offset: float
) -> None:
    """By a transformation that masters without units do as well, and that no master does twice."""
    root = structure(packaged(two, system_of(["left", "other"], wire(source, target, more))))
    connection = root.find(".//ssd:Connection", NS)
    linear = connection.find("ssc:LinearTransformation", NS)
    assert connection.get("suppressUnitConversion") == "true"
    assert float(linear.get("factor")) == pytest.approx(factor, rel=1e-15)
    assert float(linear.get("offset")) == pytest.approx(offset, rel=1e-15)


def test_a_value_that_goes_over_as_it_is(two: Path) -> None:
    text = system_of(["left", "right"], wire("left.root.reaction.x", "right.tip.force.x"))
    connection = structure(packaged(two, text)).find(".//ssd:Connection", NS)
    assert connection.get("suppressUnitConversion") is None
    assert len(connection) == 0


def test_start_values_of_every_type(two: Path) -> None:
    text = system_of(["left"]).replace(
        'fmu = "left.fmu"', 'fmu = "left.fmu"\nstart = { mode = 2, on = true, tip.force.x = 1.5 }'
    )
    root = structure(packaged(two, text))
    schema = Path(fmpy.ssp.__file__).parent / "schema" / "SystemStructureParameterValues.xsd"
    etree.XMLSchema(file=str(schema)).assertValid(root.find(".//ssv:ParameterSet", NS))
    values = root.findall(".//ssv:Parameter", NS)
    assert {(v.get("name"), etree.QName(v[0]).localname, v[0].get("value")) for v in values} == {
        ("mode", "Integer", "2"),
        ("on", "Boolean", "true"),
        ("tip.force.x", "Real", "1.5"),
    }


def test_parts_are_built(tmp_path: Path) -> None:
    """A folder of a part, named twice and built once; springs at its ports."""
    write_part(tmp_path)
    text = """
[system]
name = "bars"

[[component]]
name = "one"
part = "."

[[component]]
name = "two"
part = "part.toml"

[[spring_damper]]
name = "mount"
ports = ["one.tip", "two.tip"]
stiffness = { x = 1e4, z = 2e4 }
"""
    path = packaged(tmp_path, text)
    names = {c.name for c in read_ssd(str(path)).system.elements}
    assert names == {"one", "two", "mount"}
    assert len(read_ssd(str(path)).system.connections) == 8
    built = []

    def build(model: ReducedModel, target: Path, extra: Mapping[str, bytes]) -> Path:
        built.append(model.name)
        return build_native_fmu(model, target, extra)

    file, _ = read_system_file(tmp_path / "system.toml")
    elements = read_elements(file, build, silent, certified=False)
    assert built == ["bar", "mount"]
    assert elements["one"].fmu == elements["two"].fmu


# --- what is refused


@pytest.mark.parametrize(
    ("tables", "expected"),
    [
        (
            [wire("left.tip.displacement.x", "rigth.tip.force.x")],
            'there is no component "rigth"; did you mean right?',
        ),
        (
            [wire("left.tip.displacment.x", "other.x")],
            "[1].from: left has no output 'tip.displacment.x'; did you mean left.tip.displacement.x?",
        ),
        (
            [wire("left.tip.displacement.x", "right.tip.forces.x")],
            "connection[1].to: right has no input 'tip.forces.x'; did you mean right.tip.force.x?",
        ),
        ([wire("left.tip.force.x", "right.tip.force.x")], "of causality input, expected an output of left"),
        ([wire("left.tip.displacement.x", "right.mode")], "causality parameter, expected an input of right"),
        ([wire("left.tip.displacement.x", "right.on")], "of type Boolean, expected a Real"),
        (
            [wire("left.tip.displacement.x", "right.tip.force.x")],
            "left.tip.displacement.x is in m, right.tip.force.x in N, expected a force or moment; "
            "to join two ports that take forces put a [[spring_damper]] between them, or give that of right "
            'inputs = ["motion.…"]',
        ),
        (
            [wire("other.f", "left.root.motion.x")],
            "f is in kN, left.root.motion.x in m/s2, expected a motion",
        ),
        (
            [wire("other.temperature", "left.tip.force.x")],
            "in degC, left.tip.force.x in N, expected units of",
        ),
        ([wire("other.f_odd", "left.tip.force.x")], "is in pond, left.tip.force.x in N, expected one unit"),
        (
            [wire("left.root.reaction.x", "right.tip.force.x"), wire("other.f", "right.tip.force.x")],
            "connection[2]: right.tip.force.x gets other.f, and left.root.reaction.x by connection[1] too",
        ),
        (
            ['[[input]]\nname = "u"\nto = ["left.tip.force.x"]\n', wire("other.f", "left.tip.force.x")],
            "input[1].to[1]: left.tip.force.x gets u, and other.f by connection[1] too",
        ),
        (
            ['[[input]]\nname = "u"\nto = ["left.tip.force.x", "other.x"]\n'],
            "other.x is in mm, left.tip.force.x in N, expected one unit for the input u",
        ),
        (
            [
                wire("left.root.reaction.x", "right.tip.force.x"),
                wire("right.root.reaction.x", "left.tip.force.x"),
            ],
            "a rigid loop without motion, left.root.reaction.x → right.tip.force.x, "
            "right.root.reaction.x → left.tip.force.x: neither side is told how to move",
        ),
        (
            [
                wire("left.tip.acceleration.x", "right.root.motion.x"),
                wire("right.tip.acceleration.x", "left.root.motion.x"),
            ],
            "a rigid loop without force, left.tip.acceleration.x → right.root.motion.x, "
            "right.tip.acceleration.x → left.root.motion.x: both sides are told how to move",
        ),
        (
            [wire("left.root.reaction.x", "left.tip.force.x")],
            "rigid loop without motion, left.root.reaction.x →",
        ),
        (
            ['[[spring_damper]]\nname = "s"\nports = ["left.tip", "right.tip"]\ndamping = { x = 1.0 }\n'],
            "spring_damper[1].ports[1]: left has no output 'tip.velocity.x'; did you mean",
        ),
        (
            ['[[spring_damper]]\nname = "s"\nports = ["left.tip", "left.tip"]\ndamping = { x = 1.0 }\n'],
            "spring_damper[1].ports: got",
        ),
        (['[[spring_damper]]\nname = "s"\nstiffness = { x = 0.0 }\n'], "got neither stiffness nor damping"),
        (['[[spring_damper]]\nname = "s"\nstiffness = { w = 1.0 }\n'], "a table of numbers ≥ 0 by direction"),
        (['[[spring_damper]]\nname = "left"\nstiffness = { x = 1.0 }\n'], "the name of component[1] too"),
        (
            ['[[output]]\nname = "y"\nfrom = "left.mode"\n'],
            "output[1].from: got left.mode, of causality param",
        ),
        ([wire("left", "right.tip.force.x")], 'connection[1].from: got "left", expected COMPONENT.VARIABLE'),
        (['[[connection]]\nform = "left.x"\nto = "right.x"\n'], "did you mean from?"),
        (["[experiment]\nstop = -1.0\n"], "experiment.stop: got -1.0, expected the time of the end in s"),
    ],
)
def test_what_does_not_fit_is_refused(
    two: Path, capsys: pytest.CaptureFixture[str], tables: list[str], expected: str
) -> None:
    assert expected in refused(capsys, two, system_of(["left", "right", "other"], *tables))


@pytest.mark.parametrize(
    ("start", "expected"),
    [
        ("{ mood = 1 }", "component[1].start: the FMU has no variable 'mood'; did you mean 'mode'?"),
        ("{ mode = 4 }", "expected at most 3"),
        ("{ mode = 1.5 }", "expected a whole number"),
        ("{ tip.displacement.x = 1.0 }", "is calculated by the FMU"),
        ('{ mode = "1" }', "expected a table of variables with start values"),
        ("{ tip.force.x = inf }", "expected a table of variables with start values"),
    ],
)
def test_start_values_that_cannot_be_set(
    two: Path, capsys: pytest.CaptureFixture[str], start: str, expected: str
) -> None:
    text = system_of(["left"]).replace('fmu = "left.fmu"', f'fmu = "left.fmu"\nstart = {start}')
    assert expected in refused(capsys, two, text)


def test_files_that_are_not_there(two: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert "absent.fmu: cannot be read" in refused(capsys, two, system_of(["absent"]))
    assert main(["ssp", str(two / "absent.toml")]) == 2
    assert "got no such file, expected a system file" in capsys.readouterr().err
    (two / "system.toml").write_text(system_of(["left"]), encoding="utf-8")
    (two / "empty").mkdir()
    assert main(["ssp", str(two / "empty")]) == 2
    assert "got a folder without system.toml" in capsys.readouterr().err
    assert main(["ssp", str(two), "-o", str(two / "s.zip")]) == 2
    assert "ends in .ssp" in capsys.readouterr().err
    both = system_of(["left"]).replace('fmu = "left.fmu"', 'fmu = "left.fmu"\npart = "left"')
    assert "got part and fmu, expected exactly one of part, fmu" in refused(capsys, two, both)


def test_one_unit_with_two_meanings(two: Path, capsys: pytest.CaptureFixture[str]) -> None:
    describe_fmu(two / "wrong.fmu", {}, {"x": "m"}, units={**UNITS, "m": 'm="1" factor="0.3"'})
    assert "mean different things by the unit m" in refused(capsys, two, system_of(["left", "wrong"]))


# --- what is said


def notices(capsys: pytest.CaptureFixture[str], folder: Path, text: str) -> str:
    capsys.readouterr()
    packaged(folder, text)
    return capsys.readouterr().err


@pytest.mark.parametrize(
    ("tables", "expected"),
    [
        (
            [
                wire("left.tip.acceleration.x", "right.root.motion.x"),
                wire("right.root.reaction.x", "left.tip.force.x", "factor = -1.0"),
            ],
            "each depends on the one before at once",
        ),
        (
            [wire("left.root.reaction.x", "right.tip.force.x", "factor = -1.0")],
            "FMPy and fmucontainer do not do that",
        ),
        (
            [wire("other.f", "left.tip.force.x"), wire("left.tip.acceleration.x", "other.plain")],
            "each depends on the one before at once",  # other.fmu does not tell what f depends on
        ),
        ([wire("other.number", "left.tip.force.x")], "other.number has no unit; taken as N"),
    ],
)
def test_notices(two: Path, capsys: pytest.CaptureFixture[str], tables: list[str], expected: str) -> None:
    assert expected in notices(capsys, two, system_of(["left", "right", "other"], *tables))


@pytest.mark.parametrize(
    "tables",
    [
        # displacement does not depend on force at once
        [wire("left.tip.displacement.x", "other.x"), wire("other.f", "left.tip.force.x")],
        # neither does the other direction of the same port
        [wire("left.root.reaction.x", "left.tip.force.z")],
        # no way back
        [wire("left.root.reaction.x", "right.tip.force.x")],
    ],
)
def test_what_is_no_loop(two: Path, capsys: pytest.CaptureFixture[str], tables: list[str]) -> None:
    assert "at once" not in notices(capsys, two, system_of(["left", "right", "other"], *tables))


def test_the_example_of_the_document_is_right() -> None:
    """All of its keys are known, and no key of a system file is missing there."""
    text = (Path(precompute.__file__).parent / "SYSTEM.md").read_text(encoding="utf-8")
    example = tomllib.loads(text.partition("```toml\n")[2].partition("```")[0])
    file = SystemFile.model_validate(example, context=Path())
    assert {*example} == {*SystemFile.model_fields}
    assert [one.name for one in file.component] == ["boom", "controller", "hook"]
    assert file.component[0].start == {"damping.alpha": 2.0, "tip.force.y": 5.0}
    assert file.connection[1].factor == -1.0
