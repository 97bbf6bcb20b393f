"""The nodes that exported matrices belong to, with a mesh or without one."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field

import numpy as np

from .arrays import Floats, Ints
from .dofs import DIRECTIONS, Dofs
from .errors import MatrixError, ZeroEnergyError

COORDINATES = "give the coordinates: columns x, y, z of the DOF table, or the mesh that the matrices are of"


@dataclass(frozen=True)
class NodeTable:
    """Nodes by number; where there is a mesh its nodes come first, in its order, with its cells and sets.

    points: (k, 3) in m, NaN where they are not known; node_ids: (k,); cells, node_sets, cell_sets as in Mesh,
    empty without one.
    Raises MatrixError: shapes that do not fit, a node number twice.
    """

    points: Floats
    node_ids: Ints
    cells: Mapping[str, Ints] = field(default_factory=dict)
    node_sets: Mapping[str, Ints] = field(default_factory=dict)
    cell_sets: Mapping[str, Mapping[str, Ints]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        k = len(self.node_ids)
        if self.points.shape != (k, 3) or self.node_ids.shape != (k,):
            raise MatrixError(
                f"NodeTable: got points {self.points.shape}, numbers {self.node_ids.shape}; "
                "expected (k, 3), (k,)"
            )
        if len(np.unique(self.node_ids)) < k:
            raise MatrixError("NodeTable: got a node number twice; expected each once")

    @property
    def located(self) -> bool:
        """Whether the coordinates of all nodes are known."""
        return bool(np.isfinite(self.points).all())


def place(nodes: NodeTable, dofs: Dofs, dof: int) -> str:
    """node 17 y at (1, 0, 0.5) m."""
    k = dofs.node[dof]
    name = f"node {nodes.node_ids[k]} {DIRECTIONS[dofs.direction[dof]]}"
    x, y, z = nodes.points[k]
    return f"{name} at ({x:.4g}, {y:.4g}, {z:.4g}) m" if np.isfinite([x, y, z]).all() else name


@contextmanager
def asking_for_coordinates(nodes: NodeTable) -> Iterator[None]:
    """Within: a free body whose rotations are not known as rigid motions is told what is missing."""
    try:
        yield
    except ZeroEnergyError as error:
        if nodes.located:
            raise
        raise ZeroEnergyError(f"{error}; or, if the body is free to turn, {COORDINATES}") from error
