"""Where forces enter and motions are read: weights over the nodes of a port."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from .arrays import Floats, Ints
from .faces import area_weights
from .mesh import Mesh
from .notice import notice


@dataclass(frozen=True)
class PortNodes:
    """u_port = Σ wᵢ uᵢ and Fᵢ = wᵢ F_port with Σ wᵢ = 1: force and displacement are power-conjugate.

    nodes: (k,) node indices; weights: (k,), area weights of corner nodes may be zero or negative.
    """

    nodes: Ints
    weights: Floats

    def __post_init__(self) -> None:
        if self.nodes.shape != self.weights.shape or len(self.nodes) == 0:
            raise ValueError(
                f"got nodes {self.nodes.shape}, weights {self.weights.shape}, expected (k,) twice"
            )


def port_nodes(mesh: Mesh, nodes: Ints, weights: Literal["area", "equal"], name: str) -> PortNodes:
    """Weights of a port over the nodes selected for it.

    "area": wᵢ = ∫Nᵢ dA / A over the exterior faces whose nodes are all selected, so that a force is a
    uniform traction; "equal": 1/k. One node, or a selection without a whole face, takes equal weights,
    with a notice where that is not what was asked for.
    """
    equal = np.full(len(nodes), 1.0 / len(nodes))
    if weights == "equal" or len(nodes) == 1:
        return PortNodes(nodes, equal)
    area = area_weights(mesh, nodes)
    if area is None:
        notice(
            f"port {name}: its {len(nodes)} nodes cover no whole exterior face, so they have equal weights"
        )
        return PortNodes(nodes, equal)
    return PortNodes(nodes, area)


def participation(Phi: Floats, port: PortNodes) -> Floats:
    """wᵀΦ: the port's mean motion in x, y, z per unit of each mode.

    Phi: (3n, r); result (3, r). Its rows are columns of B (f = ΦᵀF [2.22]) and rows of C (u = Φq [2.20]).
    """
    r = Phi.shape[1]
    at_nodes = Phi.reshape(-1, 3, r)[port.nodes]
    mean: Floats = np.tensordot(port.weights, at_nodes, axes=1)
    return mean
