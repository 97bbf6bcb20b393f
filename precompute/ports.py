"""Where forces enter and motions are read: weights over the nodes of a port."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from .arrays import Floats, Ints
from .faces import Body, nodal_sums, node_areas, node_shares, whole_faces
from .notice import notice


@dataclass(frozen=True)
class PortNodes:
    """u_port = Σ wᵢ uᵢ and Fᵢ = wᵢ F_port with Σ wᵢ = 1: force and displacement are power-conjugate.

    name: the port's; nodes: (k,) rows of the part's nodes, with their ids (k,) in the file and their points
    (k, 3) in m; weights: (k,) w, those of corner nodes may be zero or negative; shares: (k,) a ≥ 0 with
    Σ aᵢ = 1, by which rotations and stresses are averaged; faces: the whole exterior faces, as
    `whole_faces` gives them, none where there are no cells.
    """

    name: str
    nodes: Ints
    ids: Ints
    points: Floats
    weights: Floats
    shares: Floats
    faces: Mapping[str, Ints]

    def __post_init__(self) -> None:
        k = len(self.nodes)
        shapes = [array.shape for array in (self.ids, self.points, self.weights, self.shares)]
        if k == 0 or shapes != [(k,), (k, 3), (k,), (k,)]:
            raise ValueError(
                f"port {self.name}: got {k} nodes, ids {shapes[0]}, points {shapes[1]}, "
                f"weights {shapes[2]}, shares {shapes[3]}; expected (k,), but (k, 3) points, k > 0"
            )


def port_nodes(body: Body, nodes: Ints, weights: Literal["area", "equal"], name: str) -> PortNodes:
    """Weights of a port over the nodes selected for it, rows of body.points.

    "area": wᵢ = ∫Nᵢ dA / A over the exterior faces whose nodes are all selected, so that a force is a
    uniform traction, and shares by the same area lumped to nodes (`node_shares`); "equal": both 1/k.
    One node, or a selection without a whole face, takes equal weights, with a notice where that is not
    what was asked for.
    """
    faces = whole_faces(body, nodes)
    area, lumped = (nodal_sums(body.points, nodes, faces, of) for of in (node_areas, node_shares))
    equal = np.full(len(nodes), 1.0 / len(nodes))
    by_area = weights == "area" and len(nodes) > 1
    if by_area and not area.sum() > 0:
        notice(
            f"port {name}: its {len(nodes)} nodes cover no whole exterior face, so they have equal weights"
        )
        by_area = False
    return PortNodes(
        name,
        nodes,
        body.node_ids[nodes],
        body.points[nodes],
        weights=area / area.sum() if by_area else equal,
        shares=lumped / lumped.sum() if by_area else equal,
        faces=faces,
    )
