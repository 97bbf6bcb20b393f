"""A verdict as a person reads it, and as a program does."""

from typing import Any

from rich.console import RenderableType
from rich.table import Table

from .demands import DEMANDS
from .verdict import Verdict


def tables(verdict: Verdict) -> list[RenderableType]:
    """What was found, its place in the standard and its remedy; what could not be checked; the verdict."""
    shown: list[RenderableType] = []
    if verdict.findings:
        table = Table(
            "",
            "finding",
            "what was seen",
            "FMI 2.0.4 demands",
            "how to mend it",
            box=None,
            padding=(0, 2, 0, 0),
        )
        for finding in verdict.findings:
            demand = DEMANDS[finding.name]
            table.add_row(
                demand.severity, finding.name, finding.got, f"{demand.demands} ({demand.clause})", demand.mend
            )
        shown += [table, ""]
    shown += [f"not checked: {skip.check} ({skip.why})" for skip in verdict.skipped]
    return [*shown, summary(verdict)]


def summary(verdict: Verdict) -> str:
    """The verdict in one line."""
    counts = {
        severity: sum(DEMANDS[finding.name].severity == severity for finding in verdict.findings)
        for severity in ("error", "warning", "note")
    }
    made = f"{len(verdict.made)} checks made, {len(verdict.skipped)} not"
    found = (
        ", ".join(f"{n} {severity}{'s' * (n != 1)}" for severity, n in counts.items() if n) or "nothing found"
    )
    return f"{verdict.path.name}: {found}; {made}"


def as_json(verdict: Verdict) -> dict[str, Any]:
    """The same for programs."""
    return {
        "fmu": str(verdict.path),
        "good": verdict.good,
        "findings": [
            {
                "name": finding.name,
                "severity": DEMANDS[finding.name].severity,
                "got": finding.got,
                "demands": DEMANDS[finding.name].demands,
                "clause": DEMANDS[finding.name].clause,
                "mend": DEMANDS[finding.name].mend,
            }
            for finding in verdict.findings
        ],
        "checked": list(verdict.made),
        "not_checked": [{"check": skip.check, "why": skip.why} for skip in verdict.skipped],
    }
