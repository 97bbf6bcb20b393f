"""The part file beyond a mesh with forces: matrices, bases, damping, loads, measurements, accuracy."""

from itertools import product
from pathlib import Path

import pytest
from part_files import BEAM, FULL, MATRICES, changed, full, read, told

from fmu_src.runtime.kinds import ORDINARY_INPUTS, ORDINARY_OUTPUTS, outputs_of
from precompute.load_tables import Dashpot, Mass, Spring
from precompute.mode_tables import Accuracy
from precompute.selection import NamedSet, Nodes

BASES = {
    "modal": 'kind = "modal"',
    "polynomial": 'kind = "polynomial"\norder = 1',
    "craig-bampton": 'kind = "craig-bampton"',
    "krylov": 'kind = "krylov"\nfrequency = 30',
    "file": 'kind = "file"\nfile = "U.npy"',
}
FORMS = {
    "none": "",
    "count": "count = 3",
    "max_frequency": "max_frequency = 50",
    "step": "step = 1e-3",
    "error": "error = 0.01\nband = [0, 500]",
}
LOWEST = {"count", "max_frequency", "step"}
ALLOWED = {
    "modal": {*LOWEST, "error"},
    "polynomial": {*LOWEST, "none"},
    "craig-bampton": LOWEST,
    "krylov": {"count"},
    "file": {*LOWEST, "none"},
}


@pytest.fixture(scope="module")
def part_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("frame") / "part.toml"


def test_every_table_is_found_under_its_name(part_file: Path) -> None:
    part = read(part_file, FULL)
    (steel,) = part.materials
    assert (steel.alpha, steel.beta) == (0.5, 1e-5)
    (clamp,) = part.supports
    assert (clamp.name, clamp.at, clamp.outputs) == ("clamp", NamedSet("bolts"), ("reaction.x",))
    tip, flange = part.ports
    assert (tip.kind, tip.inputs) == ("average", ("moment.x", "pressure"))
    assert tip.outputs == ("rotation.z", "absolute_acceleration.y", "stress.mises")
    assert (flange.kind, flange.inputs, flange.outputs) == ("rigid", (), ())
    (gap,) = part.pairs
    assert (gap.name, gap.ports, gap.outputs) == ("gap", ("tip", "flange"), ("angular_velocity.x",))
    assert (part.loads.gravity, part.loads.base) == (True, ("x", "y"))
    assert part.springs == (Spring(port="tip", direction="rx", stiffness=1e6),)
    assert part.springs[0].to is None
    assert part.dashpots == (Dashpot(port="tip", to="flange", direction="z", damping=300.0),)
    assert part.masses == (Mass(port="flange", mass=2.5),)
    assert part.energy.outputs == ("kinetic", "strain")
    assert part.basis.kind == "modal"
    assert (part.modes.error, part.modes.band) == (0.02, (0.0, 500.0))
    assert (part.damping.alpha, part.damping.beta) == (1.0, 0.0)
    assert part.accuracy == Accuracy(band=(10.0, 400.0), tolerance=0.03)


def test_matrices_in_place_of_a_mesh(part_file: Path) -> None:
    part = read(part_file, MATRICES)
    folder = part_file.parent
    assert part.system is not None
    assert (part.system.stiffness, part.system.mass) == (folder / "data/K.mtx", folder / "M.mtx")
    assert (part.system.damping, part.system.dofs) == (None, folder / "dofs.csv")
    units = part.system.units
    assert (units.length, units.mass, units.time) == ("mm", "t", "s")
    assert (part.mesh, part.materials, part.length_unit) == (None, (), "mm")
    assert part.supports[0].fix == ("x", "rx")
    assert part.supports[0].at == Nodes((1,))


def test_units_of_matrices_are_si_where_nothing_is_said(part_file: Path) -> None:
    part = read(part_file, MATRICES.replace('units = { length = "mm", mass = "t" }', ""))
    assert part.system is not None
    units = part.system.units
    assert (units.length, units.mass, units.time, part.length_unit) == ("m", "kg", "s", "m")


def test_a_mesh_beside_matrices_has_its_own_unit(part_file: Path) -> None:
    text = MATRICES.replace("[system]", 'mesh = "/meshes/beam.msh"\nlength_unit = "in"\n[system]')
    part = read(part_file, text)
    assert part.mesh == Path("/meshes/beam.msh")  # an absolute path stays as it is
    assert part.length_unit == "in"
    assert part.system is not None
    assert part.system.units.length == "mm"


@pytest.mark.parametrize(("basis", "form"), list(product(BASES, FORMS)))
def test_how_each_basis_may_be_chosen_from(part_file: Path, basis: str, form: str) -> None:
    text = changed("[modes]\ncount = 20", f"[basis]\n{BASES[basis]}\n[modes]\n{FORMS[form]}")
    if form in ALLOWED[basis]:
        part = read(part_file, text)
        assert part.basis.kind == basis
        assert part.modes.form == (None if form == "none" else form)
    else:
        part_file.write_text(text)
        assert told(part_file).startswith(f"modes: got {form}, expected ")


