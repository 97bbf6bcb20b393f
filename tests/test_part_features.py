"""Whole part files: every table and key from the text to the reduced model, against closed forms."""

from pathlib import Path

import numpy as np
import pytest
from scipy.io import mmwrite
from scipy.sparse.linalg import spsolve
from small_part import DENSITY, LENGTH, WIDTH, YOUNG, write_part

from fmu_src.runtime.instance import Instance
from fmu_src.runtime.model import ReducedModel
from precompute.dofs import DIRECTIONS
from precompute.errors import PartError
from precompute.part import read_part
from precompute.pipeline import Reduction, reduce_part

AREA = WIDTH**2
MASS = DENSITY * AREA * LENGTH
AXIAL = YOUNG * AREA / LENGTH  # N/m of the whole bar, ν = 0
OUTPUTS = 'outputs = ["displacement.x", "displacement.z", "velocity.z"]'
INPUTS = 'inputs = ["force.x", "force.z"]'
SUPPORT = '[[support]]\nat = { plane = { normal = "x", at = 0.0 } }\nfix = ["x", "y", "z"]\n'
PORT = "[[port]]\n"
RATIO = "[damping]\nratio = 0.02\n"
ALL_MODES = ("count = 8", "count = 72")
WHOLE = (ALL_MODES, (RATIO, ""))


def reduced(folder: Path, *changes: tuple[str, str]) -> Reduction:
    return reduce_part(read_part(write_part(folder, *changes)))


def static(model: ReducedModel, **inputs: float) -> dict[str, float]:
    """Outputs in equilibrium under these inputs, names with __ for the dots."""
    u = np.zeros(len(model.inputs))
    for name, value in inputs.items():
        u[model.inputs.index(name.replace("__", "."))] = value
    instance = Instance(model)
    instance.initialising = False
    instance.set_inputs(np.arange(len(u)), u)
    q = np.divide(model.B @ u, model.lam, out=np.zeros_like(model.lam), where=model.lam > 0)
    instance.set_state({instance.layout.q.start + i: x for i, x in enumerate(q)})
    y = instance.reals()[instance.layout.outputs]
    return dict(zip(model.outputs, y.tolist(), strict=True))


def test_gravity_stress_reaction_and_energy_of_a_hanging_bar(tmp_path: Path) -> None:
    """u = ρgL²/2E at the tip, σ = 0 there, the clamp carries ρgAL, strain energy ρ²g²AL³/6E.

    Quadratic displacement in linear cells: nodes are exact in one dimension, the energy is that of the
    piecewise linear field, (1 − 1/n²/4 …): 1 % for six cells.
    """
    extra = '\n[loads]\ngravity = true\n\n[energy]\noutputs = ["kinetic", "strain"]\n'
    model = reduced(
        tmp_path,
        *WHOLE,
        (SUPPORT, SUPPORT + 'name = "clamp"\noutputs = ["reaction.x", "reaction.z"]\n'),
        (OUTPUTS, 'outputs = ["displacement.x", "stress.xx", "stress.mises"]'),
        ("[modes]", extra + "\n[modes]"),
    ).model
    g = 9.81
    found = static(model, gravity__x=g)
    assert found["tip.displacement.x"] == pytest.approx(DENSITY * g * LENGTH**2 / (2 * YOUNG), rel=1e-9)
    assert found["clamp.reaction.x"] == pytest.approx(-MASS * g, rel=1e-9)
    assert abs(found["clamp.reaction.z"]) < 1e-9 * MASS * g
    exact = (DENSITY * g) ** 2 * AREA * LENGTH**3 / (6 * YOUNG)
    assert found["energy.strain"] == pytest.approx(exact, rel=0.01)
    assert found["energy.kinetic"] == 0
    pulled = static(model, tip__force__x=1e4)
    assert pulled["tip.stress.xx"] == pytest.approx(1e4 / AREA, rel=1e-9)
    assert pulled["tip.stress.mises"] == pytest.approx(1e4 / AREA, rel=1e-9)
    assert pulled["clamp.reaction.x"] == pytest.approx(-1e4, rel=1e-9)
    assert pulled["energy.strain"] == pytest.approx(0.5e8 / AXIAL, rel=1e-9)


def test_pressure_on_the_end_face_is_a_force(tmp_path: Path) -> None:
    model = reduced(tmp_path, *WHOLE, (INPUTS, 'inputs = ["force.x", "pressure"]')).model
    np.testing.assert_allclose(model.B[:, 1], -AREA * model.B[:, 0], atol=1e-12 * np.abs(model.B[:, 0]).max())


