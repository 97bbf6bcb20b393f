"""Tables as they stand in the READMEs."""

from collections.abc import Mapping, Sequence
from math import isinf


def markdown(rows: Sequence[Mapping[str, str]]) -> str:
    """The rows under the keys of the first one."""
    cells = [[*rows[0]], ["---"] * len(rows[0]), *([*row.values()] for row in rows)]
    return "\n".join("| " + " | ".join(row) + " |" for row in cells)


def largest(step: float, unit: float) -> str:
    """A largest stable step in s, in the unit; "any" where there is none."""
    return "any" if isinf(step) else f"{step / unit:.3g}"