def test_keys_of_each_basis(part_file: Path) -> None:
    def basis_of(kind: str) -> tuple[int | None, float, Path | None]:
        basis = read(part_file, changed("[modes]", f"[basis]\n{BASES[kind]}\n[modes]")).basis
        return basis.order, basis.frequency, basis.file

    assert basis_of("polynomial") == (1, 0.0, None)
    assert basis_of("krylov") == (None, 30.0, None)
    assert basis_of("file") == (None, 0.0, part_file.parent / "U.npy")


def test_constraint_modes_alone(part_file: Path) -> None:
    text = changed("count = 20", "count = 0").replace("[modes]", '[basis]\nkind = "craig-bampton"\n[modes]')
    assert read(part_file, text).modes.count == 0


@pytest.mark.parametrize(
    ("keys", "expected"),
    [
        ("count = 5", False),
        ("count = 5\nresidual = true", True),
        ('count = 5\nresidual = "modes"', "modes"),
        ("error = 0.1\nband = [0, 1]", "modes"),  # the smallest model has them, unless the user will not
        ("error = 0.1\nband = [0, 1]\nresidual = false", False),
        ("error = 0.1\nband = [0, 1]\nresidual = true", True),
    ],
)
def test_residual(part_file: Path, keys: str, expected: object) -> None:
    residual = read(part_file, changed("count = 20", keys)).modes.residual
    assert residual == expected
    assert type(residual) is type(expected)


@pytest.mark.parametrize(
    ("form", "key", "expected"),
    [
        ("table = [[2, 0.02], [1, 0]]", "table", ((2, 0.02), (1, 0.0))),
        ("structural = 0.01", "structural", 0.01),
        ("structural = 0", "structural", 0.0),
    ],
)
def test_forms_of_damping(part_file: Path, form: str, key: str, expected: object) -> None:
    damping = read(part_file, changed("alpha = 1.0\nbeta = 1e-6", form)).damping
    assert getattr(damping, key) == expected
    assert damping.other_form == key


def test_accuracy_by_its_defaults(part_file: Path) -> None:
    assert read(part_file, BEAM + "[accuracy]\n").accuracy == Accuracy(band=None, tolerance=0.01)


def test_every_input_and_output_of_a_port(part_file: Path) -> None:
    """It is pushed or moved in a direction, and reacts where it is moved."""
    tip = FULL[FULL.index('inputs = ["moment.x"') : FULL.index('\n[[port]]\nname = "flange"')]
    moving = [name for name in ORDINARY_INPUTS if "motion" in name]
    pushing = [name for name in ORDINARY_INPUTS if name not in moving]
    assert len(moving) == len(pushing) - 1 == 6
    reactions = [name for name in ORDINARY_OUTPUTS if name.startswith(("reaction", "action"))]
    others = [name for name in ORDINARY_OUTPUTS if name not in reactions]
    assert len(reactions) == 2 * 6
    assert len(others) == 7 * 3 + 7  # seven motions along or about three axes, seven stresses
    for inputs, outputs in ((pushing, others), (moving, others + reactions)):
        port = read(part_file, full(tip, f"inputs = {inputs}\noutputs = {outputs}")).ports[0]
        assert port.inputs == tuple(inputs)
        assert port.outputs == tuple(outputs)


def test_every_output_of_a_support_and_of_a_pair_is_one_of_the_model(part_file: Path) -> None:
    motions = [
        f"{kind}.{axis}"
        for kind in (
            *("displacement", "rotation", "velocity", "angular_velocity"),
            *("acceleration", "angular_acceleration"),
        )
        for axis in "xyz"
    ]
    reactions = ["reaction.x", "reaction.y", "reaction.z"]
    text = full('["angular_velocity.x"]', str(motions)).replace('["reaction.x"]', str(reactions))
    part = read(part_file, text)
    assert {*part.pairs[0].outputs, *part.supports[0].outputs} == {*motions, *reactions}
    assert {*motions, *reactions} <= set(outputs_of("gap"))
    assert set(part.energy.outputs) == set(outputs_of("energy"))


@pytest.mark.parametrize("variables", ["[loads]\ngravity = true", '[energy]\noutputs = ["kinetic"]'])
def test_a_part_without_ports_that_has_variables(part_file: Path, variables: str) -> None:
    begin, end = BEAM.index("[[port]]"), BEAM.index("[modes]")
    assert read(part_file, f"{BEAM[:begin]}{variables}\n{BEAM[end:]}").ports == ()
    part_file.write_text(BEAM[:begin] + BEAM[end:])
    assert told(part_file).startswith("port: missing, expected one table [[port]]")
