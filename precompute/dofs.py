"""Which motion of which node each degree of freedom is."""

from dataclasses import dataclass

import numpy as np

from .arrays import Floats, Ints
from .errors import ModalFmuError

DIRECTIONS = ("x", "y", "z", "rx", "ry", "rz")


@dataclass(frozen=True)
class Dofs:
    """Row d of M and K is the motion `direction[d]` (0 … 5: x y z rx ry rz) of node `node[d]`.

    node, direction: (n,) each; nodes are rows of the part's points. No pair occurs twice.
    Raises ModalFmuError where that is not so.
    """

    node: Ints
    direction: Ints

    def __post_init__(self) -> None:
        if self.node.ndim != 1 or self.node.shape != self.direction.shape:
            raise ModalFmuError(
                f"Dofs: got node {self.node.shape}, direction {self.direction.shape}, expected (n,) twice"
            )
        key = self._keys(self.node, self.direction)
        if len(np.unique(key)) < len(key) or np.any(self.direction < 0) or np.any(self.direction > 5):
            raise ModalFmuError("Dofs: got a motion twice or a direction beyond 0 … 5; expected each once")

    @staticmethod
    def _keys(node: Ints, direction: Ints) -> Ints:
        return 6 * node + direction

    def find(self, nodes: Ints, direction: int) -> Ints:
        """The DOF of each of these nodes in one direction, −1 where there is none: (k,)."""
        keys = self._keys(self.node, self.direction)
        order = np.argsort(keys, kind="stable")
        wanted = self._keys(nodes, np.full(len(nodes), direction))
        place = np.minimum(np.searchsorted(keys[order], wanted), len(keys) - 1)
        found: Ints = np.where(keys[order][place] == wanted, order[place], -1)
        return found


def mesh_dofs(nodes: int) -> Dofs:
    """DOF 3·node + direction, as solid elements have them."""
    return Dofs(np.repeat(np.arange(nodes), 3), np.tile(np.arange(3), nodes))


def nodal(dofs: Dofs, U: Floats, nodes: int) -> Floats:
    """The translations (nodes, 3, k) of the columns of U (n, k); 0 where a node has no DOF."""
    shapes = np.zeros((nodes, 3, U.shape[1]))
    moving = dofs.direction < 3
    shapes[dofs.node[moving], dofs.direction[moving]] = U[moving]
    return shapes
