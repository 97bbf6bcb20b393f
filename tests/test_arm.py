"""The arm of models/, moved at its root, against beam theory: modes, inertia at rest, frequency responses."""

import re
import runpy
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from moved_responses import responses
from ready_parts import MODELS, at_rest, column, computed, reduction, table

from fmu_src.native_fmu import build_native_fmu
from precompute.check.description import read_description
from precompute.check.driver import Fmu
from precompute.check.structure import CHECKS as STRUCTURE
from precompute.check.unpack import unpack

L, H, B, E, NU, RHO = 0.6, 0.02, 0.04, 70e9, 0.33, 2700.0
README = (MODELS / "arm" / "README.md").read_text(encoding="utf-8")


def beam(**changes: float) -> SimpleNamespace:
    theory = runpy.run_path(str(MODELS / "arm" / "theory.py"))
    sizes = {"length": L, "thickness": H, "width": B, "young": E, "poisson": NU, "density": RHO}
    made: SimpleNamespace = theory["Arm"](**{**sizes, **changes})
    return made


def test_beam_theory_has_the_limits_it_must() -> None:
    """Slowly moved it is rigid: m, J and mL/2; slender, its frequencies are the published (βL)²."""
    arm = beam()
    shoved, turned = arm.moved(0.1, 0.0, acceleration=1.0), arm.moved(0.1, 0.0, angular=1.0)
    found = [-shoved[3], -shoved[2], -turned[3], -turned[2]]
    wanted = [arm.mass, arm.mass * L / 2, arm.mass * L / 2, arm.inertia]
    np.testing.assert_allclose(found, wanted, rtol=2e-5)  # (f/f₁)² = 5e-6
    thin = beam(thickness=2e-4, width=2e-4)
    published = np.array([1.875104, 4.694091, 7.854757]) ** 2 * 2e-4 / np.sqrt(12) * np.sqrt(E / RHO)
    np.testing.assert_allclose(thin.bending(3), published / (2 * np.pi * L**2), rtol=2e-6)


def test_frequencies_against_beam_theory() -> None:
    expected = [*beam().bending(2), beam().axial()]
    np.testing.assert_allclose(column("arm", "reference / Hz"), expected, atol=5.1e-4)
    # the modes are chosen by an error: which ones residual vectors replace, rounding may decide
    np.testing.assert_allclose(column("arm", "f / Hz"), computed("arm"), rtol=2e-5, atol=5.1e-4)
    excess = computed("arm") / expected - 1
    assert excess.min() > 0
    assert excess.max() < 8e-3


def expected_at_rest() -> dict[tuple[str, str], float]:
    """Under the inertia p = −ρAa or −ρA x θ̈ a length, and the moment of −ρIθ̈ a length."""
    arm = beam()
    EI, GA, rho_A, rho_I = (
        *(arm.bending_stiffness, arm.shear_stiffness, RHO * arm.area),
        RHO * arm.second_moment,
    )
    gauge = rho_A / 2 * (0.55**3 - 0.5**3) / (3 * 0.05)  # mean of (L − x)² over the gauge
    pushed, turned = "root.motion.y = 10", "root.angular_motion.z = 10"
    return {
        ("root.motion.x = 100", "root.reaction.x"): 100 * arm.mass,
        ("root.motion.x = 100", "tip.displacement.x"): -100 * RHO * L**2 / (2 * E),
        (pushed, "root.reaction.y"): 10 * arm.mass,
        (pushed, "root.reaction_moment.z"): 10 * arm.mass * L / 2,
        (pushed, "tip.displacement.y"): -10 * rho_A * (L**4 / (8 * EI) + L**2 / (2 * GA)),
        (pushed, "gauge.stress.xx"): 10 * gauge * (H / 2) / arm.second_moment,
        (turned, "root.reaction_moment.z"): 10 * arm.inertia,
        (turned, "root.reaction.y"): 10 * arm.mass * L / 2,
        (turned, "tip.displacement.y"): -10
        * (rho_A * (11 * L**5 / (120 * EI) + L**3 / (3 * GA)) + rho_I * L**3 / (3 * EI)),
        ("tip.force.y = 10", "root.reaction.y"): -10.0,
        ("tip.force.y = 10", "tip.displacement.y"): 10 * (L**3 / (3 * EI) + L / GA),
    }


def test_inertia_against_beam_theory() -> None:
    """What moves it exactly, the deflections as the frequencies say, to 1.4 %."""
    rows = {(row["load"], row["output"]): row for row in table("arm", "load")}
    expected = expected_at_rest()
    assert rows.keys() == expected.keys()
    for (load, output), theory in expected.items():
        row, (name, value) = rows[load, output], load.split(" = ")
        found = at_rest("arm", {name: float(value)})[output]
        assert found == pytest.approx(theory, rel=1e-9 if "reaction" in output else 1.4e-2)
        agree(row, found, theory)


def agree(row: dict[str, str], found: float, theory: float) -> None:
    assert float(row["computed"]) == pytest.approx(found, rel=1e-4)  # five digits printed
    assert float(row["reference"]) == pytest.approx(theory, rel=1e-4)
    assert float(row["difference"].removesuffix("%")) == pytest.approx(100 * (found / theory - 1), abs=6e-3)


def test_responses_against_beam_theory() -> None:
    """Reactions and the acceleration of the tip per acceleration of the root; 1.6 % around resonances."""
    model, arm = reduction("arm").model, beam(beta=2e-5)
    rows = table("arm", "f / Hz")
    assert len(rows) == 12
    for row in rows:
        f, (output, by) = float(row["f / Hz"]), row["response"].replace("`", "").split(" per ")
        root = {"root.motion.y": {"acceleration": 1.0}, "root.angular_motion.z": {"angular": 1.0}}[by]
        w = -((2 * np.pi * f) ** 2) * arm.moved(f, L, **root)[0]
        _, _, M, V = arm.moved(f, 0.0, **root)
        theory = {"root.reaction.y": -V, "root.reaction_moment.z": -M, "tip.acceleration.y": w}[output]
        found = responses(model, 2 * np.pi * f)[model.outputs.index(output), model.inputs.index(by)]
        assert abs(found - theory) < 1.6e-2 * abs(theory)
        agree(row, abs(found), abs(theory))


def test_sizes_are_those_in_the_readme() -> None:
    found = reduction("arm")
    told = re.search(r"(\d+) with the root held, reduced to (\d+) modes", README)
    assert told is not None
    assert found.dofs == int(told[1])
    assert abs(found.model.r - int(told[2])) <= 3  # rounding may choose others that do as well


def test_the_checker_sees_every_dependence_that_is_listed(tmp_path: Path) -> None:
    """Also those of 1e-10 beside displacements that a start value of the motion makes large."""
    fmu = build_native_fmu(reduction("arm").model, tmp_path / "arm.fmu")
    unpack(fmu, tmp_path / "arm")
    description = read_description(tmp_path / "arm")
    (check,) = (check for check in STRUCTURE if check.name == "dependencies at initialisation")
    assert list(check.run(Fmu(tmp_path / "arm", description, 4, lambda call: None))) == []
