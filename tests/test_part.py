"""The part file: what is read, and the one line that each mistake is told in."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any, get_args

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from part_files import BEAM, changed, read, told, toml

from precompute.errors import PartError
from precompute.part import Part, read_part
from precompute.part_values import LengthUnit
from precompute.read_mesh import UNITS
from precompute.selection import Box, NamedSet, Nodes, Plane, Point

SECOND_MATERIAL = '[[material]]\nname = "rubber"\nyoung = 1e6\npoisson = 0.49\ndensity = 1000\n'


@pytest.fixture(scope="module")
def part_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("beam") / "part.toml"


class TestValid:
    def test_all_keys_are_found_under_their_names(self, part_file: Path) -> None:
        part = read(part_file, BEAM)
        assert (part.name, part.description, part.length_unit) == ("cantilever", None, "mm")
        assert part.mesh == part_file.parent / "beam.msh"
        assert part.source == part_file
        (steel,) = part.materials
        assert (steel.name, steel.young, steel.poisson, steel.cells) == ("steel", 210e9, 0.3, None)
        assert isinstance(steel.density, float)  # 7850 in the file
        (clamp,) = part.supports
        assert (clamp.at, clamp.fix) == (NamedSet("clamp"), ("x", "y", "z"))
        (tip,) = part.ports
        assert (tip.name, tip.at, tip.weights) == ("tip", Point((1.0, 0.0, 0.0)), "area")
        assert tip.inputs == ("force.y", "force.z")
        assert tip.outputs == ("displacement.y", "acceleration.z")
        assert (part.modes.count, part.modes.max_frequency, part.modes.initial) == (20, None, "rest")
        assert (part.damping.alpha, part.damping.beta) == (1.0, 1e-6)

    def test_what_may_be_left_out(self, part_file: Path) -> None:
        text = BEAM.split("[damping]")[0].replace('inputs = ["force.y", "force.z"]', "")
        part = read(part_file, text.replace('[[support]]\nat = "clamp"\nfix = ["x", "y", "z"]', ""))
        assert part.supports == part.pairs == part.springs == part.dashpots == part.masses == ()
        assert (part.system, part.accuracy, part.basis.kind) == (None, None, "modal")
        assert (part.loads.gravity, part.loads.base, part.energy.outputs) == (False, (), ())
        assert (part.ports[0].inputs, part.ports[0].kind) == ((), "average")
        assert part.modes.residual is False
        assert (part.damping.alpha, part.damping.beta) == (0.0, 0.0)
        assert part.damping.ratio is None
        assert part.damping.ratios is None

    @pytest.mark.parametrize(
        ("at", "expected"),
        [
            ('"clamp"', NamedSet("clamp")),
            ("{ point = [1, 2, 3] }", Point((1.0, 2.0, 3.0))),
            ("{ box = [[0, 0, 0], [1, 0, 2.5]] }", Box((0.0, 0.0, 0.0), (1.0, 0.0, 2.5))),
            ('{ plane = { normal = "y", at = -3 } }', Plane("y", -3.0)),
            ("{ nodes = [0, 17] }", Nodes((0, 17))),
        ],
    )
    def test_every_way_to_say_where(self, part_file: Path, at: str, expected: object) -> None:
        assert read(part_file, changed('"clamp"', at)).supports[0].at == expected

    def test_step_keeps_what_it_samples_twice_per_period(self, part_file: Path) -> None:
        modes = read(part_file, changed("count = 20", "step = 1e-3")).modes
        assert (modes.count, modes.step) == (None, 1e-3)
        assert modes.max_frequency == 500.0  # 1/(2h)

    def test_max_frequency_is_taken_as_it_is(self, part_file: Path) -> None:
        assert read(part_file, changed("count = 20", "max_frequency = 2e3")).modes.max_frequency == 2e3

    @pytest.mark.parametrize(
        ("form", "key", "expected"),
        [
            ("beta = 1e-6", "beta", 1e-6),
            ("ratio = 1.5", "ratio", 1.5),
            ("ratios = [[10, 0.02], [500.0, 0]]", "ratios", ((10.0, 0.02), (500.0, 0.0))),
        ],
    )
    def test_forms_of_damping(self, part_file: Path, form: str, key: str, expected: object) -> None:
        part = read(part_file, changed("alpha = 1.0\nbeta = 1e-6", form))
        assert getattr(part.damping, key) == expected

    def test_several_materials(self, part_file: Path) -> None:
        text = BEAM.replace("[[support]]", SECOND_MATERIAL + 'cells = "pad"\n[[support]]')
        assert [m.cells for m in read(part_file, text).materials] == [None, "pad"]

    def test_a_folder_a_byte_order_mark_and_windows_lines(self, part_file: Path) -> None:
        text = changed("[part]", '[part]\ndescription = "Stahlträger, 2 µm"').replace("\n", "\r\n")
        part_file.write_bytes(b"\xef\xbb\xbf" + text.encode())
        assert read_part(part_file.parent) == read_part(part_file)
        assert read_part(part_file).description == "Stahlträger, 2 µm"

    def test_paths_are_absolute_from_a_relative_one(
        self, part_file: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        part_file.write_text(BEAM)
        monkeypatch.chdir(part_file.parent)
        part = read_part(Path("part.toml"))
        assert part.mesh == part_file.parent / "beam.msh"
        assert part.source == part_file

    def test_units_are_those_that_the_mesh_reader_knows(self) -> None:
        assert set(get_args(LengthUnit)) == set(UNITS)

    def test_parts_are_frozen(self, part_file: Path) -> None:
        part = read(part_file, BEAM)
        with pytest.raises(AttributeError):
            part.name = "other"  # type: ignore[misc]  # the mistake under test
        with pytest.raises(ValueError, match="frozen"):
            part.materials[0].young = 1.0  # type: ignore[misc]  # the mistake under test


MISTAKES = [  # what is replaced, by what, the beginning of the line, something else in it
    ("young = 210e9\n", "", "material[1].young: missing, expected Young's modulus in Pa", "young = 210e9"),
    ("[part]", "[part]\nunit = 1", "part.unit: unknown key", "did you mean length_unit?"),
    (
        "[modes]",
        '[modes]\n"a b" = 1',
        'modes."a b": unknown key',
        "count, max_frequency, step, error, band, residual, initial",
    ),
    ("210e9", '"210e9"', 'material[1].young: got "210e9", expected', "; remove the quotes"),
    (
        "210e9",
        "true",
        "material[1].young: got true, expected",
        "a finite number > 0 (1e-3 to 1e18); write e.g. young = ",
    ),
    ("210e9", "0", "material[1].young: got 0, expected", "> 0"),
    ("210e9", "nan", "material[1].young: got NaN, expected", "finite"),
    ("210e9", "1e999", "material[1].young: got Infinity, expected", "finite"),
    ("210e9", "1979-05-27", 'material[1].young: got "1979-05-27", expected', "> 0"),
    ("7850", "-7850", "material[1].density: got -7850, expected the density in kg/m³", "> 0"),
    ("0.3", "0.5", "material[1].poisson: got 0.5, expected Poisson's ratio", "-1 < ν < 0.5"),
    ("0.3", "-1", "material[1].poisson: got -1, expected Poisson's ratio", "-1 < ν < 0.5"),
    ('"steel"', "7", "material[1].name: got 7, expected a name", 'name = "steel"'),
    ("[[material]]", "[material]", 'material: got {"name": "steel"', "[[material]] (two brackets)"),
    ("[[support]]", SECOND_MATERIAL + "[[support]]", "material[2].cells: missing", "in material[1]"),
    (
        "[[support]]",
        SECOND_MATERIAL.replace("rubber", "steel") + 'cells = "pad"\n[[support]]',
        'material[2].name: got "steel", the name of material[1] too',
        "rename",
    ),
    ("[part]", "[[part]]", "part: got [{", "one table [part]"),
    ('"cantilever"', '"2beams"', 'part.name: got "2beams", expected a C identifier', "no digit first"),
    ('"cantilever"', '"beam\\n"', 'part.name: got "beam\\n", expected a C identifier', ""),
    ('"beam.msh"', '""', 'part.mesh: got "", expected the path of a mesh file', "relative to the part file"),
    ('"beam.msh"', '"sub\\beam.msh"', 'part.mesh: got "sub\\beam.msh", expected', "with / between folders"),
    ('"mm"', '"km"', 'part.length_unit: got "km", expected', "m, mm, cm, um, in or ft"),
    ('["x", "y", "z"]', "[]", "support[1].fix: got [], expected", "one or more"),
    ('["x", "y", "z"]', '["x", "x"]', 'support[1].fix: got ["x", "x"], expected', "none twice"),
    ('["x", "y", "z"]', '["x", "w"]', 'support[1].fix[2]: got "w", expected', '"x", "y", "z"'),
    ('"clamp"', '" "', "support[1].at: got an empty name", 'at = "clamp"'),
    ('"clamp"', "7", "support[1].at: got 7, expected the name of a set", "point, box, plane, nodes"),
    ('"clamp"', "{}", "support[1].at: got none, expected exactly one of point, box", "add one"),
    ('"clamp"', "{ point = [0, 0, 0], nodes = [1] }", "support[1].at: got nodes and point", "remove"),
    ('"clamp"', '{ name = "clamp" }', "support[1].at.name: unknown key", "point, box, plane, nodes"),
    ('"clamp"', "{ point = [0, 0] }", "support[1].at.point[3]: missing", "three finite coordinates"),
    ('"clamp"', "{ point = [0, 0, 0, 0] }", "support[1].at.point: got [0, 0, 0, 0]", "three"),
    ('"clamp"', "{ point = [0, inf, 0] }", "support[1].at.point[2]: got Infinity", "finite"),
    ('"clamp"', "{ box = [[0, 0, 1], [1, 1, 0]] }", "support[1].at.box: got [[0, 0, 1], [1", "above"),
    ('"clamp"', "{ nodes = [] }", "support[1].at.nodes: got []", "one or more"),
    ('"clamp"', "{ nodes = [3, -1] }", "support[1].at.nodes[2]: got -1", "integers ≥ 0"),
    ('"clamp"', "{ nodes = [1.0] }", "support[1].at.nodes[1]: got 1.0", "integers ≥ 0"),
    ('"clamp"', '{ plane = { normal = "n", at = 0 } }', 'support[1].at.plane.normal: got "n"', "x, y or z"),
    ('"clamp"', '{ plane = { normal = "x" } }', "support[1].at.plane.at: missing", "at = 0.0"),
    ('"tip"', '"modes"', 'port[1].name: got "modes", expected', "other than modes, damping, energy"),
    ('"tip"', '"tip end"', 'port[1].name: got "tip end", expected a C identifier', ""),
    (
        "[modes]",
        BEAM[BEAM.index("[[port]]") : BEAM.index("[modes]")] + "[modes]",
        'port[2].name: got "tip", the name of port[1] too',
        "rename",
    ),
    ('"force.y"', '"froce.x"', 'port[1].inputs[1]: got "froce.x"', "did you mean force.x?"),
    ('"force.y"', '"pressure.x"', 'port[1].inputs[1]: got "pressure.x"', "and pressure, none twice"),
    ('"force.y"', '"force.z"', 'port[1].inputs: got ["force.z", "force.z"]', "none twice"),
    ('["force.y", "force.z"]', '"force.z"', 'port[1].inputs: got "force.z"', "a list of"),
    ('"displacement.y"', '"stress.yx"', 'port[1].outputs[1]: got "stress.yx"', "displacement, velocity,"),
    ('"displacement.y"', '"stress.Mises"', 'port[1].outputs[1]: got "str', "did you mean stress.mises?"),
    (
        '"displacement.y"',
        '"reaction.y"',
        'port[1].outputs[1]: got "reaction.y" without the',
        'add "motion.y" to inputs',
    ),
    (
        '"displacement.y"',
        '"reaction_moment.x"',
        'port[1].outputs[1]: got "reaction_moment.x" without the input "angular_motion.x"',
        "expected both",
    ),
    ('"force.y"', '"motion.z"', 'port[1].inputs[2]: got "force.z" beside "motion.z"', "remove one"),
    (
        '"force.y", "force.z"',
        '"angular_motion.x", "moment.y", "moment.x"',
        'port[1].inputs[3]: got "moment.x" beside "angular_motion.x"',
        "expected one of the two",
    ),
    (
        '"force.y", "force.z"]',
        '"motion.y"]\n[basis]\nkind = "polynomial"\norder = 2\n[[port]]\nname = "a"\nat = "b"\ninputs = []',
        'basis.kind: got "polynomial" with the input "tip.motion.y"',
        '"craig-bampton"',
    ),
    (
        'inputs = ["force.y", "force.z"]\noutputs = ["displacement.y", "acceleration.z"]',
        "inputs = []",
        "port[1]: got neither inputs nor outputs",
        "expected at least one",
    ),
    ("[modes]", 'weights = "mass"\n[modes]', 'port[1].weights: got "mass"', '"area" or "equal"'),
    ("[modes]\ncount = 20", "", "modes: got none, expected exactly one of count, max_freq", "[modes], count"),
    ("count = 20", "", "modes: got none, expected exactly one of count, max_frequency, step", "add one"),
    ("count = 20", "count = 20\nstep = 1", "modes: got count and step, expected exactly one", "remove"),
    ("count = 20", "count = 0", "modes.count: got 0", "≥ 1"),
    ("count = 20", "count = 20.0", "modes.count: got 20.0", "whole number"),
    ("count = 20", "count = true", "modes.count: got true", "whole number"),
    ("count = 20", "step = 0", "modes.step: got 0", "> 0 in s"),
    ("count = 20", "max_frequency = -1", "modes.max_frequency: got -1", "> 0 in Hz"),
    ("count = 20", 'count = 20\ninitial = "zero"', 'modes.initial: got "zero"', '"rest" or "static"'),
    ("beta = 1e-6", "ratio = 0.02", "damping: got alpha and ratio, expected exactly one", "remove"),
    ("alpha = 1.0\nbeta = 1e-6", "", "damping: got none, expected exactly one of alpha", "add one"),
    ("alpha = 1.0", "alpha = -1.0", "damping.alpha: got -1.0", "≥ 0 in 1/s"),
    ("alpha = 1.0\nbeta = 1e-6", "ratio = -0.1", "damping.ratio: got -0.1", "≥ 0"),
    ("alpha = 1.0\nbeta = 1e-6", "ratios = [[1, 0.1]]", "damping.ratios: got [[1, 0.1]]", "two or more"),
    (
        "alpha = 1.0\nbeta = 1e-6",
        "ratios = [[1, 0.1], [1.0, 0.2]]",
        "damping.ratios: got",
        "no frequency twice",
    ),
    ("alpha = 1.0\nbeta = 1e-6", "ratios = [[1, 0.1], [0, 0.2]]", "damping.ratios[2][1]: got 0", "each > 0"),
    ("alpha = 1.0\nbeta = 1e-6", "ratios = [[1, 0.1], [2]]", "damping.ratios[2][2]: missing", "pairs"),
    (
        "[modes]",
        "[mode]\n[modes]",
        "mode: unknown key, expected one of part, material, system",
        "mean modes?",
    ),
    ("210e9", "210 e9", "line 8, column 13: got 'young = 210 e9'", "mend that line"),
    ("1e-6", '"""', "line 24: got the end of the file", "mend that line"),
    ("1e-6", "[" * 9000, "got brackets nested too deeply", "remove"),
    ("1e-6", "1" + 5000 * "0", "got an integer of thousands of digits", "shorten"),
    ("1e-6", "0x1" + 5000 * "0", "damping.beta: got a value too large to show", "≥ 0"),
    ("count =", ".".join(["count"] * 9000) + " =", "modes.count: got a value too large to show", "≥ 1"),
    ("beta = 1e-6", ".".join(["b"] * 9000) + "=1", "damping.b: unknown key", "did you mean beta?"),
]


