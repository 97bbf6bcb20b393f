"""The mesh of a part: points, solid cells by family, named sets."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from .arrays import Floats, Ints
from .errors import MeshError

FAMILIES: Mapping[str, int] = MappingProxyType(
    {"tet4": 4, "tet10": 10, "hex8": 8, "hex20": 20, "wedge6": 6, "hex8r": 8, "hex20r": 20}
)
"""Nodes per cell of each family that can be integrated; a final r: K takes reduced integration."""


@dataclass(frozen=True)
class Mesh:
    """Points p_i and the cells between them; every point belongs to a solid cell.

    points: (n, 3), m.
    cells: family → (c, k) rows of `points`. Corners first, then the mid-edge nodes, in the order that VTK and
        Abaqus share; the corners 0 1 2 of tetrahedra and wedges, 0 1 2 3 of hexahedra, turn counter-clockwise
        when one looks from the opposite corner or face (detJ > 0).
    node_ids: (n,) the numbers of the nodes in the file, 1-based where it has none.
    node_sets: name → rows of `points`, sorted and unique; empty where no node of the set is in a solid cell.
    cell_sets: name → family → rows of `cells[family]`, sorted and unique.
    Raises MeshError: shapes that do not fit, a coordinate that is not finite, a row out of range,
        a cell that names a node twice.
    """

    points: Floats
    cells: Mapping[str, Ints]
    node_ids: Ints
    node_sets: Mapping[str, Ints]
    cell_sets: Mapping[str, Mapping[str, Ints]]

    def __post_init__(self) -> None:
        n = len(self.points)
        if self.points.shape != (n, 3) or self.node_ids.shape != (n,):
            raise MeshError(
                f"got points {self.points.shape} and node ids {self.node_ids.shape}; expected (n, 3) and (n,)"
            )
        if not any(len(nodes) for nodes in self.cells.values()):
            raise MeshError("got no solid cell; expected at least one of " + ", ".join(FAMILIES))
        astray = np.flatnonzero(~np.isfinite(self.points).all(axis=1))
        if astray.size:
            raise MeshError(
                f"{astray.size} nodes have coordinates that are not finite, the first is node "
                f"{self.node_ids[astray[0]]}: {self.points[astray[0]].tolist()}; write finite numbers"
            )
        for family, nodes in self.cells.items():
            _check_cells(family, nodes, self.node_ids)
        _check_rows("node set", self.node_sets, n)
        for name, rows in self.cell_sets.items():
            for family in rows:
                _check_rows(f"cell set {name!r}", {family: rows[family]}, len(self.cells.get(family, ())))

    @property
    def bounds(self) -> Floats:
        """(2, 3): the lowest and the highest coordinates, m."""
        return np.stack([self.points.min(axis=0), self.points.max(axis=0)])

    @property
    def diagonal(self) -> float:
        """Length of the diagonal of the bounding box, m."""
        low, high = self.bounds
        return float(np.linalg.norm(high - low))


def _check_cells(family: str, nodes: Ints, node_ids: Ints) -> None:
    """Every cell has the family's number of nodes, all different and all there."""
    if family not in FAMILIES:
        raise MeshError(f"got cells of family {family!r}; expected one of {', '.join(FAMILIES)}")
    if nodes.ndim != 2 or nodes.shape[1] != FAMILIES[family]:
        raise MeshError(f"{family}: got cells of shape {nodes.shape}; expected (c, {FAMILIES[family]})")
    if nodes.size and not (nodes.min() >= 0 and nodes.max() < len(node_ids)):
        cell = int(np.flatnonzero(((nodes < 0) | (nodes >= len(node_ids))).any(axis=1))[0])
        raise MeshError(
            f"{family} cell {cell + 1} names nodes {nodes[cell].tolist()}; expected 0 to {len(node_ids) - 1}"
        )
    ordered = np.sort(nodes, axis=1)
    twice = np.flatnonzero((ordered[:, 1:] == ordered[:, :-1]).any(axis=1))
    if twice.size:
        raise MeshError(
            f"{twice.size} degenerate {family} cells name a node twice, the first is number {twice[0] + 1} "
            f"with nodes {', '.join(map(str, node_ids[nodes[twice[0]]]))}; "
            f"write them as cells of a family with fewer nodes"
        )


def _check_rows(what: str, sets: Mapping[str, Ints], n: int) -> None:
    for name, rows in sets.items():
        if rows.size and not (rows[0] >= 0 and rows[-1] < n and (np.diff(rows) > 0).all()):
            raise MeshError(
                f"{what} {name!r}: expected sorted unique rows from 0 to {n - 1}, got {rows[:5].tolist()} …"
            )
