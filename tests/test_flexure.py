"""The flexure of models/: matrices that CalculiX wrote, against what CalculiX computes from the same deck."""

import re
from dataclasses import replace

import numpy as np
import pytest
from ready_parts import MODELS, at_rest, column, computed, reduction, table

from precompute.part import read_part
from precompute.pipeline import reduce_part


def test_frequencies_are_those_of_calculix() -> None:
    """Seven digits of ω² are printed: at most 5e-7 of it, half of that in f; then four decimals."""
    reference = column("flexure", "reference / Hz")
    np.testing.assert_allclose(computed("flexure"), reference, rtol=2.5e-7, atol=5.1e-5)
    assert (np.diff(reference) / reference[:-1]).min() > 1e-2  # so none is taken for its neighbour


def test_static_displacements_are_those_of_calculix() -> None:
    """Six modes and residual vectors are as soft as all modes: to half of the last digit printed."""
    assert not reduction("flexure").model.R.any()  # no force is fed through
    for row in table("flexure", "input"):
        found = at_rest("flexure", {row["input"]: 1.0})[row["output"]]
        reference = float(row["reference"])
        assert found == pytest.approx(reference, rel=2.7e-7)  # half a unit in 1.910941
        assert found == pytest.approx(float(row["computed"]), rel=2.7e-7)


def test_six_modes_alone_would_miss_them() -> None:
    """The control: without residual vectors a force in y finds too little to bend."""
    part = read_part(MODELS / "flexure")
    plain = replace(part, modes=part.modes.model_copy(update={"residual": False}))
    model = reduce_part(plain).model
    k, i = model.outputs.index("sensor.displacement.y"), model.inputs.index("sensor.force.y")
    alone = model.C[k] @ (model.B[:, i] / model.lam)
    assert alone < (1 - 1e-3) * at_rest("flexure", {"sensor.force.y": 1.0})["sensor.displacement.y"]


def test_between_the_closed_forms() -> None:
    """k = 2·12 EI/L³ of beams, and of plates that cannot contract across; 13/35 of their mass moves along."""
    E, nu, rho, length, width, thick = 70e9, 0.33, 2700.0, 0.04, 0.012, 0.001
    k = 2 * 12 * E * width * thick**3 / 12 / length**3
    m = rho * width * (0.04 * 0.008 + 13 / 35 * 2 * length * thick)
    beam, plate = np.sqrt([k / m, k / (1 - nu**2) / m]) / (2 * np.pi)
    assert beam < computed("flexure")[0] < plate
    moved = at_rest("flexure", {"actuator.force.x": 1.0})["actuator.displacement.x"]
    assert (1 - nu**2) / k < moved < 1 / k
    text = (MODELS / "flexure" / "README.md").read_text(encoding="utf-8")
    assert f"k = 2·12 EI/L³ = {k / 1000:.2f} N/mm" in text
    assert f"f = {beam:.0f} to {plate:.0f} Hz" in text


def test_mass_is_that_of_the_free_nodes() -> None:
    """In SI, from t and mm: below ρV by less than the mass of the lowest cells."""
    volume = 0.012 * (0.04 * 0.008 + 2 * 0.04 * 0.001)
    found = reduction("flexure").total_mass
    assert 2700 * (volume - 2 * 0.012 * 0.001 * 0.04 / 6) < found < 2700 * volume
    text = (MODELS / "flexure" / "README.md").read_text(encoding="utf-8")
    printed = [float(mass) for mass in re.findall(r"([\d.]+) g\b", text)]
    assert printed == [round(1000 * found, 2), round(1000 * (2700 * volume - found), 2)]


def test_readme_counts() -> None:
    """Free DOFs, and what residual vectors add to the six modes."""
    found = reduction("flexure")
    text = (MODELS / "flexure" / "README.md").read_text(encoding="utf-8")
    assert f"all {found.dofs} DOFs" in text
    assert len(found.model.lam) == 6 + 3
    assert "here three" in text
