"""Lines of numbers: text files of matrices, and how many digits they print."""

import re
from collections.abc import Iterator
from itertools import islice
from pathlib import Path

import numpy as np

from .arrays import Floats
from .errors import MatrixError
from .rounding import EPS

COMMENTS = ("%", "#", "**")
SAMPLE = 2000  # lines whose digits are counted
FEWEST = 5  # digits: shorter numbers (200, 0.5) are exact ones rather than rounded

_MANTISSA = re.compile(r"[-+]?(\d*)\.?(\d*)")


def number_lines(path: Path, skip: int = 0) -> Iterator[str]:
    """The lines of a text file after the first `skip`, without comments and blank lines, commas as spaces."""
    with path.open(encoding="latin-1") as file:
        for line in islice(file, skip, None):
            text = line.strip()
            if text and not text.startswith(COMMENTS):
                yield text.replace(",", " ").replace("D", "E")  # 1.0D+05 is a Fortran double


def numbers(path: Path, skip: int = 0) -> Floats:
    """All numbers of the file, one row per line: (lines, columns).

    Raises MatrixError: a line that is not numbers, lines of different length.
    """
    first = next(number_lines(path, skip), None)
    if first is None:
        raise MatrixError("got no entries; export the matrix again")
    columns = len(first.split())
    if not _all_numbers(first, columns):
        raise MatrixError(
            f"got the line {first[:60]!r}, expected a matrix: Matrix Market, lines of row column value or of "
            "node dof node dof value, or .npz"
        )
    try:
        table = np.loadtxt(number_lines(path, skip), comments=None, ndmin=2)
    except ValueError as error:
        for text in number_lines(path, skip):
            if not _all_numbers(text, columns):
                raise MatrixError(
                    f"got the line {text[:60]!r}, expected {columns} numbers as in the first line of entries "
                    f"{first[:60]!r}; is the file cut off or of another format?"
                ) from None
        raise MatrixError(f"got lines that are not all numbers ({error}); export the matrix again") from None
    return np.asarray(table, dtype=np.float64)


def _all_numbers(text: str, columns: int) -> bool:
    fields = text.split()
    try:
        return len([float(field) for field in fields]) == columns
    except ValueError:
        return False


def precision(path: Path, skip: int = 0) -> float:
    """ε + ½·10^(1−d): the relative rounding of numbers with d digits, the most in the last column.

    Numbers of less than five digits throughout count as exact, with ε alone.
    """
    digits = max((_digits(line.split()[-1]) for line in islice(number_lines(path, skip), SAMPLE)), default=0)
    return EPS if digits < FEWEST else EPS + 0.5 * 10.0 ** (1 - digits)


def _digits(number: str) -> int:
    """Significant digits as printed, trailing zeros after the point included: 1.250e3 has four."""
    mantissa = _MANTISSA.match(number)
    return len("".join(mantissa.groups()).lstrip("0")) if mantissa else 0
