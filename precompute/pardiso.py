"""A = L D Lᵀ by PARDISO of Intel MKL, which pypardiso brings and finds."""

import ctypes
import os
import sys
from functools import cache
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from .arrays import Floats
from .errors import EigenError

Ints32: TypeAlias = NDArray[np.int32]

SYMMETRIC = -2  # matrix type: its pivots give the inertia, which type 2 (positive definite) does not
ANALYSE, FACTORISE, SOLVE, RELEASE = 11, 22, 33, -1  # phases
MEANING = {-2: "not enough memory", -4: "zero pivot", -8: "too many entries for 32-bit indices"}


@cache
def library() -> Any:
    """The MKL runtime. Raises ImportError where pypardiso or MKL is missing."""
    os.environ.setdefault("KMP_BLOCKTIME", "0")  # idle MKL threads sleep; it is read when MKL is loaded
    runtime = [*Path(sys.prefix).glob("lib/libmkl_rt.so*"), *Path(sys.prefix).glob("Library/bin/mkl_rt*.dll")]
    if runtime:  # without a hint pypardiso searches the whole environment, a quarter of a second
        os.environ.setdefault("PYPARDISO_MKL_RT", str(runtime[0]))
    from pypardiso import ps

    return ps.libmkl


class Pardiso:
    """The factor of one symmetric matrix at a time; a matrix of the same pattern reuses the ordering.

    A handle to memory of MKL's: release() frees it.
    """

    name = "PARDISO"

    def __init__(self) -> None:
        self._call = library()["pardiso"]  # not the attribute: pypardiso sets argument types of that one
        self._handle = np.zeros(64, dtype=np.int64)
        self._iparm = np.zeros(64, dtype=np.int32)
        self._iparm[0] = 1  # nothing by default
        self._iparm[1] = 2  # METIS; its parallel form does not reproduce its result
        self._iparm[9] = 30  # perturb no pivot above 1e-30 ‖A‖: soft modes of slender parts give small ones
        self._iparm[20] = 1  # Bunch–Kaufman pivots, 1×1 and 2×2
        self._iparm[23] = 1  # two-level factorisation: the same bits from run to run, the classic one differs
        self._values = np.zeros(0)
        self._starts = np.zeros(0, dtype=np.int32)
        self._columns = np.zeros(0, dtype=np.int32)

    def factorise(self, A: csr_array) -> "Pardiso":
        """A = L D Lᵀ; A (n, n) symmetric. Frees the factor before. Raises EigenError: memory, zero pivot."""
        starts, columns, values = _upper(A)
        if np.any(A.diagonal() == 0):  # PARDISO needs every diagonal entry to be stored
            raise EigenError("PARDISO: got a zero on the diagonal; expected stiffness or mass at every DOF")
        self._values = values
        if not (np.array_equal(starts, self._starts) and np.array_equal(columns, self._columns)):
            self.release()
            self._starts, self._columns = starts, columns
            self._run(ANALYSE)
        self._run(FACTORISE)
        return self

    def solve(self, b: Floats) -> Floats:
        """x = A⁻¹ b for b (n,) or (n, m); many columns at once are much cheaper than one by one."""
        if len(b) != len(self._starts) - 1:  # MKL would read beyond the array
            raise EigenError(f"PARDISO: got a right side of {len(b)} rows, expected {len(self._starts) - 1}")
        return self._run(SOLVE, np.asfortranarray(b, dtype=np.float64))

    def negative_pivots(self) -> int | None:
        """The number of negative eigenvalues of A (Sylvester); none where a pivot had to be perturbed."""
        return None if self._iparm[13] else int(self._iparm[22])

    def release(self) -> None:
        """Free all memory of the factor."""
        if self._handle.any():
            self._run(RELEASE)
            self._handle[:] = 0

    def _run(self, phase: int, b: Floats | None = None) -> Floats:
        right = np.zeros(1) if b is None else b
        x = np.zeros_like(right)
        error = ctypes.c_int32(0)
        columns = right.shape[1] if right.ndim == 2 else 1
        self._call(
            _at(self._handle), _int(1), _int(1), _int(SYMMETRIC), _int(phase), _int(len(self._starts) - 1),
            _at(self._values), _at(self._starts), _at(self._columns), None, _int(columns),
            _at(self._iparm), _int(0), _at(right), _at(x), ctypes.byref(error),
        )  # fmt: skip  # the order of the manual, a line per group
        if error.value:
            meaning = MEANING.get(error.value, "see the manual of oneMKL PARDISO")
            raise EigenError(f'PARDISO: error {error.value} ({meaning}); the other solver is "superlu"')
        return x


def _upper(A: csr_array) -> tuple[Ints32, Ints32, Floats]:
    """Row starts and columns from 1, and values, of the triangle j ≥ i; much quicker than scipy's triu."""
    A.sort_indices()
    rows = np.repeat(np.arange(A.shape[0], dtype=A.indices.dtype), np.diff(A.indptr))
    upper = A.indices >= rows
    starts = np.concatenate([[0], np.cumsum(upper)])[A.indptr]
    return starts.astype(np.int32) + 1, A.indices[upper].astype(np.int32) + 1, A.data[upper]


def _at(array: Any) -> ctypes.c_void_p:
    return ctypes.c_void_p(array.ctypes.data)


def _int(value: int) -> Any:
    return ctypes.byref(ctypes.c_int32(value))
