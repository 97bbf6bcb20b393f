"""Matrices in the Matrix Market exchange format, as SciPy, MATLAB tools and Ansys write it."""

from pathlib import Path

import numpy as np

from .arrays import Floats
from .errors import MatrixError
from .matrix_entries import Entries
from .number_lines import number_lines, numbers, precision

BANNER = "%%matrixmarket"


def read_matrix_market(path: Path) -> Entries:
    """A real or integer, general or symmetric, square matrix; coordinate or array.

    Source: Boisvert, Pozo, Remington, The Matrix Market Exchange Formats, NISTIR 5935, 1996. Ansys writes it
    by *EXPORT,…,MMF, one triangle under "symmetric" (Mechanical APDL command reference).
    Entries are listed as they stand: a reader that mirrors whatever is called symmetric would double the
    files that hold both triangles under this name.
    Raises MatrixError: another kind of matrix, not square, more or fewer entries than the header says.
    """
    with path.open(encoding="latin-1") as file:
        banner = file.readline().lower().split()
    if len(banner) != 5 or banner[1] != "matrix" or banner[2] not in ("coordinate", "array"):
        raise MatrixError(
            f"got the header {' '.join(banner)[:60]!r}, expected %%MatrixMarket matrix coordinate …"
        )
    _, _, layout, field, symmetry = banner
    if field not in ("real", "double", "integer") or symmetry not in ("general", "symmetric"):
        raise MatrixError(
            f"got a {field} {symmetry} matrix, expected a real one, general or symmetric; "
            "export K, M and D apart (structural damping belongs in the part file)"
        )
    sizes = next(number_lines(path), "").split()
    if len(sizes) != (3 if layout == "coordinate" else 2) or not all(s.isdecimal() for s in sizes):
        raise MatrixError(f"got {' '.join(sizes)[:60]!r} where the size is expected; is the file cut off?")
    rows, columns = int(sizes[0]), int(sizes[1])
    if rows != columns or rows == 0:
        raise MatrixError(f"got a {rows} × {columns} matrix, expected a square one; is it a load vector?")
    skip = _line_after_size(path)
    if layout == "array":
        return _array(numbers(path, skip), rows, symmetry == "symmetric", precision(path, skip))
    table = numbers(path, skip)
    if table.shape != (int(sizes[2]), 3):
        raise MatrixError(
            f"got {len(table)} entries, expected {sizes[2]} of row, column, value; export the matrix again"
        )
    row, col = np.rint(table[:, :2]).astype(np.int64).T
    if (
        not np.array_equal(table[:, :2].T, [row, col])
        or min(row.min(), col.min()) < 1
        or max(row.max(), col.max()) > rows
    ):
        raise MatrixError(f"got entries outside rows and columns 1 to {rows}; export the matrix again")
    return Entries(
        row - 1, col - 1, table[:, 2], rows, precision(path, skip), triangle=symmetry == "symmetric"
    )


def _line_after_size(path: Path) -> int:
    """How many lines the header takes: comments, then the size."""
    with path.open(encoding="latin-1") as file:
        for k, line in enumerate(file, 1):
            if line.strip() and not line.startswith("%"):
                return k
    return 0


def _array(table: Floats, n: int, symmetric: bool, digits: float) -> Entries:
    """Column by column; a symmetric array lists its lower triangle."""
    entries = n * (n + 1) // 2 if symmetric else n * n
    if table.shape != (entries, 1):
        raise MatrixError(f"got {table.size} entries, expected {entries}; export the matrix again")
    col, row = np.triu_indices(n) if symmetric else np.divmod(np.arange(n * n), n)
    return Entries(row, col, table[:, 0], n, digits, triangle=symmetric)
