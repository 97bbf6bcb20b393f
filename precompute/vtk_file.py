"""VTK meshes (.vtu and legacy .vtk), read by meshio."""

import io
from collections.abc import Mapping
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path

import meshio
import numpy as np

from .arrays import Floats, Ints
from .errors import MeshError
from .mesh import FAMILIES
from .raw_mesh import REMEDIES, SHAPES, Block, RawMesh

MOST_VALUES = 50  # an array with more distinct values numbers the cells rather than groups them

KINDS: Mapping[str, str] = {
    **{"tetra": "tet4", "tetra10": "tet10", "hexahedron": "hex8", "hexahedron20": "hex20"},
    **{"vertex": "point", "line": "line2", "triangle": "tri3", "triangle6": "tri6", "quad": "quad4"},
    **{"hexahedron27": "hex27", "wedge": "wedge6", "pyramid": "pyramid5"},
}
"""meshio's names of cells where ours differ."""


def read_vtk(path: Path) -> RawMesh:
    """What a .vtu or .vtk file says; nodes are numbered from 1.

    Sets: integer cell data with at most 50 distinct values, as "array value". VTK's manual and its shape
    functions disagree on which way the first triangle of a wedge turns, and so do programs: each is taken
    with detJ > 0. Raises MeshError: what meshio cannot read, cells of third or higher order, polyhedra.
    """
    file = _read(path)
    points = np.zeros((len(file.points), 3))
    points[:, : file.points.shape[1]] = file.points
    blocks = [_block(KINDS.get(cells.type, cells.type), cells.data, points) for cells in file.cells]
    sets: dict[str, dict[int, Ints]] = {}
    for array, data in file.cell_data.items():
        if not all(values.ndim == 1 and np.issubdtype(values.dtype, np.integer) for values in data):
            continue
        distinct = np.unique(np.concatenate(data))
        for value in distinct.tolist() if len(distinct) <= MOST_VALUES else ():
            rows = {number: np.flatnonzero(values == value) for number, values in enumerate(data)}
            sets[f"{array} {value}"] = {number: cells for number, cells in rows.items() if cells.size}
    return RawMesh(points, np.arange(1, len(points) + 1), blocks, {}, sets)


def _read(path: Path) -> meshio.Mesh:
    """meshio prints its errors and leaves by SystemExit: both become one MeshError."""
    said = io.StringIO()
    try:
        with redirect_stdout(said), redirect_stderr(said):
            return meshio.read(path)
    except (Exception, SystemExit) as error:  # noqa: BLE001  meshio on a damaged file raises anything
        reason = " ".join(said.getvalue().partition("Error: Couldn't")[0].split())
        if not reason and not isinstance(error, SystemExit):
            reason = repr(error)
        raise MeshError(
            f"got no VTK mesh that can be read; is the file cut off? {reason[:200]}".rstrip()
        ) from None


def _block(kind: str, nodes: Ints, points: Floats) -> Block:
    if kind not in FAMILIES.keys() | SHAPES | REMEDIES.keys():
        raise MeshError(f"got {len(nodes)} cells of type {kind}; expected cells of first or second order")
    if nodes.size and not (nodes.min() >= 0 and nodes.max() < len(points)):
        raise MeshError(f"a {kind} cell names a point that is not there; is the file cut off?")
    if kind == "wedge6":
        a, b, c, up = (points[nodes[:, i]] for i in (0, 1, 2, 3))
        inside_out = np.einsum("ij,ij->i", np.cross(b - a, c - a), up - a) < 0.0
        nodes = np.where(inside_out[:, None], nodes[:, [0, 2, 1, 3, 5, 4]], nodes)
    return Block(kind, nodes.astype(np.int64))
