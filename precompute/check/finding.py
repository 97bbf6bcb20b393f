"""What a check found, and what it could not check."""

from dataclasses import dataclass
from typing import Literal

Severity = Literal["error", "warning", "note"]


@dataclass(frozen=True)
class Demand:
    """One thing that is demanded of an FMU.

    error: a master that keeps to the standard gets wrong numbers, or none; warning: a mistake of a master
    passes unseen, or a number is doubtful; note: legal, but worth knowing.
    clause: where FMI 2.0.4 says it; mend: what its maker can do.
    """

    severity: Severity
    clause: str
    demands: str
    mend: str


@dataclass(frozen=True)
class Finding:
    """A demand, by its name in `demands.DEMANDS`, that is not met; got: what was seen, in one line."""

    name: str
    got: str


@dataclass(frozen=True)
class Skipped:
    """A check that was not made, and why."""

    check: str
    why: str
