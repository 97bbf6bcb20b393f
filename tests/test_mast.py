"""The mast of models/ against beam theory: modes, statics, its certificate, its demo as a user runs it."""

import os
import re
import runpy
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from ready_parts import MODELS, at_rest, column, computed, reduction, table

from precompute.part import read_part
from precompute.pipeline import reduce_part

README = (MODELS / "mast" / "README.md").read_text(encoding="utf-8")
G, GAUGE, HALF_ANGLE = 9.81, 0.25, np.pi / 8


def beam(**changes: float) -> SimpleNamespace:
    """The mast as the demo's theory knows it, moving in x and without damping."""
    theory = runpy.run_path(str(MODELS / "mast" / "theory.py"))
    sizes = {"length": 3.0, "outer": 0.06, "inner": 0.054, "mass": 25.0}
    steel = {"young": 210e9, "poisson": 0.3, "density": 7850.0}
    made: SimpleNamespace = theory["Mast"](**{**sizes, **steel, **changes})
    return made


def stayed() -> SimpleNamespace:
    """The same, moving in y."""
    return beam(stiffness=1e5)


def test_beam_theory_has_the_limits_it_must() -> None:
    """Bare and slender: (βL)² √(EI/ρA)/(2πL²), published βL. A heavy top: √(3EI/mL³), m and 33/140 ρAL."""
    bare = beam(mass=0.0, outer=2e-4, inner=1.8e-4)
    EI, rho_A = 210e9 * bare.second_moment, 7850 * bare.area
    published = np.array([1.875104, 4.694091, 7.854757]) ** 2 * np.sqrt(EI / rho_A) / (2 * np.pi * 9.0)
    np.testing.assert_allclose(bare.bending(3), published, rtol=2e-6)  # seven digits, and shear
    heavy = beam(mass=2e5, outer=6e-2, inner=5.4e-2)
    EI, moving = 210e9 * heavy.second_moment, 2e5 + 33 / 140 * 7850 * heavy.area * 3.0
    shear = 1 / (1 + 3 * EI / (heavy.shear_stiffness * 9.0))  # the tip moves by shear too
    rayleigh = np.sqrt(3 * EI * shear / (moving * 27.0)) / (2 * np.pi)
    assert heavy.bending(1)[0] == pytest.approx(rayleigh, rel=1e-6)  # (mass of the beam / m)²
    # a stay as soft as nothing changes nothing; as stiff as a wall it holds the top: βL = 3.926602
    assert beam(stiffness=1e-6).bending(1)[0] == pytest.approx(beam().bending(1)[0], rel=1e-9)
    propped = beam(mass=0.0, outer=2e-4, inner=1.8e-4, stiffness=1e3)
    held = 3.926602**2 * np.sqrt(210e9 * propped.second_moment / (7850 * propped.area)) / (2 * np.pi * 9.0)
    assert propped.bending(1)[0] == pytest.approx(held, rel=1e-4)  # EI/kL³


def test_frequencies_against_beam_theory() -> None:
    """Above theory by less than 0.4 %: clamp and flange keep the section's shape, the mesh is stiff."""
    in_x, in_y = beam().bending(3), stayed().bending(3)
    expected = [f for pair in zip(in_x, in_y, strict=True) for f in pair]
    expected += [beam().torsion(), beam().axial()]
    np.testing.assert_allclose(column("mast", "reference / Hz"), expected, atol=5.1e-4)  # three decimals
    # the modes are chosen by an error: the lowest may be what residual vectors make of them, 1e-5 higher
    np.testing.assert_allclose(column("mast", "f / Hz"), computed("mast"), rtol=2e-5, atol=5.1e-4)
    excess = computed("mast") / expected - 1
    assert excess.min() > 0
    assert excess.max() < 4e-3
    for row, found in zip(table("mast"), excess, strict=True):
        assert float(row["difference"].removesuffix("%")) == pytest.approx(100 * found, abs=6e-3)
    masses = reduction("mast").effective_mass[:, :8]
    moving = np.where(masses.max(axis=0) > 1e-3, masses.argmax(axis=0), -1)
    assert moving.tolist() == [0, 1, 0, 1, 0, 1, -1, 2]  # x, y, …; torsion moves no mass along; z
    # without the instrument, and with it but without the stay, the modes would be others
    assert beam(mass=0.0).bending(1)[0] > 1.3 * in_x[0]
    assert in_y[0] > 1.3 * in_x[0]


def expected_at_rest() -> dict[tuple[str, str], float]:
    """Theory of each row of the README's table of statics, in SI."""
    mast, EI = beam(), 210e9 * beam().second_moment
    GJ = mast.shear_modulus * 2 * mast.second_moment
    weight = mast.total_mass * G
    above = mast.mass + mast.density * mast.area * (mast.length - GAUGE)
    aside = mast.static(3.0, base=-G)[0]
    bent = mast.stress(mast.static(GAUGE, base=-G)[2], HALF_ANGLE)
    down, lying, shaken = "gravity.z = -9.81", "gravity.x = 9.81", "base.acceleration.x = 9.81"
    return {
        (down, "foot.reaction.z"): weight,
        (down, "gauge.stress.zz"): -above * G / mast.area,
        (down, "gauge.stress.mises"): above * G / mast.area,
        (lying, "foot.reaction.x"): -weight,
        (lying, "top.displacement.x"): aside,
        (lying, "bow.displacement.x"): aside - mast.static(1.5, base=-G)[0],
        (lying, "gauge.stress.zz"): bent,
        (shaken, "foot.reaction.x"): weight,
        (shaken, "gauge.stress.zz"): -bent,
        ("top.force.x = 100", "top.displacement.x"): mast.static(3.0, force=100.0)[0],
        ("top.force.y = 100", "top.displacement.y"): stayed().static(3.0, force=100.0)[0],
        ("top.force.y = 100", "energy.strain"): 50 * stayed().static(3.0, force=100.0)[0],
        ("top.moment.y = 100", "top.displacement.x"): 100 * 9.0 / (2 * EI),
        ("top.moment.y = 100", "top.rotation.y"): 100 * 3.0 / EI,
        ("top.moment.z = 100", "top.rotation.z"): 100 * 3.0 / GJ,
    }