class TestMistakes:
    @pytest.mark.parametrize(("old", "new", "begin", "within"), MISTAKES)
    def test_is_told_in_one_line(self, part_file: Path, old: str, new: str, begin: str, within: str) -> None:
        part_file.write_text(changed(old, new))
        line = told(part_file)
        assert line.startswith(begin)
        assert within in line
        assert not line.endswith("more)")  # one change, one mistake

    def test_a_misspelt_key_is_told_before_the_one_that_it_leaves_missing(self, part_file: Path) -> None:
        part_file.write_text(changed("young", "yuong"))
        line = told(part_file)
        assert line.startswith("material[1].yuong: unknown key, expected one of name, young, poisson")
        assert line.endswith("did you mean young? (and 1 more)")

    def test_the_number_of_further_mistakes(self, part_file: Path) -> None:
        part_file.write_text(changed("210e9", "0").replace("count = 20", "count = -1"))
        assert told(part_file).endswith("(and 1 more)")

    def test_an_empty_file_lacks_every_table(self, part_file: Path) -> None:
        part_file.write_bytes(b"")
        line = told(part_file)
        assert line.startswith("part: missing, expected one table [part]")
        assert line.endswith('name = "cantilever"')  # what else is needed depends on the tables there are

    def test_other_encodings(self, part_file: Path) -> None:
        part_file.write_bytes(changed("[part]", "[part]\n# Stahlträger").encode("latin-1"))
        assert told(part_file) == "line 3: got byte 0xe4, expected UTF-8; save the file as UTF-8"
        part_file.write_bytes(BEAM.encode("utf-16"))
        assert "save the file as UTF-8" in told(part_file)

    def test_paths_that_hold_no_part(self, tmp_path: Path) -> None:
        assert told(tmp_path).startswith("got a folder without part.toml")
        assert "expected a part file or its folder" in told(tmp_path / "nowhere.toml")
        assert told(tmp_path / ("long" * 100)).startswith("cannot be read")
        assert told(tmp_path / "nul\0.toml").startswith("cannot be read")