def test_twist_of_a_rigid_port(tmp_path: Path) -> None:
    """Moment about x and rotation are conjugate; the end face of kind rigid turns as one."""
    changes = (
        (INPUTS, 'inputs = ["moment.x", "force.z"]\nkind = "rigid"'),
        (OUTPUTS, 'outputs = ["rotation.x", "rotation.y", "displacement.z", "angular_velocity.x"]'),
    )
    reduction = reduced(tmp_path, ("count = 8", "count = 66"), (RATIO, ""), *changes)
    found = static(reduction.model, tip__moment__x=1.0)
    assert reduction.dofs == 66  # the four nodes of the end have 6 instead of 12
    assert found["tip.rotation.x"] > 0
    assert abs(found["tip.displacement.z"]) < 1e-9 * found["tip.rotation.x"]
    np.testing.assert_allclose(reduction.model.C[0], reduction.model.B[:, 0], rtol=1e-12)
    bent = static(reduction.model, tip__force__z=1.0)
    assert bent["tip.rotation.y"] < 0 < bent["tip.displacement.z"]  # right-handed


def test_the_base_that_accelerates(tmp_path: Path) -> None:
    """In equilibrium with a constant acceleration the bar is stretched as by gravity the other way."""
    model = reduced(
        tmp_path,
        *WHOLE,
        (OUTPUTS, 'outputs = ["displacement.x", "absolute_acceleration.x", "acceleration.x"]'),
        ("[modes]", '[loads]\nbase = ["x"]\ngravity = true\n\n[modes]'),
    ).model
    found = static(model, base__acceleration__x=2.0)
    assert found["tip.displacement.x"] == pytest.approx(-DENSITY * 2 * LENGTH**2 / (2 * YOUNG), rel=1e-9)
    assert found["tip.absolute_acceleration.x"] == pytest.approx(2.0, rel=1e-9)
    assert abs(found["tip.acceleration.x"]) < 1e-9
    gravity, base = model.inputs.index("gravity.x"), model.inputs.index("base.acceleration.x")
    np.testing.assert_allclose(model.B[:, base], -model.B[:, gravity], rtol=1e-14)


ROOT = """[[port]]
name = "middle"
at = { plane = { normal = "x", at = 0.5 } }
inputs = ["force.x"]
outputs = ["displacement.x"]

[[pair]]
name = "gap"
ports = ["middle", "tip"]
outputs = ["displacement.x", "velocity.x"]

[[port]]
"""


def test_pairs_measure_between_ports(tmp_path: Path) -> None:
    model = reduced(tmp_path, *WHOLE, (PORT, ROOT)).model
    found = static(model, tip__force__x=1.0)
    assert found["gap.displacement.x"] == pytest.approx(0.5 / AXIAL, rel=1e-9)
    assert found["gap.displacement.x"] == pytest.approx(
        found["tip.displacement.x"] - found["middle.displacement.x"], rel=1e-12
    )


def test_springs_masses_and_dashpots(tmp_path: Path) -> None:
    """A stiff bar that slides on a soft spring: ω = √(k/(m + m₀)), d = c/(m + m₀)."""
    k, c, added = 1e3, 40.0, 21.5
    elements = f"""
[[spring]]
port = "tip"
direction = "x"
stiffness = {k}

[[dashpot]]
port = "tip"
direction = "x"
damping = {c}

[[mass]]
port = "tip"
mass = {added}

[modes]"""
    guided = (
        SUPPORT.replace('fix = ["x", "y", "z"]', 'fix = ["y", "z"]')
        .replace("plane", "box")
        .replace('{ normal = "x", at = 0.0 }', "[[0.0, 0.0, 0.0], [1.0, 1.0, 1.0]]")
    )
    model = reduced(
        tmp_path, (SUPPORT, guided), ("count = 8", "count = 3"), (RATIO, ""), ("\n[modes]", elements)
    ).model
    total = MASS + added
    assert model.frequency[0] == pytest.approx(
        np.sqrt(k / total) / (2 * np.pi), rel=1e-5
    )  # the bar gives a bit
    assert model.D_rest[0, 0] == pytest.approx(c / total, rel=1e-5)
    assert list(model.coupled) == [0, 1, 2]


def test_damping_of_materials_and_springs(tmp_path: Path) -> None:
    """One material with β is Rayleigh's; with a spring at the port its D is that of the body alone."""
    material = (f"density = {DENSITY}", f"density = {DENSITY}\nbeta = 1e-5\nalpha = 3.0")
    plain = reduced(tmp_path, material, (RATIO, "")).model
    assert (plain.alpha, plain.beta) == (3.0, 1e-5)
    assert not plain.D_rest.any()
    spring = '[[spring]]\nport = "tip"\ndirection = "x"\nstiffness = 1e9\n\n[modes]'
    sprung = reduced(tmp_path, material, (RATIO, ""), ("[modes]", spring)).model
    assert (sprung.alpha, sprung.beta) == (0.0, 0.0)
    axial = int(np.argmax(np.abs(sprung.B[:, 0])))
    less = sprung.beta * sprung.lam[axial] + sprung.D_rest[axial, axial] - 3.0
    w = sprung.B[axial, 0]
    assert less == pytest.approx(1e-5 * (sprung.lam[axial] - 1e9 * w**2), rel=1e-9)


