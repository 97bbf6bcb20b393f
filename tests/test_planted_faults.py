"""The checker is proven by FMUs with one planted fault each: it finds every one and calls it by its name.

One fault for each name here; python tests/planted_faults.py plants all of them.
"""

from pathlib import Path

import pytest
from planted import CC, SOURCES, Edit, Fault, edited, is_code, planted
from planted_faults import FAULTS, findings, is_caught, of_the_suite

from precompute.check.demands import DEMANDS
from precompute.check.verdict import check_fmu

compiles = pytest.mark.skipif(CC is None, reason="the faulty libraries are compiled by gcc for linux64")


@compiles
@pytest.mark.parametrize("fault", of_the_suite(), ids=lambda fault: fault.name)
def test_a_planted_fault_is_found_by_its_name(fault: Fault) -> None:
    found = findings(fault)
    assert is_caught(fault, found), found


@compiles
def test_the_sound_fmu_has_none(tmp_path: Path) -> None:
    """Compiled as the others are; the control of them all."""
    verdict = check_fmu(planted(None, tmp_path / "sound.fmu"))
    assert not verdict.findings
    assert len(verdict.made) > 40


def test_every_finding_has_a_planted_fault() -> None:
    every = [fault for faults in FAULTS.values() for fault in faults]
    assert {fault.finding for fault in every if fault.group} == DEMANDS.keys()
    assert {fault.finding for fault in every} == {fault.finding for fault in of_the_suite()}
    assert len({fault.name for fault in every}) == len(every) >= 150


@pytest.mark.parametrize("part", FAULTS)
def test_every_fault_can_be_planted(part: str) -> None:
    """The sources change; here those of the table are tried whose libraries the suite does not compile."""
    for fault in FAULTS[part]:
        texts: dict[str, str] = {}
        for change in fault.changes:
            if isinstance(change, Edit) and is_code(change):
                before = texts.get(change.file) or (SOURCES / change.file).read_text(encoding="utf-8")
                texts[change.file] = edited(before, change)


def test_a_fault_cannot_vanish_silently() -> None:
    """Where the sources have changed so that a fault is in no place, or in two, it cannot be planted."""
    edit = Edit("any.c", "x = 1;", "x = 2;")
    assert edited("a; x = 1; b", edit) == "a; x = 2; b"
    for text in ("a; x = 3; b", "x = 1; x = 1;"):
        with pytest.raises(AssertionError, match="times"):
            edited(text, edit)
