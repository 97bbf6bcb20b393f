"""Which node and direction each row of exported matrices is."""

import csv
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .arrays import Floats, Ints
from .dofs import DIRECTIONS
from .errors import MatrixError
from .number_lines import COMMENTS, number_lines

BEYOND = 10**15  # of node numbers; what a row has, 6·node + direction, is a 64-bit integer
WHOLE = re.compile(r"[0-9]{1,15}")
CALCULIX = re.compile(r"([0-9]{1,15})\.([0-9]{1,15})")
ANSYS_DIRECTIONS = ("UX", "UY", "UZ", "ROTX", "ROTY", "ROTZ")
HEADER = "node,direction[,x,y,z]"


@dataclass(frozen=True)
class DofTable:
    """Row d is direction[d] (0 … 5: x y z rx ry rz) of the node numbered node[d].

    node, direction: (n,); points: (n, 3) coordinates of the row's node in the file's length unit, NaN where
    they are not known.
    Raises MatrixError: a row twice, a direction beyond 0 … 5, a node number that is not positive.
    """

    node: Ints
    direction: Ints
    points: Floats

    def __post_init__(self) -> None:
        strange = np.flatnonzero((self.direction < 0) | (self.direction > 5))
        if strange.size:
            d = strange[0]
            raise MatrixError(
                f"row {d + 1}: got degree of freedom {self.direction[d] + 1} of node {self.node[d]}, "
                "expected 1 to 6; export displacements and rotations only"
            )
        internal = np.unique(self.node[self.node < 1])
        if internal.size:
            raise MatrixError(
                f"got {internal.size} nodes with numbers below 1, the first is {internal[0]}: internal ones, "
                "whose motions have no direction; use elements without internal nodes"
            )
        keys = self.keys
        order = np.argsort(keys, kind="stable")
        twice = np.flatnonzero(np.diff(keys[order]) == 0)
        if twice.size:
            a, b = np.sort(order[twice[0] : twice[0] + 2])
            raise MatrixError(
                f"rows {a + 1} and {b + 1} are both node {self.node[a]} {DIRECTIONS[self.direction[a]]}, "
                "expected each motion once; export solid elements (CalculiX expands beams and shells to "
                "solids whose nodes have no numbers of their own), and one model only"
            )

    @property
    def keys(self) -> Ints:
        """6·node + direction: (n,)."""
        return np.asarray(6 * self.node + self.direction, dtype=np.int64)


def unlocated(node: Ints, direction: Ints) -> DofTable:
    """A table that knows no coordinates."""
    return DofTable(node, direction, np.full((len(node), 3), np.nan))


def read_dof_table(path: Path, size: int) -> DofTable:
    """The table of `size` rows in a file, by its content one of

    - CSV with the header node,direction and optionally x,y,z; direction x y z rx ry rz or 1 … 6;
    - CalculiX job.dof, a line "node.direction" per row (CalculiX 2.20 manual, *FREQUENCY);
    - Ansys Fname.mapping, "Matrix Eqn  Node  DOF" with UX … ROTZ (Mechanical APDL command reference, HBMAT);
    - Ansys nodal mapping vector in Matrix Market form, one node per line whose directions follow each other
      (Mechanical APDL, *VEC,…,IMPORT,FULL,…,BACK and *EXPORT,…,MMF).
    Raises MatrixError: none of these, a line that cannot be read, a wrong number of rows, a motion twice.
    """
    with path.open(encoding="latin-1") as file:
        first = next((line.strip() for line in file if line.strip()), "")
    if first.lower().startswith("%%matrixmarket"):
        return _nodal_vector(path, size)
    if first.split()[:2] == ["Matrix", "Eqn"]:
        table = _ansys(path)
    elif CALCULIX.fullmatch(first):
        table = _calculix(path)
    else:
        table = _csv(path)
    if len(table.node) != size:
        raise MatrixError(
            f"got {len(table.node)} rows, expected {size}, those of the matrices; one line each"
        )
    return table


def _calculix(path: Path) -> DofTable:
    lines = path.read_text(encoding="latin-1").split()
    for k, text in enumerate(lines, 1):
        if not CALCULIX.fullmatch(text):
            raise MatrixError(f"line {k}: got {text[:40]!r}, expected node.direction such as 21.3")
    pairs = np.array([text.split(".") for text in lines], dtype=np.int64)
    return unlocated(pairs[:, 0], pairs[:, 1] - 1)


