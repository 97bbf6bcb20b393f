"""Mistakes in the tables beyond a mesh with forces, and between tables: each told in one line."""

from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from part_files import BEAM, FULL, MATRICES, full, read, told, toml

from precompute.errors import PartError
from precompute.part import Part, read_part

MATERIAL = FULL[FULL.index("[[material]]") : FULL.index("[[support]]")]


@pytest.fixture(scope="module")
def part_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("frame") / "part.toml"


def check(part_file: Path, text: str, begin: str, within: str) -> None:
    part_file.write_text(text)
    line = told(part_file)
    assert line.startswith(begin)
    assert within in line
    assert not line.endswith("more)")  # one change, one mistake


IN_FULL = [  # what is replaced, by what, the beginning of the line, something else in it
    # values
    ("alpha = 0.5", "alpha = -1", "material[1].alpha: got -1, expected", "mass-proportional"),
    ("beta = 1e-5", "beta = inf", "material[1].beta: got Infinity, expected", "finite number ≥ 0 in s"),
    ('"clamp"', '"base"', 'support[1].name: got "base", expected a C identifier', "other than modes"),
    ('"gap"', '"time"', 'pair[1].name: got "time", expected a C identifier', "other than modes"),
    (
        '["reaction.x"]',
        '["reaction.rx"]',
        'support[1].outputs[1]: got "reaction.rx"',
        "reaction.x, reaction.y",
    ),
    ('["x", "y", "z"]', '["y"]', 'support[1].outputs[1]: got "reaction.x", expected', 'or add "x" to fix'),
    ('["x", "y", "z"]', '["x", "ry"]', 'support[1].fix[2]: got "ry" without [system]', "several nodes"),
    ('name = "clamp"\n', "", "support[1].name: missing, outputs need it", 'write e.g. name = "clamp"'),
    ('kind = "rigid"', 'kind = "stiff"', 'port[2].kind: got "stiff", expected', '"average" or "rigid"'),
    (
        'kind = "rigid"',
        'kind = "rigid"\nweights = "area"',
        'port[2].weights: got "area" at a rigid',
        'remove it, or write kind = "average"',
    ),
    (
        'at = "end"',
        'at = "end"\nkind = "rigid"',
        'port[1].outputs[3]: got "stress.mises" at a rigid',
        "deform",
    ),
    ('["tip", "flange"]', '["tip"]', "pair[1].ports[2]: missing, expected the names of two", "b minus a"),
    ('["tip", "flange"]', '["tip", "tip"]', 'pair[1].ports: got ["tip", "tip"], expected', "different"),
    ('["angular_velocity.x"]', "[]", "pair[1].outputs: got [], expected", "one or more of displacement"),
    (
        '["angular_velocity.x"]',
        '["absolute_acceleration.x"]',
        'pair[1].outputs[1]: got "absolute_acceleration.x", expected',
        "did you mean acceleration.x?",
    ),
    ("gravity = true", "gravity = 1", "loads.gravity: got 1, expected true or false", "gravity = true"),
    (
        "gravity = true",
        "gravity = [0, 0, -9.81]",
        "loads.gravity: got [0, 0, -9.81], expected true",
        "gravity",
    ),
    ('["x", "y"]', "[]", "loads.base: got [], expected", "one to three"),
    ('["x", "y"]', '["rx"]', 'loads.base[1]: got "rx", expected', '"x", "y", "z"'),
    ('"rx"', '"xx"', 'spring[1].direction: got "xx", expected "x", "y" or "z"', '"rx", "ry" or "rz"'),
    ("stiffness = 1e6", "stiffness = 0", "spring[1].stiffness: got 0, expected", "N/m (N.m/rad for rot"),
    (
        "stiffness = 1e6",
        "stiffness = 1\nmass = 1",
        "spring[1].mass: unknown key, expected one of port",
        "to,",
    ),
    ("damping = 300", "damping = -300", "dashpot[1].damping: got -300, expected", "N.s/m (N.m.s/rad"),
    ("damping = 300", "damping = 1e19", "dashpot[1].damping: got 1e+19, expected", "(1e-12 to 1e18)"),
    ("mass = 2.5", 'mass = "2.5"', 'mass[1].mass: got "2.5", expected the mass in kg', "remove the quotes"),
    ("[[mass]]", "[mass]", 'mass: got {"port": "flange"', "[[mass]] (two brackets)"),
    ("[loads]", "[[loads]]", "loads: got [{", "one table [loads]"),
    ('["kinetic", "strain"]', '["potential"]', 'energy.outputs[1]: got "potential"', '"kinetic", "strain"'),
    ("error = 0.02", "error = 2", "modes.error: got 2, expected", "between 0 and 1 (1 % is 0.01)"),
    ("error = 0.02", "", "modes.band: got [0.0, 500.0] without error, expected both", "error = 0.01"),
    (
        "error = 0.02",
        "count = 7",
        "modes.band: got [0.0, 500.0] without error, expected both",
        "error = 0.01",
    ),
    ("error = 0.02", "error = 0.02\nstep = 1", "modes: got step and error, expected exactly one", "remove"),
    ("band = [0, 500]", "", "modes.band: missing beside error, expected two frequencies", "[0.0, 500.0]"),
    ("band = [0, 500]", "band = [5, 5]", "modes.band: got [5, 5], expected two freq", "lowest < highest"),
    ("band = [0, 500]", "band = [-1, 5]", "modes.band[1]: got -1, expected two freq", "0 ≤ lowest"),
    ("band = [0, 500]", "band = 500", "modes.band: got 500, expected two frequencies", "[lowest, highest]"),
    ("[modes]", '[modes]\nresidual = "yes"', 'modes.residual: got "yes", expected', 'true, false or "modes"'),
    ("[modes]", "[modes]\nresidual = 1", "modes.residual: got 1, expected", 'true, false or "modes"'),
    ("tolerance = 0.03", "tolerance = 0", "accuracy.tolerance: got 0, expected", "between 0 and 1"),
    ("band = [10, 400]", "band = [400, 10]", "accuracy.band: got [400, 10], expected", "lowest < highest"),
    # bases
    ('"modal"', '"ritz"', 'basis.kind: got "ritz", expected "modal", "polynomial"', '"file"'),
    (
        'kind = "modal"',
        'kind = "modal"\norder = 2',
        'basis.order: got 2 with kind = "modal", expected it with kind = "polynomial" alone',
        'remove it, or write kind = "polynomial"',
    ),
    (
        'kind = "modal"',
        "frequency = 3",
        'basis.frequency: got 3.0 with kind = "modal", expected it with kind = "krylov" alone',
        "remove it",
    ),
    ('kind = "modal"', 'kind = "krylov"\nfile = "U.npy"', "basis.file: got", 'kind = "file" alone'),
    ('kind = "modal"', 'kind = "krylov"\nfrequency = -1', "basis.frequency: got -1, expected the fr", "≥ 0"),
    (
        'kind = "modal"',
        'kind = "polynomial"',
        'basis.order: missing, kind = "polynomial" needs it',
        "order = 2",
    ),
    (
        'kind = "modal"',
        'kind = "polynomial"\norder = 3',
        "basis.order: got 3, expected the order",
        "1 (linear",
    ),
    ('kind = "modal"', 'kind = "polynomial"\norder = true', "basis.order: got true, expected", "0 (rigid)"),
    ('kind = "modal"', 'kind = "file"', 'basis.file: missing, kind = "file" needs it', 'file = "U.npy"'),
    ('kind = "modal"', 'kind = "file"\nfile = 3', "basis.file: got 3, expected the path of a .npy", "column"),
    (
        'kind = "modal"',
        'kind = "krylov"',
        'modes: got error, expected count with [basis] kind = "krylov"',
        "replace it",
    ),
    # damping
    ("alpha = 1.0", "table = []", "damping.table: got [], expected one or more pairs", "[[1, 0.02]"),
    ("alpha = 1.0", "table = [[0, 0.1]]", "damping.table[1][1]: got 0, expected", "number of the mode ≥ 1"),
    ("alpha = 1.0", "table = [[1.5, 0.1]]", "damping.table[1][1]: got 1.5, expected", "number of the mode"),
    ("alpha = 1.0", "table = [[1, -0.1]]", "damping.table[1][2]: got -0.1, expected", "damping ratio ≥ 0"),
    ("alpha = 1.0", "table = [[1, 0.1], [1, 0.1]]", "damping.table: got [[1, 0.1], [1,", "no mode twice"),
    ("alpha = 1.0", "structural = -1", "damping.structural: got -1, expected a loss factor ≥ 0", "twice"),
    (
        "alpha = 1.0",
        "structural = 0.1\ntable = [[1, 0.1]]",
        "damping: got table and structural, expected exactly one of alpha with beta, ratio, ratios, table",
        "remove the others",
    ),
    (
        "alpha = 1.0",
        "ratio = 0.1",
        "material[1].alpha: got 0.5 beside damping.ratio, expected one of the two",
        "remove one",
    ),
    # between tables
    (
        "[[support]]",
        '[system]\nstiffness = "K.mtx"\nmass = "M.mtx"\n[[support]]',
        "material: got materials beside [system], expected one of the two",
        "remove [[material]] or [system]",
    ),
    ('mesh = "frame.msh"', "", "part.mesh: missing, expected the path of a mesh", "(or a table [system])"),
    ('length_unit = "mm"', "", "part.length_unit: missing, expected the unit", 'length_unit = "m"'),
    (MATERIAL, "", "material: missing, expected one table [[material]] (two br", 'name = "steel"'),
    ('"gap"', '"tip"', 'pair[1].name: got "tip", the name of port[1] too, expected a new one', "rename"),
    ('"clamp"', '"gap"', 'support[1].name: got "gap", the name of pair[1] too, expected a new one', "rename"),
    ('["tip", "flange"]', '["tip", "range"]', 'pair[1].ports[2]: got "range"', "did you mean flange?"),
    ('port = "tip"\ndirection', 'port = "top"\ndirection', 'spring[1].port: got "top"', "did you mean tip?"),
    ('to = "flange"', 'to = "flage"', 'dashpot[1].to: got "flage", expected the name', "mean flange?"),
    ('to = "flange"', 'to = "tip"', 'dashpot[1].to: got "tip", the same as port', "for the ground"),
    ('port = "flange"', 'port = "gap"', 'mass[1].port: got "gap", expected the name of a', "[[port]]"),
    (
        'base = ["x", "y"]',
        "",
        'port[1].outputs[2]: got "absolute_acceleration.y" but no base in [loads], expected both',
        'write acceleration.y, or add [loads], base = ["y"]',
    ),
]
IN_MATRICES = [
    ('mass = "M.mtx"', "", "system.mass: missing, expected the path of a matrix file", 'mass = "M.mtx"'),
    ('"data/K.mtx"', '""', 'system.stiffness: got "", expected the path of a matrix file', "relative"),
    ('"dofs.csv"', "3", "system.dofs: got 3, expected the path of a file that tells node", "dofs.csv"),
    ('length = "mm"', 'length = "km"', 'system.units.length: got "km", expected m, mm, cm', 'length = "mm"'),
    ('mass = "t"', 'mass = "to"', 'system.units.mass: got "to", expected kg, t, g', "slinch"),
    ('mass = "t"', 'force = "N"', "system.units.force: unknown key, expected one of length, mass", "time"),
    ('"force.x"', '"pressure"', 'port[1].inputs[1]: got "pressure" with [system], expected', "mesh with mat"),
    ('"displacement.x"', '"stress.xx"', 'port[1].outputs[1]: got "stress.xx" with [system]', "mesh with mat"),
    ("[system]", 'mesh = "chain.msh"\n[system]', "part.length_unit: missing, expected the unit", "mm"),
]


