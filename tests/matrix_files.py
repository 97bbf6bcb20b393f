"""K and M written as other programs write them."""

from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np
import scipy.io
import scipy.sparse
from scipy.sparse import csr_array

from precompute.dofs import DIRECTIONS
from precompute.matrices import SystemFiles
from precompute.matrix_units import Units

SI = Units()
ANSYS = ("UX", "UY", "UZ", "ROTX", "ROTY", "ROTZ")
LAYOUTS = (
    "market general",
    "market symmetric",
    "market array",
    "abaqus input",
    "abaqus coordinate",
    "calculix",
    "ansys",
    "npz",
)


def entries(A: csr_array, triangle: str) -> list[tuple[int, int, float]]:
    """(i, j, A_ij) from 0 of the "whole" matrix, its "lower" or its "upper" triangle, by columns."""
    A = csr_array(A).tocoo()
    kept = {"whole": A.row >= 0, "lower": A.row >= A.col, "upper": A.row <= A.col}[triangle]
    order = np.lexsort((A.row, A.col))
    return [(int(A.row[k]), int(A.col[k]), float(A.data[k])) for k in order if kept[k]]


def write_lines(path: Path, lines: Iterable[str]) -> Path:
    path.write_text("".join(line + "\n" for line in lines))
    return path


def write_coordinates(path: Path, A: csr_array, triangle: str = "whole", digits: int = 17) -> Path:
    """row column value, from 1."""
    form = f"{{}} {{}} {{: .{digits - 1}e}}"
    return write_lines(path, [form.format(i + 1, j + 1, a) for i, j, a in entries(A, triangle)])


def write_dofs(path: Path, node: Sequence[int], direction: Sequence[int], points=None) -> Path:
    """The table node,direction with the coordinates of each row's node, if any."""
    rows = [f"{n},{DIRECTIONS[d]}" for n, d in zip(node, direction, strict=True)]
    if points is not None:
        rows = [f"{row},{x!r},{y!r},{z!r}" for row, (x, y, z) in zip(rows, points.tolist(), strict=True)]
    return write_lines(path, ["node,direction" + ("" if points is None else ",x,y,z"), *rows])


def write_system(
    folder: Path, layout: str, K: csr_array, M: csr_array, node: Sequence[int], direction: Sequence[int]
) -> SystemFiles:
    """K and M with what tells their rows, in one of LAYOUTS."""
    folder.mkdir(parents=True, exist_ok=True)
    table = write_dofs(folder / "dofs.csv", node, direction)
    K_file, M_file = (_write(folder, layout, name, A, node, direction) for name, A in (("K", K), ("M", M)))
    if layout == "abaqus input":
        return SystemFiles(K_file, M_file)
    if layout == "calculix":
        write_lines(folder / "K.dof", [f"{n}.{d + 1}" for n, d in zip(node, direction, strict=True)])
        return SystemFiles(K_file, M_file)
    if layout == "ansys":
        rows = enumerate(zip(node, direction, strict=True), 1)
        lines = [f"{k:14d}{n:14d}    {ANSYS[d]}" for k, (n, d) in rows]
        table = write_lines(folder / "mapping.txt", ["    Matrix Eqn          Node    DOF     ", *lines])
    return SystemFiles(K_file, M_file, dofs=table)


def _write(
    folder: Path, layout: str, name: str, A: csr_array, node: Sequence[int], direction: Sequence[int]
) -> Path:
    path = folder / f"{name}.mtx"
    if layout.startswith("market"):
        kind = layout.split()[1]
        scipy.io.mmwrite(
            path,
            A.toarray() if kind == "array" else A.tocoo(),
            precision=17,
            symmetry="general" if kind == "general" else "symmetric",
        )
        return path
    if layout == "abaqus input":  # Keywords Guide, *MATRIX INPUT
        labels = [f"{n},{d + 1}" for n, d in zip(node, direction, strict=True)]
        return write_lines(path, [f"{labels[i]}, {labels[j]}, {a: .15e}" for i, j, a in entries(A, "lower")])
    if layout == "abaqus coordinate":
        return write_coordinates(path, A, "whole", 16)
    if layout == "calculix":
        return write_coordinates(folder / f"{name}.sti", A, "upper", 14)
    if layout == "ansys":  # header and exponents as *EXPORT,…,MMF writes them
        lower = entries(A, "lower")
        rule = "%" + "=" * 60
        head = ["%%MatrixMarket matrix coordinate real symmetric ", rule, "% Creator: ANSYS Inc", "% ", rule]
        lines = [f"{i + 1} {j + 1} {a:.15E}" for i, j, a in lower]
        return write_lines(path, [*head, f"{A.shape[0]} {A.shape[0]} {len(lower)}", *lines])
    path = path.with_suffix(".npz")
    scipy.sparse.save_npz(path, A)
    return path
