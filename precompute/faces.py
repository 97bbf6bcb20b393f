"""Exterior faces of a mesh and the area weights w_i = ∫ N_i dA / A of the nodes on them."""

from collections.abc import Mapping

import numpy as np

from .arrays import Bools, Floats, Ints
from .cell_matrices import jacobians
from .elements import FACE_RULES, HEX_EDGES, TET_EDGES
from .mesh import Mesh

# corners of the faces in an order whose normal ∂x/∂ξ × ∂x/∂η points out of the cell
_TET = ((0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2))
_WEDGE = ((0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5))
_HEX = ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))


def _with_midpoints(face: tuple[int, ...], edges: tuple[tuple[int, int], ...], first: int) -> tuple[int, ...]:
    """Corners of a face, then the mid-edge nodes in the same turn; the cell numbers these from `first`."""
    turn = zip(face, (*face[1:], face[0]), strict=True)
    places = [{*edge} for edge in edges]
    return (*face, *(first + places.index({a, b}) for a, b in turn))


_TET10 = tuple(_with_midpoints(face, TET_EDGES, 4) for face in _TET)
_HEX20 = tuple(_with_midpoints(face, HEX_EDGES, 8) for face in _HEX)

CELL_FACES: Mapping[str, tuple[tuple[int, ...], ...]] = {
    "tet4": _TET,
    "tet10": _TET10,
    "wedge6": _WEDGE,
    "hex8": _HEX,
    "hex8r": _HEX,
    "hex20": _HEX20,
    "hex20r": _HEX20,
}
"""family → the local nodes of each face, outward; a face has 3, 6, 4 or 8 of them."""

_FACE_OF = {3: "tri3", 6: "tri6", 4: "quad4", 8: "quad8"}
_CORNERS = {"tri3": 3, "tri6": 3, "quad4": 4, "quad8": 4}


def exterior_faces(mesh: Mesh) -> Mapping[str, Ints]:
    """The faces that belong to one cell only: "tri3", "tri6", "quad4", "quad8" → (f, k) rows of mesh.points.

    Nodes are in VTK order, turning counter-clockwise seen from outside. Two faces are the same one where
    their corners are the same nodes; families without exterior faces are left out.
    """
    found: dict[str, list[Ints]] = {}
    for family, nodes in mesh.cells.items():
        for face in CELL_FACES[family]:
            found.setdefault(_FACE_OF[len(face)], []).append(nodes[:, face])
    faces = {name: np.concatenate(found[name]) for name in _CORNERS if name in found}
    exterior: dict[str, Ints] = {}
    for corners in (3, 4):
        names = [name for name in faces if _CORNERS[name] == corners]
        if names:
            single = _occur_once(np.concatenate([faces[name][:, :corners] for name in names]))
            ends = np.cumsum([len(faces[name]) for name in names])[:-1]
            for name, mask in zip(names, np.split(single, ends), strict=True):
                exterior[name] = faces[name][mask]
    return {name: nodes for name, nodes in exterior.items() if len(nodes)}


def _occur_once(corners: Ints) -> Bools:
    """Which rows of (f, k) are equal to no other row, up to the order within them: (f,)."""
    rows = np.sort(corners, axis=1)
    order = np.lexsort(rows.T)
    equal = np.concatenate([[False], (np.diff(rows[order], axis=0) == 0).all(axis=1), [False]])
    single = np.empty(len(rows), dtype=np.bool_)
    single[order] = ~equal[1:] & ~equal[:-1]
    return single


def node_areas(points: Floats, name: str, faces: Ints) -> Floats:
    """∫ N_a |∂x/∂ξ × ∂x/∂η| dξ dη of every face and each of its nodes, m²: (f, k) like faces.

    points: (n, 3) in m; name: the family of the faces. The sum over a row is the area of the face.
    """
    rule = FACE_RULES[name]
    T = jacobians(points[faces], rule.dN)
    dA = rule.w * np.linalg.norm(np.cross(T[..., 0], T[..., 1]), axis=-1)
    areas: Floats = dA @ rule.N
    return areas


def area_weights(mesh: Mesh, nodes: Ints) -> Floats | None:
    """w_i = ∫ N_i dA / A over the exterior faces whose nodes are all selected: aligned with nodes, sum 1.

    nodes: rows of mesh.points, unique. A uniform traction t on these faces has the nodal forces w_i A t,
    so a corner of a flat tri6 weighs nothing and one of a flat quad8 −1/12 of its area: that is right.
    None where no whole face is selected.
    """
    n = len(mesh.points)
    selected = np.zeros(n, dtype=np.bool_)
    selected[nodes] = True
    total = np.zeros(n)
    for name, faces in exterior_faces(mesh).items():
        whole = faces[selected[faces].all(axis=1)]
        total += np.bincount(whole.ravel(), node_areas(mesh.points, name, whole).ravel(), minlength=n)
    A = total.sum()
    return total[nodes] / A if A > 0 else None
