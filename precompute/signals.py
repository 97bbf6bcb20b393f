"""Input signals over time, from a CSV file: time,tip.force.z,…"""

import csv
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .errors import ModalFmuError
from .fmu_face import Face, check_known


def read_signals(path: Path, face: Face) -> NDArray[Any]:
    """The structured array that FMPy takes as input: a field `time` (s), one per column, SI units.

    Columns are inputs of the FMU or parameters that may change at run time. Two rows of one time are a jump.
    Raises ModalFmuError, beginning with the file's name and line: no such file, no time, a column that
    the FMU does not have, a cell that is no finite number, a row too short or too long, time that goes back.
    """
    rows = _rows(path)
    (_, header), *body = rows
    names = [name.strip() for name in header]
    known = [*face.inputs, *(name for name, v in face.variables.items() if _tunable(v))]
    if names[0] != "time":
        hint = "; separate the columns by commas" if ";" in header[0] or "\t" in header[0] else ""
        raise ModalFmuError(f"{path.name}: the first column is {header[0]!r}, expected 'time'{hint}")
    for name in names[1:]:
        check_known(f"{path.name}: the FMU has no input {name!r}", name, known)
        if names.count(name) > 1:
            raise ModalFmuError(f"{path.name}: got the column {name!r} twice, expected it once")
    if not body:
        raise ModalFmuError(f"{path.name}: got no row below the header, expected at least one")
    table = np.array([_row(path, line, cells, names) for line, cells in body])
    back = np.flatnonzero(np.diff(table[:, 0]) < 0)
    if back.size:
        before, after = table[back[0] : back[0] + 2, 0]
        raise ModalFmuError(
            f"{path.name}: line {body[back[0] + 1][0]}: time goes back from {before:g} to {after:g}; "
            "sort the rows"
        )
    return signals_of(names, table)


def signals_of(names: Sequence[str], table: NDArray[Any]) -> NDArray[Any]:
    """Columns (n, k) under their names."""
    signals = np.zeros(len(table), dtype=[(name, np.float64) for name in names])
    for name, column in zip(names, table.T, strict=True):
        signals[name] = column
    return signals


def _tunable(variable: Any) -> bool:
    return bool(variable.causality == "parameter" and variable.variability == "tunable")


def _rows(path: Path) -> list[tuple[int, list[str]]]:
    """Lines that are not empty, with their numbers."""
    try:
        with path.open(newline="", encoding="utf-8-sig") as stream:
            reader = csv.reader(stream, skipinitialspace=True)
            rows = [(reader.line_num, row) for row in reader if any(cell.strip() for cell in row)]
    except OSError as error:
        raise ModalFmuError(f"{path}: cannot be read ({error.strerror})") from None
    except (UnicodeDecodeError, csv.Error) as error:
        raise ModalFmuError(f"{path.name}: got no CSV text ({error}); save it as UTF-8") from None
    if not rows:
        raise ModalFmuError(f"{path.name}: the file is empty, expected a header such as time,tip.force.z")
    return rows


def _row(path: Path, line: int, cells: list[str], names: list[str]) -> list[float]:
    if len(cells) != len(names):
        raise ModalFmuError(f"{path.name}: line {line}: got {len(cells)} cells, expected {len(names)}")
    values = []
    for name, cell in zip(names, cells, strict=True):
        try:
            value = float(cell)
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            raise ModalFmuError(f"{path.name}: line {line}: {name} is {cell!r}, expected a finite number")
        values.append(value)
    return values
