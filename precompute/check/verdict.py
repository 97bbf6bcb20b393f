"""All checks of one FMU."""

from collections.abc import Callable, Collection
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from .demands import DEMANDS
from .finding import Finding, Severity, Skipped
from .groups import ALONE, FIRST, GROUPS
from .process import Result, run_group
from .unpack import unpack

STEPS = 24  # of a run
PATIENCE = 60.0  # s for a group
SEVERITIES: tuple[Severity, ...] = ("error", "warning", "note")


@dataclass(frozen=True)
class Verdict:
    """findings: the gravest first; made: names of the checks that were made."""

    path: Path
    findings: tuple[Finding, ...]
    made: tuple[str, ...]
    skipped: tuple[Skipped, ...]

    @property
    def good(self) -> bool:
        """No errors and no warnings."""
        return all(DEMANDS[finding.name].severity == "note" for finding in self.findings)


def check_fmu(
    path: Path,
    steps: int = STEPS,
    patience: float = PATIENCE,
    groups: Collection[str] = tuple(GROUPS),
    progress: Callable[[str, float | None], None] = lambda stage, fraction: None,
) -> Verdict:
    """Drive an FMI 2.0 co-simulation FMU through its checks, each group in a process of its own.

    steps: of a run; patience: s that a group may take; groups: names of GROUPS.
    Raises ModalFmuError, in one line that begins with the file's name, where it is no such FMU.
    """
    with TemporaryDirectory(prefix="check", ignore_cleanup_errors=True) as place:
        folder = Path(place) / "fmu"
        unpack(path, folder)
        progress("checking", None)
        results = [run_group(folder, group, steps, patience) for group in (ALONE, FIRST)]
        others = [group for group in GROUPS if group not in (ALONE, FIRST) and group in groups]
        if any(DEMANDS[f.name].severity == "error" for f in results[1].findings):
            why = "the FMU does not get through its first step"
            results.append(
                Result((), (), tuple(Skipped(check.name, why) for group in others for check in GROUPS[group]))
            )
        else:
            with ThreadPoolExecutor(2) as pool:
                results += pool.map(lambda group: run_group(folder, group, steps, patience), others)
    found = dict.fromkeys(finding for result in results for finding in result.findings)
    return Verdict(
        path,
        tuple(sorted(found, key=lambda finding: SEVERITIES.index(DEMANDS[finding.name].severity))),
        tuple(name for result in results for name in result.made),
        tuple(skip for result in results for skip in result.skipped),
    )
