"""The checker is proven by FMUs with one planted fault each: it finds every one and calls it by its name.

At most two faults for each name here; python tests/planted_faults.py plants all of them.
"""

from pathlib import Path

import pytest
from planted import CC, Edit, Fault, edited, planted
from planted_faults import FAULTS, findings, is_caught, of_the_suite

from precompute.check.demands import DEMANDS
from precompute.check.verdict import check_fmu

pytestmark = pytest.mark.skipif(CC is None, reason="the faulty libraries are compiled by gcc for linux64")

EVERY = [fault for faults in FAULTS.values() for fault in faults]
SURVIVE = {
    "a parameter can be NaN": "any message counts as a refusal, that a step size is new too",
}


@pytest.mark.parametrize("fault", of_the_suite(), ids=lambda fault: fault.name)
def test_a_planted_fault_is_found_by_its_name(fault: Fault, request: pytest.FixtureRequest) -> None:
    if fault.name in SURVIVE:
        request.applymarker(pytest.mark.xfail(strict=True, reason=SURVIVE[fault.name]))
    found = findings(fault)
    assert is_caught(fault, found), found


def test_the_sound_fmu_has_none(tmp_path: Path) -> None:
    """Compiled as the others are; the control of them all."""
    verdict = check_fmu(planted(None, tmp_path / "sound.fmu"))
    assert not verdict.findings
    assert len(verdict.made) > 40


def test_there_are_enough_of_them() -> None:
    assert len({fault.name for fault in EVERY}) == len(EVERY) >= 120
    assert {fault.finding for fault in EVERY} == {fault.finding for fault in of_the_suite()}
    assert {fault.finding for fault in EVERY if fault.group} <= DEMANDS.keys()
    assert len({fault.finding for fault in EVERY}) >= 40
    assert {*SURVIVE} <= {fault.name for fault in EVERY}


def test_a_fault_cannot_vanish_silently() -> None:
    """Where the sources have changed so that a fault is in no place, or in two, it cannot be planted."""
    edit = Edit("any.c", "x = 1;", "x = 2;")
    assert edited("a; x = 1; b", edit) == "a; x = 2; b"
    for text in ("a; x = 3; b", "x = 1; x = 1;"):
        with pytest.raises(AssertionError, match="times"):
            edited(text, edit)
