"""The cantilever of models/ against beam theory, and its demo as a user runs it."""

import os
import re
import runpy
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from ready_parts import MODELS, column, computed, reduction, table


def beam(**changes: float) -> SimpleNamespace:
    """Beam theory as the cantilever's demo uses it."""
    theory = runpy.run_path(str(MODELS / "cantilever" / "theory.py"))
    sizes = {"length": 1.0, "width": 0.03, "height": 0.02}
    steel = {"young": 210e9, "poisson": 0.3, "density": 7850.0}
    made: SimpleNamespace = theory["Beam"](**{**sizes, **steel, **changes})
    return made


def test_beam_theory_has_the_limits_it_must() -> None:
    """Timoshenko → Euler–Bernoulli (published βL) for a slender bar, and below it for a thick one."""
    slender = beam(width=3e-4, height=2e-4)
    np.testing.assert_allclose(slender.timoshenko("z", 3), slender.euler_bernoulli("z"), rtol=2e-6)
    ratio = np.divide(beam().timoshenko("z", 3), beam().euler_bernoulli("z"))
    assert (np.diff(ratio) < 0).all()
    assert ratio[0] < 1 - 1e-4


def test_cantilever_against_beam_theory() -> None:
    """Within 0.4 %, always above: the clamp also holds the section's width and the mesh is stiff."""
    theory = beam()
    bending = [
        (f, direction) for direction, n in (("y", 4), ("z", 5)) for f in theory.timoshenko(direction, n)
    ]
    expected = sorted([*bending, (theory.torsion(), "torsion"), (theory.axial(), "axial")])
    frequency = np.array([f for f, _ in expected])
    np.testing.assert_allclose(column("cantilever", "reference / Hz"), frequency, atol=5.1e-5)
    excess = computed("cantilever") / frequency - 1
    is_torsion = np.array([kind == "torsion" for _, kind in expected])
    assert (excess > 0).all()
    assert excess[~is_torsion].max() < 4e-3
    assert excess[is_torsion].max() < 1.2e-2  # the clamp also stops warping
    for (_, kind), row in zip(expected, table("cantilever"), strict=True):
        assert kind in row["shape"]
    # Euler–Bernoulli's third frequency in y is off by more than the tolerance allows
    assert theory.euler_bernoulli("y")[2] / theory.timoshenko("y", 3)[2] - 1 > 1e-2


def test_cantilever_planes_do_not_mix() -> None:
    """A force in z moves no mode that bends in y: zero up to rounding against the modes that it moves."""
    model = reduction("cantilever").model
    y, z = np.abs(model.B.T)
    in_y, in_z = y > 0.1 * y.max(), z > 0.1 * z.max()
    assert in_y.sum() == 7  # of 20: 7 + 9 bending, 3 twisting, 1 axial
    assert in_z.sum() == 9
    assert y[in_z].max() < 1e-8 * y.max()
    assert z[in_y].max() < 1e-8 * z.max()


@pytest.mark.parametrize(("direction", "column_of_B", "row_of_C"), [("y", 0, 0), ("z", 1, 1)])
def test_cantilever_static_deflection(direction: str, column_of_B: int, row_of_C: int) -> None:
    """Σ c b/λ over 20 modes against F L³/3EI + F L/κGA."""
    model = reduction("cantilever").model
    assert model.outputs[row_of_C] == f"tip.displacement.{direction}"
    flexibility = model.C[row_of_C] @ (model.B[:, column_of_B] / model.lam)
    expected = beam().deflection(direction, 1.0)
    # the square of the frequencies' excess, and truncation: the next bending mode adds 1/βL⁴ ~ 1e-5
    assert 1 - 6e-3 < flexibility / expected < 1
    assert beam(length=1.01).deflection(direction, 1.0) / expected > 1 + 6e-3


def test_cantilever_demo(tmp_path: Path) -> None:
    """The main job as a user runs it, and the last column of its table."""
    script = MODELS / "cantilever" / "demo.py"
    done = subprocess.run(
        [sys.executable, str(script), str(tmp_path / "out")],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        timeout=120,
        env={**os.environ, "PYTHONIOENCODING": "utf-8", "MPLBACKEND": "Agg"},
    )
    assert done.returncode == 0, done.stderr
    assert {path.name for path in (tmp_path / "out").iterdir()} == {"cantilever.fmu", "response.png"}
    differences = [float(text) for text in re.findall(r"([+-]\d+\.\d+)%", done.stdout)]
    assert len(differences) == 9
    assert all(0 < d < 0.4 for d in differences[:6])
    static, largest, ratio = differences[6:]
    assert -0.6 < static < 0
    assert -3.0 < largest < 0
    assert abs(ratio) < 0.1  # sampled peaks