unhurried = settings(deadline=None)  # a busy disk is no fault
text = st.text(st.characters(exclude_categories=["Cs"]), max_size=8)
numbers = st.booleans() | st.integers() | st.floats()
scalars = numbers | text | st.sampled_from(["x", "force.x", "210e9", "modes"])
junk = st.recursive(
    scalars,
    lambda inner: (
        st.lists(inner, max_size=4) | st.dictionaries(st.from_regex(r"[a-z]{1,6}", fullmatch=True), inner)
    ),
    max_leaves=6,
)
KEYS = ["name", "mesh", "young", "poisson", "at", "fix", "inputs", "outputs", "count", "alpha"]


def is_number(value: object) -> bool:
    """Whether `value` is no bool and, as a float, finite."""
    try:
        return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
    except OverflowError:  # an integer beyond every float
        return False


class TestJunk:
    @unhurried
    @given(key=st.sampled_from(KEYS), value=junk)
    def test_any_value_anywhere_is_read_or_told(self, part_file: Path, key: str, value: object) -> None:
        begin = BEAM.index(f"{key} = ") + len(f"{key} = ")
        part_file.write_text(BEAM[:begin] + toml(value) + BEAM[BEAM.index("\n", begin) :], encoding="utf-8")
        try:
            part = read_part(part_file)
        except PartError as error:
            (line,) = str(error).splitlines()
            assert key in line.removeprefix(str(part_file))
        else:
            assert isinstance(part, Part)

    @pytest.mark.parametrize(
        ("old", "legal"),
        [
            ("210e9", lambda x: 1e-3 <= x <= 1e18),
            ("0.3", lambda x: -1 < x < 0.5),
            ("7850", lambda x: 1e-9 <= x <= 1e9),
            ("1.0", lambda x: True),
            ("20", lambda x: isinstance(x, int) and x >= 1),
            ("1e-6", lambda x: x >= 0),
        ],
    )
    @unhurried
    @given(value=junk | numbers | st.floats(-1, 1))
    def test_numbers_are_taken_exactly_if_legal(
        self, part_file: Path, old: str, legal: Callable[[float], bool], value: Any
    ) -> None:
        begin = BEAM.index(f" {old}" if old != "1.0" else "1.0")  # "1.0": a coordinate
        rest = BEAM[begin:].lstrip().removeprefix(old)
        part_file.write_text(f"{BEAM[:begin]} {toml(value)}{rest}", encoding="utf-8")
        if is_number(value) and legal(value):
            assert isinstance(read_part(part_file), Part)
        else:
            assert told(part_file)

    @unhurried
    @given(content=st.binary(max_size=60) | st.text(max_size=60).map(lambda s: s.encode("utf-8", "replace")))
    def test_any_bytes_are_told(self, part_file: Path, content: bytes) -> None:
        part_file.write_bytes(content)
        assert told(part_file)

    @unhurried
    @given(cut=st.integers(0, BEAM.index("count = 2") + len("count = ")))
    def test_a_file_cut_before_its_last_required_key_is_told(self, part_file: Path, cut: int) -> None:
        part_file.write_text(BEAM[:cut])
        assert told(part_file)


def test_step_choice_is_finite_over_its_range(part_file: Path) -> None:
    for step in ("1e-12", "1e9"):
        limit = read(part_file, changed("count = 20", f"step = {step}")).modes.max_frequency
        assert limit is not None
        assert math.isclose(limit, 0.5 / float(step), rel_tol=1e-15)  # one division
