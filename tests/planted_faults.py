"""Every planted fault, and what the checker says of it.

python tests/planted_faults.py [WORD …] prints a Markdown table of those whose names have one of the words;
with --all each goes through all checks, as by `modalfmu check`, else through the group that must find it.
"""

import argparse
import time
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from tempfile import TemporaryDirectory

from planted import Fault, planted
from planted_archive import ARCHIVE
from planted_calls import CALLS
from planted_description import CAPABILITIES, STRUCTURE, VARIABLES
from planted_life import LIFE
from planted_numbers import DERIVATIVES, STEPS, VALUES
from planted_state import STATE

from precompute.check.description import read_description
from precompute.check.driver import Fmu
from precompute.check.finding import Finding
from precompute.check.groups import ALONE, GROUPS
from precompute.check.process import run_group
from precompute.check.unpack import unpack
from precompute.check.verdict import check_fmu
from precompute.errors import ModalFmuError

FAULTS: Mapping[str, tuple[Fault, ...]] = {
    "the description": (*VARIABLES, *STRUCTURE, *CAPABILITIES),
    "lives and instances": LIFE,
    "states": STATE,
    "calls and messages": CALLS,
    "steps, derivatives, values": (*STEPS, *DERIVATIVES, *VALUES),
    "the archive": ARCHIVE,
}
PATIENCE = 60.0  # s for a group of checks, which takes about one
HANGS = 4.0  # s, where an answer never comes
MOST = 1  # of the faults of a finding that the suite plants; the table has all


def of_the_suite() -> list[Fault]:
    """At most MOST faults for each finding."""
    chosen: dict[str, list[Fault]] = {}
    for faults in FAULTS.values():
        for fault in faults:
            chosen.setdefault(fault.finding, []).append(fault)
    return [fault for faults in chosen.values() for fault in faults[:MOST]]


def findings(fault: Fault, *, everything: bool = False) -> dict[str, str]:
    """What the checker finds, name → what it saw; "refused" → its words where it takes this for no FMU."""
    with TemporaryDirectory(prefix="planted", ignore_cleanup_errors=True) as place:
        path = planted(fault, Path(place, "part.fmu"))
        patience = HANGS if fault.finding == "hang" else PATIENCE
        try:
            if everything:
                found = check_fmu(path, patience=patience).findings
            else:
                unpack(path, Path(place, "part"))
                found = of_group(Path(place, "part"), fault.group or ALONE, patience)
        except ModalFmuError as error:
            return {"refused": str(error)}
        return {finding.name: finding.got for finding in reversed(found)}


def of_group(folder: Path, group: str, patience: float) -> tuple[Finding, ...]:
    """In a process of its own, where the FMU's library is used; without it here, for FMPy loads slowly."""
    if group != ALONE:
        return run_group(folder, group, 24, patience).findings
    fmu = Fmu(folder, read_description(folder), 24, lambda text: None)
    return tuple(finding for check in GROUPS[ALONE] for finding in check.run(fmu))


def is_caught(fault: Fault, found: Mapping[str, str]) -> bool:
    """By its name."""
    return fault.finding in (found if fault.group else found.get("refused", ""))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("words", nargs="*")
    parser.add_argument("--all", action="store_true")
    given = parser.parse_args()
    start, caught, missed = time.perf_counter(), 0, []
    print("| fault | caught as | what was seen |\n|---|---|---|")
    for part, faults in FAULTS.items():
        chosen = [f for f in faults if not given.words or any(word in f.name for word in given.words)]
        with ThreadPoolExecutor(2) as pool:
            results = pool.map(lambda fault: findings(fault, everything=given.all), chosen)
            for fault, found in zip(chosen, results, strict=True):
                if is_caught(fault, found):
                    caught += 1
                    name = fault.finding if fault.group else "refused"
                    seen = found[name].partition(".fmu: ")[2] or found[name]
                else:
                    missed.append(fault)
                    name, seen = f"NOT CAUGHT as {fault.finding}", ", ".join(found) or "nothing found"
                print(f"| {part}: {fault.name} | {name} | {seen.replace('|', '/')} |", flush=True)
    print(f"\n{caught} of {caught + len(missed)} caught by name in {time.perf_counter() - start:.0f} s")


if __name__ == "__main__":
    main()