def _ansys(path: Path) -> DofTable:
    rows = []
    for k, text in enumerate(path.read_text(encoding="latin-1").splitlines()[1:], 2):
        fields = text.split()
        if not fields:
            continue
        if len(fields) != 3 or not (WHOLE.fullmatch(fields[0]) and WHOLE.fullmatch(fields[1])):
            raise MatrixError(f"line {k}: got {text.strip()[:40]!r}, expected equation, node, DOF")
        if fields[2] not in ANSYS_DIRECTIONS:
            raise MatrixError(
                f"line {k}: got DOF {fields[2]!r}, expected one of {', '.join(ANSYS_DIRECTIONS)}; "
                "export a structural model"
            )
        rows.append((int(fields[0]), int(fields[1]), ANSYS_DIRECTIONS.index(fields[2])))
    equation, node, direction = np.array(rows, dtype=np.int64).reshape(-1, 3).T
    if not np.array_equal(equation, np.arange(1, len(equation) + 1)):
        raise MatrixError("got equation numbers that do not run 1, 2, 3, …; export the mapping again")
    return unlocated(node, direction)


def _nodal_vector(path: Path, size: int) -> DofTable:
    shape, *lines = [*number_lines(path)] or ["no size"]
    try:
        node = np.array(lines, dtype=np.int64)
    except (ValueError, OverflowError):
        raise MatrixError("got lines that are not one node number each; export the nodal mapping") from None
    each = size // max(len(node), 1)
    if each not in (3, 6) or each * len(node) != size:
        raise MatrixError(
            f"got {len(node)} nodes ({shape}) for {size} rows, expected 3 or 6 rows per node; without "
            "supports only, else write the mapping by HBMAT"
        )
    return unlocated(np.repeat(node, each), np.tile(np.arange(each), len(node)))


def _csv(path: Path) -> DofTable:
    with path.open(encoding="utf-8-sig", errors="replace", newline="") as file:
        kept = [line for line in file if line.strip() and not line.lstrip().startswith(COMMENTS)]
    try:
        records = list(csv.reader(kept, skipinitialspace=True))
    except csv.Error as error:
        raise MatrixError(f"got no table ({error}), expected {HEADER} and one line per row") from None
    header = [name.strip().lower() for name in records[0]] if records else []
    if sorted(header) not in (["direction", "node"], ["direction", "node", "x", "y", "z"]):
        got = ",".join(header)[:60]
        raise MatrixError(
            f"got the header {got!r}, expected {HEADER} and then one line per row of the matrices"
        )
    rows = [_csv_row(k, record, header) for k, record in enumerate(records[1:], 1)]
    return DofTable(
        np.array([row[0] for row in rows], dtype=np.int64),
        np.array([row[1] for row in rows], dtype=np.int64),
        np.array([row[2] for row in rows]).reshape(-1, 3),
    )


def _csv_row(k: int, record: Sequence[str], header: Sequence[str]) -> tuple[int, int, tuple[float, ...]]:
    fields = [field.strip().lower() for field in record]
    if len(fields) != len(header):
        raise MatrixError(f"row {k}: got {len(fields)} fields, expected {len(header)}: {','.join(header)}")
    row = dict(zip(header, fields, strict=True))
    node, direction = row["node"], row["direction"]
    if not WHOLE.fullmatch(node):
        raise MatrixError(f"row {k}: got node {node!r}, expected a number such as 17")
    if direction not in DIRECTIONS and not WHOLE.fullmatch(direction):
        raise MatrixError(f"row {k}: got direction {direction!r}, expected {' '.join(DIRECTIONS)} or 1 to 6")
    try:
        point = tuple(float(row.get(axis) or "nan") for axis in "xyz")
    except ValueError:
        point = (math.inf,)
    if any(map(math.isinf, point)):
        raise MatrixError(f"row {k}: got {','.join(record)[:60]!r}, expected numbers for x, y, z")
    return int(node), DIRECTIONS.index(direction) if direction in DIRECTIONS else int(direction) - 1, point