def test_residual_vectors_hold_what_a_dashpot_does_to_the_part(tmp_path: Path) -> None:
    """Its force bends the part as a load would: w K⁺wᵀ of all modes, at a port that has no inputs."""
    port = ROOT.replace('inputs = ["force.x"]\n', "").split("[[pair]]")[0]
    dashpot = '[[dashpot]]\nport = "middle"\ndirection = "x"\ndamping = 50.0\n\n'
    modes = '[modes]\ncount = 3\nresidual = "modes"\n'
    for text, exact in ((dashpot + modes, True), (modes, False)):
        folder = tmp_path / str(exact)
        folder.mkdir()
        model = reduced(folder, (PORT, port + PORT), ("[modes]\ncount = 8\n", text)).model
        flexibility = float(np.sum(model.C[0] ** 2 / model.lam))
        assert (flexibility == pytest.approx(0.5 / AXIAL, rel=1e-9)) == exact


FULL = ("tip.displacement.x", "tip.displacement.z")


@pytest.mark.parametrize(
    ("text", "exact"),
    [
        ("[modes]\ncount = 2\nresidual = true\n", True),
        ('[modes]\ncount = 2\nresidual = "modes"\n', True),
        ('[basis]\nkind = "craig-bampton"\n\n[modes]\ncount = 0\n', True),
        ('[basis]\nkind = "krylov"\n\n[modes]\ncount = 2\n', True),
        ("[modes]\ncount = 2\n", False),
        ('[basis]\nkind = "polynomial"\norder = 2\n', False),
    ],
)
def test_bases_that_are_exact_in_statics(tmp_path: Path, text: str, exact: bool) -> None:
    """u = F L/EA and the bending of all 72 modes; plain modes and polynomials miss it."""
    reference = static(reduced(tmp_path, *WHOLE).model, tip__force__z=1.0, tip__force__x=2.0)
    model = reduced(tmp_path, ("[modes]\ncount = 8\n", text)).model
    found = static(model, tip__force__z=1.0, tip__force__x=2.0)
    error = max(abs(found[name] / reference[name] - 1) for name in FULL)
    assert (error < 1e-9) == exact
    if not exact:
        assert error > 1e-4


def test_a_basis_from_a_file(tmp_path: Path) -> None:
    """The modes of the part as a file, mixed: the same model again."""
    own = reduced(tmp_path)
    mixed = own.modes.Phi @ np.random.default_rng(0).standard_normal((8, 8))
    np.save(tmp_path / "U.npy", mixed)
    again = reduced(tmp_path, ("[modes]\ncount = 8\n", '[basis]\nkind = "file"\nfile = "U.npy"\n')).model
    np.testing.assert_allclose(again.lam, own.model.lam, rtol=1e-9)
    np.testing.assert_allclose(np.abs(again.B), np.abs(own.model.B), atol=1e-7 * np.abs(own.model.B).max())


def exported(folder: Path) -> Reduction:
    """bar.vtu's K and M as Matrix Market in mm, t, s with a table of DOFs in another order."""
    own = reduced(folder, ("count = 8", "count = 20"))
    full = own.full
    order = np.random.default_rng(1).permutation(len(full.dofs.node))
    # N/mm = 1e-3 N/m, t = 1e3 kg
    mmwrite(folder / "K.mtx", full.system.K[order][:, order] * 1e-3, precision=17)
    mmwrite(folder / "M.mtx", full.system.M[order][:, order] * 1e-3, precision=17)
    lines = ["node,direction,x,y,z"]
    for d in order:
        node, axis = full.dofs.node[d], DIRECTIONS[full.dofs.direction[d]]
        x, y, z = 1e3 * full.nodes.points[node]
        lines.append(
            f"{full.nodes.node_ids[node]},{axis},{x!r},{y!r},{z!r}".replace("np.float64(", "").replace(
                ")", ""
            )
        )
    (folder / "dofs.csv").write_text("\n".join(lines) + "\n")
    return own