@pytest.mark.parametrize(("old", "new", "begin", "within"), IN_FULL)
def test_mistake_is_told_in_one_line(part_file: Path, old: str, new: str, begin: str, within: str) -> None:
    check(part_file, full(old, new), begin, within)


@pytest.mark.parametrize(("old", "new", "begin", "within"), IN_MATRICES)
def test_mistake_with_matrices(part_file: Path, old: str, new: str, begin: str, within: str) -> None:
    assert MATRICES.count(old) == 1
    check(part_file, MATRICES.replace(old, new), begin, within)


@pytest.mark.parametrize("count", ["polynomial\norder = 1", "krylov", "modal"])
def test_no_mode_at_all(part_file: Path, count: str) -> None:
    kind, *order = count.split("\n")
    keys = "\n".join([f'kind = "{kind}"', *order])
    text = BEAM.replace("[modes]\ncount = 20", f"[basis]\n{keys}\n[modes]\ncount = 0")
    check(part_file, text, "modes.count: got 0, expected a whole number of modes ≥ 1", "count = 20")


def test_two_supports_may_be_nameless_and_hold_the_same(part_file: Path) -> None:
    support = '[[support]]\nat = "clamp"\nfix = ["x"]\n'
    assert [s.name for s in read(part_file, BEAM + 2 * support).supports] == [None] * 3


