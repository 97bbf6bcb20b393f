"""The process in which an FMU is driven: python -m precompute.check.child FMU WORK GROUP STEPS [CHECK …]

FMU: the unpacked folder; WORK: where the journal and the results go, a line of JSON each;
CHECK …: those that are made already.
"""

import json
import os
import sys
from collections.abc import Mapping
from pathlib import Path

from .description import read_description
from .driver import Ended, Fmu, NotLoaded, OnlyOnce, Refused
from .finding import Finding
from .groups import GROUPS
from .journal import Journal

FAULT = "a fault of the check itself"
END, AGAIN = "end", "again"  # told when all checks are made, and where the rest needs a new process


def main(folder: str, work: str, group: str, steps: str, *done: str) -> None:
    """Make the checks of a group; where the FMU takes the process along, the lines tell how far it was."""
    description = read_description(Path(folder))
    journal = Journal(Path(work) / "journal")
    with (Path(work) / "results").open("a", encoding="utf-8", buffering=1) as results:

        def tell(line: Mapping[str, str]) -> None:
            results.write(json.dumps(line) + "\n")

        fmu = Fmu(Path(folder), description, int(steps), journal.note)
        for check in GROUPS[group]:
            if check.name in done:
                continue
            if fmu.spent:
                tell({"check": AGAIN})
                return
            tell({"check": check.name})
            why = check.hindrance(description)
            if why is not None:
                tell({"skipped": check.name, "why": why})
                continue
            try:
                for finding in check.run(fmu):
                    tell({"finding": finding.name, "got": finding.got})
            except Refused as refused:
                finding = Finding("legal-call-refused", str(refused))
                tell({"finding": finding.name, "got": finding.got})
            except NotLoaded as error:
                tell({"finding": "library-loads", "got": str(error)})
            except OnlyOnce:
                tell({"skipped": check.name, "why": "canBeInstantiatedOnlyOncePerProcess is declared"})
            except Ended:
                tell({"skipped": check.name, "why": "the FMU ends the simulation before"})
            except OSError as error:
                if sys.platform != "win32":
                    tell({"skipped": check.name, "why": f"{FAULT}: {error!r}"})
                else:  # there it is what ctypes makes of an access violation
                    tell({"finding": check.crash, "got": f"{error}, in the check {check.name}"})
            except Exception as error:  # noqa: BLE001  one check that is at fault must not silence the others
                tell({"skipped": check.name, "why": f"{FAULT}: {error!r}"})
        tell({"check": END})


if __name__ == "__main__":
    main(*sys.argv[1:])
    sys.stdout.flush()
    os._exit(0)  # what an unloaded FMU does to the interpreter is no concern of the checks