def test_theory_of_statics_by_hand() -> None:
    """The transfer matrix at ω = 0: PL³/3EI + PL/κGA, and a gauge's moment (m + ρA l/2) l g, l = L − z̄."""
    mast, EI = beam(), 210e9 * beam().second_moment
    by_hand = 100 * (27.0 / (3 * EI) + 3.0 / mast.shear_stiffness)
    assert mast.static(3.0, force=100.0)[0] == pytest.approx(by_hand, rel=1e-12)
    k = 100 / by_hand + 1e5
    assert stayed().static(3.0, force=100.0)[0] == pytest.approx(100 / k, rel=1e-12)
    above = 3.0 - GAUGE
    moment = (mast.mass + 7850 * mast.area * above / 2) * above * G
    assert mast.static(GAUGE, base=-G)[2] == pytest.approx(moment, rel=1e-12)


def test_statics_against_beam_theory() -> None:
    """Forces to 4e-5 (the curved cells' mass), stresses to 1e-3, motions to 5e-3 as the frequencies say."""
    rows = {(row["load"], row["output"]): row for row in table("mast", "load")}
    expected = expected_at_rest()
    assert rows.keys() == expected.keys()
    for (load, output), theory in expected.items():
        row, (name, value) = rows[load, output], load.split(" = ")
        found = at_rest("mast", {name: float(value)})[output]
        kind = output.split(".")[1]
        assert found == pytest.approx(theory, rel={"reaction": 4e-5, "stress": 1e-3}.get(kind, 5e-3))
        assert float(row["computed"]) == pytest.approx(found, rel=1e-4)  # five digits printed
        assert float(row["reference"]) == pytest.approx(theory, rel=1e-4)
        assert float(row["difference"].removesuffix("%")) == pytest.approx(
            100 * (found / theory - 1), abs=6e-3
        )
    moved = at_rest("mast", {"base.acceleration.x": G})
    assert moved["top.absolute_acceleration.x"] == pytest.approx(G, rel=1e-9)  # it goes with its base


def test_certificate_is_the_one_in_the_readme() -> None:
    found = reduce_part(read_part(MODELS / "mast"), certified=True)
    assert found.certificate is not None
    assert found.certificate.kept
    assert found.certificate.band == (0.0, 300.0)
    printed = re.search(r"largest error found: ([\d.]+) %", README)
    assert printed is not None
    # another choice of modes would do too: which one rounding may decide, of two that rank alike
    assert 100 * found.certificate.largest == pytest.approx(float(printed[1]), rel=0.5)
    told = re.search(rf"{found.dofs} free DOFs, reduced to (\d+) modes", README)
    assert told is not None
    assert abs(int(told[1]) - len(found.model.lam)) <= 3  # SuperLU's roundings choose 13


def test_mast_demo(tmp_path: Path) -> None:
    """The shock as a user runs it: the README's table, and every largest value within 0.5 % of theory.

    A wrong law would show: without the damper the stayed top would move a tenth further.
    """
    done = subprocess.run(
        [sys.executable, str(MODELS / "mast" / "demo.py"), str(tmp_path / "out")],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        timeout=120,
        env={**os.environ, "PYTHONIOENCODING": "utf-8", "MPLBACKEND": "Agg", "COLUMNS": "120"},
    )
    assert done.returncode == 0, done.stderr
    assert {path.name for path in (tmp_path / "out").iterdir()} == {"mast.fmu", "shock.png"}
    shown = re.findall(r"(\S+) +│ +(\S+) │ +(\S+) │ +([+-]\S+)%", done.stdout)
    assert [name for name, *_ in shown] == [row["largest"] for row in table("mast", "largest")]
    for (_, computed_text, theory, difference), row in zip(shown, table("mast", "largest"), strict=True):
        assert abs(float(difference)) < 0.5
        # four digits printed; another choice of modes that keeps the error moves peaks by less than 1e-3
        assert float(computed_text) == pytest.approx(float(row["FMU"]), rel=1e-3)
        assert float(theory) == pytest.approx(float(row["theory"]), rel=3e-4)


def test_what_the_shock_can_tell_apart() -> None:
    """The control of the demo: damper, stay, instrument each move theory's peak by far more than 0.5 %."""
    t = np.arange(0.0, 0.2, 5e-4)
    a = np.where(t < 0.011, 50 * np.sin(np.pi * t / 0.011), 0.0)

    def peak(**changes: float) -> float:
        mast = beam(**{"stiffness": 1e5, "damping": 500.0, "alpha": 0.5, "beta": 2e-5, **changes})
        return float(np.abs(mast.shaken(t, a, 3.0)[0][0]).max())

    own = peak()
    for changes in ({"damping": 0.0}, {"stiffness": 0.0}, {"mass": 20.0}):
        assert abs(peak(**changes) / own - 1) > 0.02
