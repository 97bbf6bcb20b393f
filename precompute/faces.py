"""Exterior faces of a mesh and what their nodes have of them: ∫ N_a dA, ∫ N_a n dA and shares of the area."""

from collections.abc import Callable, Mapping
from typing import TypeAlias

import numpy as np

from .arrays import Bools, Floats, Ints
from .cell_matrices import jacobians
from .elements import FACE_RULES, HEX_EDGES, TET_EDGES
from .mesh import Mesh
from .node_table import NodeTable

Body: TypeAlias = Mesh | NodeTable
"""Nodes with their cells, if there are any."""

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
    return _of_one_cell(_all_faces(mesh))


def whole_faces(body: Body, nodes: Ints) -> Mapping[str, Ints]:
    """The exterior faces whose nodes are all among `nodes`, as `exterior_faces` gives them."""
    selected = np.zeros(len(body.points), dtype=np.bool_)
    selected[nodes] = True
    # twins of a face have its corners, so that those beyond the selected corners tell nothing
    near = {
        name: faces[selected[faces[:, : _CORNERS[name]]].all(axis=1)]
        for name, faces in _all_faces(body).items()
    }
    whole = {name: faces[selected[faces].all(axis=1)] for name, faces in _of_one_cell(near).items()}
    return {name: faces for name, faces in whole.items() if len(faces)}


def _all_faces(body: Body) -> Mapping[str, Ints]:
    """The faces of all cells, those between two cells twice."""
    found: dict[str, list[Ints]] = {}
    for family, nodes in body.cells.items():
        for face in CELL_FACES[family]:
            found.setdefault(_FACE_OF[len(face)], []).append(nodes[:, face])
    return {name: np.concatenate(found[name]) for name in _CORNERS if name in found}


def _of_one_cell(faces: Mapping[str, Ints]) -> Mapping[str, Ints]:
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


NodeIntegral: TypeAlias = Callable[[Floats, str, Ints], Floats]
"""points (n, 3) in m, the family of the faces, faces (f, k) → what each node has of its face: (f, k, …)."""


def node_areas(points: Floats, name: str, faces: Ints) -> Floats:
    """∫ N_a dA = ∫ N_a |∂x/∂ξ × ∂x/∂η| dξ dη of every face and each of its nodes, m²: (f, k).

    The sum over a row is the area of the face.
    """
    areas: Floats = _scaled_areas(points, name, faces) @ FACE_RULES[name].N
    return areas


def node_shares(points: Floats, name: str, faces: Ints) -> Floats:
    """a = A_face ∫ N_a² dA / Σ_b ∫ N_b² dA, m²: (f, k), the area lumped to nodes, positive on every face.

    Hinton, Rock & Zienkiewicz, A note on mass lumping and related processes in the finite element method,
    Earthquake Eng. Struct. Dyn. 4 (1976) 245-249.
    """
    dA = _scaled_areas(points, name, faces)
    squares = dA @ FACE_RULES[name].N ** 2
    total = squares.sum(axis=1, keepdims=True)
    # a side of a cell that is collapsed to a line has no area, and no shares of it
    shares: Floats = squares * np.divide(
        dA.sum(axis=1, keepdims=True), total, out=np.zeros_like(total), where=total > 0
    )
    return shares


def node_normals(points: Floats, name: str, faces: Ints) -> Floats:
    """∫ N_a n dA = ∫ N_a ∂x/∂ξ × ∂x/∂η dξ dη, n out of the cell, m²: (f, k, 3).

    Exact on curved faces too: the integrand is a polynomial that the rule integrates.
    """
    rule = FACE_RULES[name]
    T = jacobians(points[faces], rule.dN)
    normals: Floats = np.einsum("q,qa,fqi->fai", rule.w, rule.N, np.cross(T[..., 0], T[..., 1]))
    return normals


def _scaled_areas(points: Floats, name: str, faces: Ints) -> Floats:
    """w_q |∂x/∂ξ × ∂x/∂η| at the points of the face's rule: (f, q)."""
    rule = FACE_RULES[name]
    T = jacobians(points[faces], rule.dN)
    dA: Floats = rule.w * np.linalg.norm(np.cross(T[..., 0], T[..., 1]), axis=-1)
    return dA


def nodal_sums(points: Floats, nodes: Ints, faces: Mapping[str, Ints], of: NodeIntegral) -> Floats:
    """Σ_faces of_i at each of the nodes: (k,) aligned with `nodes`, unique, those of the faces among them.

    With node_areas a uniform traction t on the faces has the nodal forces t·sum, so a corner of a flat
    tri6 has nothing and one of a flat quad8 −1/12 of its area: that is right.
    """
    total = np.zeros(len(points))
    for name, some in faces.items():
        total += np.bincount(some.ravel(), of(points, name, some).ravel(), minlength=len(points))
    return np.asarray(total[nodes])
