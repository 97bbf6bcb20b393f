"""Text matrices of Abaqus and CalculiX: "node, dof, node, dof, value" or "row column value" per line."""

from pathlib import Path

import numpy as np

from .arrays import Bools, Floats, Ints
from .dof_table import BEYOND, unlocated
from .errors import MatrixError
from .matrix_entries import Entries
from .number_lines import number_lines, numbers, precision

ELEMENTWISE = 6  # columns: the element, then the five of an entry


def read_text_matrix(path: Path) -> Entries:
    """A matrix without a header, by its number of columns.

    5: row node, its degree of freedom, column node, its degree of freedom, entry; one triangle, or both.
       Abaqus *MATRIX OUTPUT with FORMAT=MATRIX INPUT (the default) or LABELS
       (Abaqus Keywords Guide, *MATRIX INPUT; Analysis Guide, Generating matrices).
    3: row, column, entry, from 1. Abaqus FORMAT=COORDINATE lists both triangles; CalculiX
       SOLVER=MATRIXSTORAGE the upper one, column by column, zeros included (its 2.20 manual, *FREQUENCY).
    Such a file holds an assembled matrix, so that an entry that comes twice is a fault.
    Raises MatrixError: other columns, row numbers that are not 1, 2, …
    """
    table = numbers(path)
    if table.shape[1] == 5:
        return _labelled(table, precision(path))
    if table.shape[1] == 3:
        row, col = _integers(table[:, :2]).T - 1
        if min(row.min(), col.min()) < 0:
            raise MatrixError("got rows or columns below 1, expected 1, 2, …; export the matrix again")
        size = int(max(row.max(), col.max())) + 1
        return Entries(row, col, table[:, 2], size, precision(path), declared=False, repeated="refuse")
    if table.shape[1] == ELEMENTWISE:
        raise MatrixError("got matrices of single elements; leave ELEMENT BY ELEMENT out of *MATRIX GENERATE")
    raise MatrixError(
        f"got {table.shape[1]} numbers per line ({next(number_lines(path))[:40]!r}), expected "
        "row column value, or node dof node dof value"
    )


def _labelled(table: Floats, digits: float) -> Entries:
    """Rows in the order of node and degree of freedom; the triangle is one of the program's own order."""
    labels = _integers(table[:, :4])
    node, direction = labels[:, [0, 2]].T.ravel(), labels[:, [1, 3]].T.ravel() - 1
    pairs, rows = np.unique(np.stack([node, direction]), axis=1, return_inverse=True)
    row, col = rows.reshape(2, -1)
    return Entries(
        row, col, table[:, 4], pairs.shape[1], digits, False, unlocated(*pairs), "refuse", triangle=True
    )


def _integers(table: Floats) -> Ints:
    whole: Bools = (table == np.rint(table)) & (np.abs(table) < BEYOND)
    if not whole.all():
        raise MatrixError(
            f"got {table[~whole][0]:g} for a row, node or degree of freedom, expected a whole number below "
            f"{BEYOND:.0e}; export the matrix again"
        )
    return table.astype(np.int64)
