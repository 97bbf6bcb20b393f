"""modalfmu ssp: what it refuses in one line, and what it says."""

from pathlib import Path

import pytest
from described_fmus import UNITS, describe_fmu
from small_part import write_part
from system_files import packaged, refused, system_of, wire, write_two

from precompute.cli import main


@pytest.fixture
def two(tmp_path: Path) -> Path:
    return write_two(tmp_path)


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
            "spring_damper[1].ports[1]: left.tip has no output 'velocity.x', which the spring "
            'or damper needs in that direction; add "velocity.x" to the outputs of the port, or leave',
        ),
        (
            ['[[spring_damper]]\nname = "s"\nports = ["left.tip", "right.top"]\nstiffness = { x = 1.0 }\n'],
            "right.top has no output 'displacement.x', which the spring or damper needs in that direction; "
            'add "displacement.x" to the outputs of the port, or leave the direction out, '
            "or did you mean right.tip?",
        ),
        (
            [wire("other.f", "left.tip.force.x", "factor = 1e307")],
            "connection[1]: from kN to N factor and offset are beyond all numbers",
        ),
        (
            ['[[spring_damper]]\nname = "s"\nports = ["left.tip", "left.tip"]\ndamping = { x = 1.0 }\n'],
            "spring_damper[1].ports: got",
        ),
        (['[[spring_damper]]\nname = "s"\nstiffness = { x = 0.0 }\n'], "got neither stiffness nor damping"),
        (['[[spring_damper]]\nname = "s"\nstiffness = { w = 1.0 }\n'], "a table of numbers ≥ 0 by direction"),
        (['[[spring_damper]]\nname = "left"\nstiffness = { x = 1.0 }\n'], "the name of component[1] too"),
        (
            ['[[spring_damper]]\nname = "Left"\nstiffness = { x = 1.0 }\n'],
            'spring_damper[1].name: got "Left" beside "left", expected more than another case',
        ),
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
        ("{ on = 2 }", "on: got '2.0', expected at most 1"),
        ('{ "tip.force.x" = 1.0, tip.force.x = 2.0 }', "expected a table of variables with start values"),
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


@pytest.mark.parametrize("factor", ["0", "NaN", "INF", "1e-320"])
def test_units_that_nothing_can_be_converted_by(
    two: Path, capsys: pytest.CaptureFixture[str], factor: str
) -> None:
    unit = f'kg="1" m="1" s="-2" factor="{factor}"'
    describe_fmu(two / "wrong.fmu", {"u": "Z"}, units={"Z": unit})
    text = system_of(["left", "wrong"], wire("left.root.reaction.x", "wrong.u"))
    assert "wrong.fmu: its unit Z has factor" in refused(capsys, two, text)


def test_numbers_of_a_description_that_are_none(two: Path, capsys: pytest.CaptureFixture[str]) -> None:
    describe_fmu(two / "wrong.fmu", experiment='stopTime="soon"')
    assert "wrong.fmu: its modelDescription.xml cannot be read" in refused(capsys, two, system_of(["wrong"]))
    describe_fmu(
        two / "wrong.fmu",
        others='<ScalarVariable name="x" valueReference="9" causality="input">'
        '<Real min="low"/></ScalarVariable>',
    )
    text = system_of(["wrong"]).replace("wrong.fmu", 'wrong.fmu"\nstart = { x = 1.0 }\n#')
    assert "wrong.fmu: its modelDescription.xml cannot be read" in refused(capsys, two, text)


def test_a_text_is_no_real(two: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = '<ScalarVariable name="s" valueReference="9" causality="output"><String/></ScalarVariable>'
    describe_fmu(two / "texts.fmu", others=text)
    said = refused(capsys, two, system_of(["left", "texts"], wire("texts.s", "left.tip.force.x")))
    assert "got texts.s, of type String, expected a Real; texts has no Real output" in said


def test_all_files_are_read_before_a_part_is_built(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write_part(tmp_path)
    part = '[[component]]\nname = "one"\npart = "part.toml"\n'
    for other, expected in (
        ('fmu = "absent.fmu"', "absent.fmu:"),
        ('part = "absent"', "absent:"),
    ):
        text = f'[system]\nname = "s"\n{part}[[component]]\nname = "two"\n{other}\n'
        (tmp_path / "system.toml").write_text(text, encoding="utf-8")
        assert main(["ssp", str(tmp_path), "-o", str(tmp_path / "s.ssp")]) == 2
        said = capsys.readouterr().err
        assert f"{expected} cannot be read" in said
        assert "modes of" not in said


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
    ("unit", "sensor", "actuator", "expected"),
    [
        ("N", "root.reaction.x", "tip.force.x", "rigid loop without motion"),
        ("m/s2", "tip.acceleration.x", "root.motion.x", "rigid loop without force"),
    ],
)
def test_a_controller_is_no_body(
    two: Path, capsys: pytest.CaptureFixture[str], unit: str, sensor: str, actuator: str, expected: str
) -> None:
    """Feedback of a force or an acceleration is a loop of one quantity with a solution: said, not refused."""
    describe_fmu(two / "control.fmu", {"y": unit}, {"u": unit}, depends={"u": ["y"]})
    loop = wire(f"left.{sensor}", "control.y"), wire("control.u", f"left.{actuator}")
    said = notices(capsys, two, system_of(["left", "control"], *loop))
    assert "loop's gain is below 1; between bodies, none a controller, this is a " + expected in said


def test_an_fmu_that_there_can_be_only_one_of(two: Path, capsys: pytest.CaptureFixture[str]) -> None:
    describe_fmu(two / "one.fmu", capabilities='canBeInstantiatedOnlyOncePerProcess="true"')
    again = '[[component]]\nname = "again"\nfmu = "one.fmu"\n'
    assert "once per process" not in notices(capsys, two, system_of(["one", "left"]))
    assert "component[2]: one.fmu can be instantiated once per process only" in notices(
        capsys, two, system_of(["one"], again)
    )


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
