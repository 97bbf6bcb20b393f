"""Sparse matrices that scipy.sparse.save_npz wrote."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from .arrays import Ints
from .errors import MatrixError
from .matrix_entries import Entries
from .rounding import EPS

FORMATS = ("csr", "csc", "coo")


def read_npz(path: Path) -> Entries:
    """The entries of a CSR, CSC or COO matrix, checked index by index before anything is built of them.

    Source: SciPy reference, scipy.sparse.save_npz. Pickled objects are not loaded.
    Raises MatrixError: not such a file, another layout, complex entries, indices out of range.
    """
    try:
        with np.load(path, allow_pickle=False) as archive:
            arrays = {key: archive[key] for key in archive.files}
    except Exception as error:  # noqa: BLE001  zipfile, zlib and NumPy raise a dozen kinds for a damaged file
        raise MatrixError(f"got no readable .npz file ({error}); write it by scipy.sparse.save_npz") from None
    layout = _layout(arrays)
    rows, columns = (int(size) for size in arrays["shape"])
    if rows != columns or rows == 0:
        raise MatrixError(f"got a {rows} × {columns} matrix, expected a square one")
    value = arrays["data"]
    if value.ndim != 1 or value.dtype.kind not in "fiu":
        raise MatrixError(
            f"got entries of type {value.dtype}, shape {value.shape}; expected real ones, a row; "
            "save K, M and D apart"
        )
    row, col = _indices(layout, arrays, rows, len(value))
    digits = float(np.finfo(value.dtype).eps) if value.dtype.kind == "f" else EPS
    return Entries(row, col, value.astype(np.float64), rows, max(digits, EPS))


def _layout(arrays: Mapping[str, Any]) -> str:
    given = arrays.get("format", np.array(""))
    layout = given.item() if given.ndim == 0 else ""
    layout = layout.decode("ascii", "replace") if isinstance(layout, bytes) else str(layout)
    wanted = {"shape", "data", *(("row", "col") if layout == "coo" else ("indices", "indptr"))}
    if layout not in FORMATS or not wanted <= set(arrays) or np.shape(arrays["shape"]) != (2,):
        raise MatrixError(
            f"got the arrays {', '.join(sorted(arrays))[:60]} of layout {layout!r}, expected those of a "
            f"sparse matrix in {', '.join(FORMATS)}; save csr_array(A) by scipy.sparse.save_npz"
        )
    return layout


def _indices(layout: str, arrays: Mapping[str, Any], n: int, entries: int) -> tuple[Ints, Ints]:
    names = ("row", "col") if layout == "coo" else ("indices", "indptr")
    a, b = (np.asarray(arrays[name]) for name in names)
    if any(x.ndim != 1 or x.dtype.kind not in "iu" for x in (a, b)):
        raise MatrixError(
            f"got {names[0]} or {names[1]} that is no row of whole numbers; save the matrix again"
        )
    if layout != "coo":
        pointers = b.astype(np.int64)
        steps = np.diff(pointers)
        if len(pointers) != n + 1 or pointers[0] != 0 or pointers[-1] != entries or np.any(steps < 0):
            raise MatrixError(
                f"got indptr that does not lead from 0 to {entries} in {n} steps; save it again"
            )
        b = np.repeat(np.arange(n), steps)
    if len(a) != entries or len(b) != entries or np.any((a < 0) | (a >= n)) or np.any((b < 0) | (b >= n)):
        raise MatrixError(f"got indices outside 0 to {n - 1}, or not one per entry; save the matrix again")
    inner, outer = a.astype(np.int64), b.astype(np.int64)
    return (outer, inner) if layout == "csr" else (inner, outer)
