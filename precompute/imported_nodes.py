"""The nodes of a table of DOFs, in the order of a mesh where there is one."""

import numpy as np

from .arrays import Floats, Ints
from .dof_table import DofTable
from .dofs import Dofs
from .errors import MatrixError
from .mesh import Mesh
from .node_table import NodeTable
from .notice import notice
from .raw_mesh import rows_of

SAME = 1e-4  # of the mesh's diagonal: two files of one node may round its place


def imported_nodes(table: DofTable, metres: float, mesh: Mesh | None) -> tuple[Dofs, NodeTable]:
    """Every row's node by its place in a table of nodes; metres: of the table's unit of length.

    Raises MatrixError: rows of one node at different places, a mesh that has none of the nodes, or has them
    elsewhere.
    """
    ids, first, inverse = np.unique(table.node, return_index=True, return_inverse=True)
    points = table.points[first] * metres
    if not np.allclose(table.points, table.points[first][inverse], rtol=0, atol=0, equal_nan=True):
        apart = table.node[np.flatnonzero(np.any(table.points != table.points[first][inverse], axis=1))[0]]
        raise MatrixError(f"dofs: got different coordinates for rows of node {apart}, expected the same")
    if mesh is None:
        return Dofs(inverse, table.direction), NodeTable(points, ids)
    rows = rows_of(ids, mesh.node_ids)
    inside = rows >= 0
    if not inside.any():
        raise MatrixError(
            f"mesh: got nodes {mesh.node_ids.min()} to {mesh.node_ids.max()}, none of which is in the "
            f"matrices ({ids[0]} to {ids[-1]}); give the mesh that the matrices are of"
        )
    _check_places(points[inside], mesh, rows[inside])
    if not inside.all():
        notice(
            f"{np.sum(~inside)} nodes of the matrices are not in the mesh, the first is {ids[~inside][0]}; "
            "they have the coordinates of the DOF table, if any"
        )
    rows[~inside] = len(mesh.node_ids) + np.arange(np.sum(~inside))
    nodes = NodeTable(
        np.concatenate([mesh.points, points[~inside]]),
        np.concatenate([mesh.node_ids, ids[~inside]]),
        mesh.cells,
        mesh.node_sets,
        mesh.cell_sets,
    )
    return Dofs(rows[inverse], table.direction), nodes


def _check_places(points: Floats, mesh: Mesh, rows: Ints) -> None:
    away = np.linalg.norm(points - mesh.points[rows], axis=1)
    k = int(np.argmax(np.nan_to_num(away)))
    if away[k] > SAME * mesh.diagonal:
        raise MatrixError(
            f"dofs: got node {mesh.node_ids[rows[k]]} at {points[k].tolist()} m, the mesh has it at "
            f"{mesh.points[rows[k]].tolist()} m; are both of one model and are their units of length right?"
        )
