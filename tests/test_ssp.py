"""modalfmu ssp: what a system file becomes."""

import tomllib
import zipfile
from collections.abc import Mapping
from pathlib import Path

import fmpy.ssp
import pytest
from described_fmus import describe_fmu
from fmpy.ssp.ssd import Component, read_ssd
from foreign_systems import LINEAR, SYSTEM, write_pair
from lxml import etree
from small_part import write_part
from system_files import NS, packaged, structure, system_of, wire, write_two

import precompute
from fmu_src.native_fmu import build_native_fmu
from fmu_src.runtime.model import ReducedModel
from precompute.cli import main
from precompute.pipeline import silent
from precompute.ssp_elements import read_elements
from precompute.ssp_file import SystemFile, read_system_file


@pytest.fixture
def two(tmp_path: Path) -> Path:
    return write_two(tmp_path)


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


def test_a_factor_that_undoes_the_units(two: Path) -> None:
    """Numbers go over as they are, and a master that knows units must not multiply by 1000."""
    text = system_of(["left", "other"], wire("other.f", "left.tip.force.x", "factor = 0.001"))
    connection = structure(packaged(two, text)).find(".//ssd:Connection", NS)
    assert connection.get("suppressUnitConversion") == "true"
    assert len(connection) == 0


@pytest.mark.parametrize(
    ("name", "one", "other"),
    [
        ("deg", 'rad="1" factor="0.0174532925199433"', 'rad="1" factor="0.017453292519943295"'),
        ("rad/s", 's="-1"', 'rad="1" s="-1"'),
    ],
)
def test_one_unit_in_the_words_of_two_tools(tmp_path: Path, name: str, one: str, other: str) -> None:
    """Digits of a factor and the exponent of rad make no other unit: nothing is converted."""
    describe_fmu(tmp_path / "a.fmu", {}, {"y": name}, units={name: one})
    describe_fmu(tmp_path / "b.fmu", {"u": name}, {}, units={name: other})
    root = structure(packaged(tmp_path, system_of(["a", "b"], wire("a.y", "b.u"))))
    connection = root.find(".//ssd:Connection", NS)
    assert connection.get("suppressUnitConversion") is None
    assert len(connection) == 0
    assert [unit.get("name") for unit in root.iterfind(".//ssc:Unit", NS)] == [name]


def test_one_input_of_the_system_in_the_words_of_two_tools(tmp_path: Path) -> None:
    """Both are degrees: one input goes to them."""
    for name, factor in (("a", "0.0174532925199433"), ("b", "0.017453292519943295")):
        describe_fmu(tmp_path / f"{name}.fmu", {"u": "deg"}, units={"deg": f'rad="1" factor="{factor}"'})
    text = system_of(["a", "b"], '[[input]]\nname = "angle"\nto = ["a.u", "b.u"]\n')
    assert len(structure(packaged(tmp_path, text)).findall(".//ssd:Connection", NS)) == 2


@pytest.mark.parametrize("experiment", ['stopTime="INF"', 'stopTime="-5"', 'stepSize="0"', 'stepSize="NaN"'])
def test_an_experiment_that_no_master_could_run_is_left_out(tmp_path: Path, experiment: str) -> None:
    path = describe_fmu(tmp_path / "a.fmu", experiment=experiment)
    root = structure(packaged(tmp_path, system_of([path.stem])))
    assert root.find("ssd:DefaultExperiment", NS).get("stopTime") == "1.0"
    assert b'baseStepSize="0.001"' in etree.tostring(root)


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


def test_the_example_of_the_document_is_right() -> None:
    """All of its keys are known, and no key of a system file is missing there."""
    text = (Path(precompute.__file__).parent / "SYSTEM.md").read_text(encoding="utf-8")
    example = tomllib.loads(text.partition("```toml\n")[2].partition("```")[0])
    file = SystemFile.model_validate(example, context=Path())
    assert {*example} == {*SystemFile.model_fields}
    assert [one.name for one in file.component] == ["boom", "controller", "hook"]
    assert file.component[0].start == {"damping.alpha": 2.0, "tip.force.y": 5.0}
    assert file.connection[1].factor == -1.0