IMPORT = """\
[part]
name = "bar"

[system]
stiffness = "K.mtx"
mass = "M.mtx"
dofs = "dofs.csv"
units = { length = "mm", mass = "t", time = "s" }

[[support]]
at = { plane = { normal = "x", at = 0.0 } }
fix = ["x", "y", "z"]
name = "clamp"
outputs = ["reaction.x"]

[[port]]
name = "tip"
at = { plane = { normal = "x", at = 1000.0 } }
inputs = ["force.x", "force.z", "moment.y"]
outputs = ["displacement.x", "displacement.z", "rotation.y"]

[modes]
count = 20
residual = true

[damping]
ratio = 0.02
"""


def test_imported_matrices_give_the_same_part(tmp_path: Path) -> None:
    own = exported(tmp_path)
    (tmp_path / "part.toml").write_text(IMPORT)
    found = reduce_part(read_part(tmp_path), certified=True)
    np.testing.assert_allclose(found.model.lam, own.model.lam, rtol=1e-9)
    assert found.total_mass == pytest.approx(MASS, rel=1e-12)
    u = static(found.model, tip__force__x=1.0)
    assert u["tip.displacement.x"] == pytest.approx(1 / AXIAL, rel=1e-8)
    assert u["clamp.reaction.x"] == pytest.approx(-1.0, rel=1e-9)
    assert found.certificate is not None
    assert found.certificate.largest < 0.05


def test_a_certificate_finds_the_missing_mode(tmp_path: Path) -> None:
    """Against brute force: complex solves of the full model at the certificate's own frequencies."""
    alpha, beta = 10.0, 1e-6
    damping = (RATIO, f"[damping]\nalpha = {alpha}\nbeta = {beta}\n")
    part = read_part(write_part(tmp_path, ("count = 8", "count = 3"), damping))
    reduction = reduce_part(part, certified=True)
    certificate = reduction.certificate
    assert certificate is not None
    model, full = reduction.model, reduction.full
    free = np.setdiff1d(np.arange(len(full.dofs.node)), full.fixed)
    K, M = (A[free][:, free].tocsc() for A in (full.system.K, full.system.M))
    tip = np.flatnonzero(full.nodes.points[:, 0] == LENGTH)
    b = np.zeros((len(full.dofs.node), 2))
    b[3 * tip, 0] = b[3 * tip + 2, 1] = 0.25
    rows = b[free]
    error, peak = [], []
    for f in certificate.frequency:
        w = 2 * np.pi * f
        H = rows.T @ spsolve((1 + 1j * w * beta) * K + (1j * w * alpha - w**2) * M, rows.astype(complex))
        D = model.lam - w**2 + 1j * w * model.damping(alpha, beta)
        H_r = (model.C[:2] / D) @ model.B
        error.append(np.linalg.norm(H - H_r, 2))
        peak.append(np.linalg.norm(H, 2))
    displacement = next(c for c in certificate.comparisons if c.output.startswith("displacement"))
    missing = np.array(error)
    assert displacement.peak == pytest.approx(max(peak), rel=1e-6)
    np.testing.assert_allclose(
        displacement.error * displacement.peak, missing, rtol=0.02, atol=1e-3 * missing.max()
    )


def test_modes_chosen_by_their_error(tmp_path: Path) -> None:
    choice = "[modes]\nerror = 0.01\nband = [0.0, 2000.0]\n"
    reduction = reduce_part(read_part(write_part(tmp_path, ("[modes]\ncount = 8\n", choice))), certified=True)
    certificate = reduction.certificate
    assert certificate is not None
    assert certificate.kept
    assert certificate.tolerance == 0.01
    assert len(reduction.model.lam) < 12
    worse = reduce_part(
        read_part(write_part(tmp_path, ("[modes]\ncount = 8\n", choice.replace("0.01", "1e-4")))),
        certified=True,
    )
    assert worse.certificate is not None
    assert worse.certificate.largest <= 1e-4
    assert len(worse.model.lam) > len(reduction.model.lam)


def test_a_tolerance_below_the_error_of_the_choice_is_measured_as_finely(tmp_path: Path) -> None:
    choice = "[modes]\nerror = 0.1\nband = [0.0, 2000.0]\n\n[accuracy]\ntolerance = 1e-6\n"
    reduction = reduce_part(read_part(write_part(tmp_path, ("[modes]\ncount = 8\n", choice))), certified=True)
    assert reduction.certificate is not None
    assert not reduction.certificate.kept
    assert reduction.certificate.reference_error <= 2e-9  # 1e-3 of the tolerance, at other samples too


def test_a_table_of_ratios_cannot_number_modes_that_are_yet_to_be_chosen(tmp_path: Path) -> None:
    changes = (
        ("[modes]\ncount = 8\n", "[modes]\nerror = 0.01\nband = [0.0, 2000.0]\n"),
        ("ratio = 0.02", "table = [[1, 0.02]]"),
    )
    with pytest.raises(PartError, match=r"damping\.table"):
        reduced(tmp_path, *changes)
