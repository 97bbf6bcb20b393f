"""The native and the Python FMU of every ready part: same inputs, random steps, the same numbers."""

import math
from pathlib import Path

import pytest
from examples import two_ports
from twins import DAMPED, PARTS, TUNED, difference, difference_of_twins, inputs, run

from fmu_src.native_fmu import build_native_fmu

STEPS = 2000


@pytest.mark.parametrize(
    ("name", "tuned"),
    [*((name, False) for name in PARTS), *((name, True) for name in TUNED)],
    ids=[*PARTS, *(f"{name} tuned" for name in TUNED)],
)
def test_twins_agree(name: str, tuned: bool, tmp_path: Path) -> None:
    """1e-12 of the peak where damped; elsewhere the roundings of each step stay: N·ε·(1 + ωh)."""
    found = difference_of_twins(PARTS[name](), STEPS, tmp_path, tuned=tuned)
    assert math.isnan(found.damped) or found.damped <= DAMPED
    assert math.isnan(found.other) or found.other <= 1.0
    assert not (math.isnan(found.damped) and math.isnan(found.other))


def test_a_model_that_is_a_little_different_is_noticed(tmp_path: Path) -> None:
    """The control: one eigenvalue off by a part in 10⁸."""
    model = PARTS["two_ports"]()
    given = inputs(model, 300, tuned=False)
    rows = run(build_native_fmu(model, tmp_path / "two_ports.fmu"), given)
    for nudged in (3, 4):
        lam = model.lam.copy()
        lam[nudged] *= 1 + 1e-8
        other = run(build_native_fmu(two_ports(lam=lam), tmp_path / "other.fmu"), given)
        assert difference(model, given["h"], rows, other).damped > 10 * DAMPED