@pytest.mark.parametrize(
    "use",
    [
        '[[spring]]\nport = "eye"\ndirection = "x"\nstiffness = 1.0',
        '[[dashpot]]\nport = "tip"\nto = "eye"\ndirection = "x"\ndamping = 1.0',
        '[[mass]]\nport = "eye"\nmass = 1.0',
        '[[pair]]\nname = "gap"\nports = ["eye", "tip"]\noutputs = ["displacement.x"]',
    ],
)
def test_a_port_may_be_there_for_another_table(part_file: Path, use: str) -> None:
    idle = BEAM + '[[port]]\nname = "eye"\nat = "hole"\n'
    check(part_file, idle, "port[2]: got neither inputs nor outputs, nor a pair,", "at least one of them")
    assert read(part_file, idle + use).ports[1].name == "eye"


KEYS = sorted({line.split(" = ")[0] for line in (FULL + MATRICES).splitlines() if " = " in line})
VALUES = st.recursive(
    st.booleans()
    | st.integers(-3, 3)
    | st.floats()
    | st.sampled_from(["x", "rx", "tip", "flange", "modes", "rigid", "krylov", "stress.xx", "pressure", ""]),
    lambda inner: (
        st.lists(inner, max_size=3) | st.dictionaries(st.sampled_from(["nodes", "length"]), inner, max_size=1)
    ),
    max_leaves=4,
)


@settings(deadline=None)  # a busy disk is no fault
@given(
    text=st.sampled_from([FULL, MATRICES]), key=st.sampled_from(KEYS), value=VALUES, which=st.integers(0, 3)
)
def test_any_value_anywhere_is_read_or_told(
    part_file: Path, text: str, key: str, value: object, which: int
) -> None:
    lines = text.splitlines()
    places = [k for k, line in enumerate(lines) if line.startswith(f"{key} = ")]
    for place in places[which : which + 1]:
        lines[place] = f"{key} = {toml(value)}"
    part_file.write_text("\n".join(lines))
    try:
        assert isinstance(read_part(part_file), Part)
    except PartError as error:
        (line,) = str(error).splitlines()
        assert line.startswith(f"{part_file}: ")
