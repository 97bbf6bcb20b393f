"""The entries of one matrix as a file lists them: A_ij = value."""

from dataclasses import dataclass
from typing import Literal

from .arrays import Floats, Ints
from .dof_table import DofTable


@dataclass(frozen=True)
class Entries:
    """A_ij = value, in the file's own units.

    row, col: (e,) from 0; value: (e,); size: rows of the matrix, which a file without a header shows only by
    its largest row number (`declared` is then false); precision: half a unit of the last digit that the file
    prints, relative to the entry; labels: node and direction of each row, where the file names them.
    repeated: what an entry that is listed twice means; triangle: the format lists one triangle only.
    """

    row: Ints
    col: Ints
    value: Floats
    size: int
    precision: float
    declared: bool = True
    labels: DofTable | None = None
    repeated: Literal["add", "refuse"] = "add"
    triangle: bool = False
