"""A symmetric sparse matrix from its entries: A_ij = A_ji."""

import numpy as np
from scipy.sparse import coo_array, csr_array

from .arrays import Bools, Floats, Ints
from .errors import MatrixError
from .matrix_entries import Entries
from .notice import notice

ROUNDING = 1e-12  # of √(A_ii A_jj): what two ways of summing the same cells may differ by
LARGEST = 1e100  # of entries, in any units; products of three stay finite


def symmetric_matrix(entries: Entries, name: str) -> csr_array:
    """A (n, n) in the file's units, exactly symmetric, indices sorted.

    A matrix of which each pair (i, j), (j, i) is there once is one triangle, of whatever order of rows, and
    is completed; one with all pairs whole is symmetric within the digits printed. Entries that are listed
    twice are added, or refused where the format never lists them so.
    name: of the file, for notices.
    Raises MatrixError: entries that are not finite, repeated ones, pairs of both kinds, no symmetry.
    """
    n = entries.size
    row, col, value = _summed(entries, name)
    keys = row * n + col  # ascending
    place = np.minimum(np.searchsorted(keys, col * n + row), len(keys) - 1)
    mirror: Floats = np.where(keys[place] == col * n + row, value[place], 0.0)
    diagonal = np.bincount(row[row == col], np.abs(value[row == col]), minlength=n)
    rounding = ROUNDING * np.sqrt(diagonal[row] * diagonal[col])
    off: Bools = (row != col) & (np.abs(value) > rounding)
    single = off & (mirror == 0.0)
    if single.any() and np.array_equal(single, off):
        if not entries.triangle:
            notice(f"{name} holds one triangle; the other was taken as its mirror image")
        below = row != col
        row, col = np.concatenate([row, col[below]]), np.concatenate([col, row[below]])
        value = np.concatenate([value, value[below]])
    elif single.any():
        raise MatrixError(
            f"got {single.sum()} entries A_ij without A_ji and {off.sum() - single.sum()} with it; "
            "export either one triangle or the whole symmetric matrix"
        )
    else:
        allowed = 2 * entries.precision * (np.abs(value) + np.abs(mirror)) + rounding
        _check_symmetry(row, col, value, mirror, allowed)
        value = 0.5 * (value + mirror)
    A = csr_array(coo_array((value, (row, col)), shape=(n, n)))
    A.sort_indices()
    return A


def _summed(entries: Entries, name: str) -> tuple[Ints, Ints, Floats]:
    """Row, column and value, in the order of rows and columns, each pair once, without zeros."""
    n, row, col, value = entries.size, entries.row, entries.col, entries.value
    astray = np.flatnonzero(~np.isfinite(value))
    if astray.size:
        k = astray[0]
        raise MatrixError(
            f"got {value[k]} in row {row[k] + 1}, column {col[k] + 1}, expected finite numbers; "
            f"{astray.size} of {len(value)} entries are not; export the matrix again"
        )
    keys, first, rank = np.unique(row * n + col, return_index=True, return_inverse=True)
    again = len(row) - len(keys)
    if again and entries.repeated == "refuse":
        k = int(np.setdiff1d(np.arange(len(row)), first)[0])
        raise MatrixError(
            f"{again} entries are listed more than once, the first is row {row[k] + 1}, column {col[k] + 1}; "
            "an assembled matrix lists each once, so export it into a new file"
        )
    if again:
        notice(f"{name}: {again} entries are listed more than once; they were added up")
    total = np.bincount(rank, value, minlength=len(keys))
    some = total != 0.0
    if not some.any():
        raise MatrixError("got zeros only; export the matrix again")
    largest = float(np.max(np.abs(total)))
    if not 1 / LARGEST < largest < LARGEST:
        raise MatrixError(
            f"got entries up to {largest:.3g}, expected {1 / LARGEST:.0e} to {LARGEST:.0e}, as in any units; "
            "export the matrix again"
        )
    i, j = np.divmod(keys[some], n)
    return i, j, total[some]


def _check_symmetry(row: Ints, col: Ints, value: Floats, mirror: Floats, allowed: Floats) -> None:
    difference = np.abs(value - mirror)
    wrong = difference > allowed
    if wrong.any():
        k = int(np.argmax(np.where(wrong, difference, 0.0)))
        raise MatrixError(
            f"not symmetric: row {row[k] + 1}, column {col[k] + 1} is {value[k]:g}, its mirror image "
            f"{mirror[k]:g}; export without friction, follower loads and gyroscopic terms"
        )
