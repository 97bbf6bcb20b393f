"""Element families: reference nodes in VTK order, shape functions N_a(ξ) and integration rules.

x(ξ) = Σ_a N_a(ξ) x_a and u(ξ) = Σ_a N_a(ξ) u_a (isoparametric), on the reference cells
line [0, 1], triangle ξ, η ≥ 0, ξ + η ≤ 1, square [0, 1]², and likewise in space.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np
from skfem import element
from skfem.quadrature import get_quadrature
from skfem.refdom import RefHex, RefLine, RefQuad, RefTet, RefTri

from .arrays import Floats

_TRI = ((0, 0), (1, 0), (0, 1))
_QUAD = ((0, 0), (1, 0), (1, 1), (0, 1))
_TET = ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1))
_WEDGE = ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (0, 1, 1))
_HEX = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))

_TRI_EDGES = ((0, 1), (1, 2), (2, 0))
_QUAD_EDGES = ((0, 1), (1, 2), (2, 3), (3, 0))
TET_EDGES = ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))
HEX_EDGES = (
    *((0, 1), (1, 2), (2, 3), (3, 0)),
    *((4, 5), (5, 6), (6, 7), (7, 4)),
    *((0, 4), (1, 5), (2, 6), (3, 7)),
)


@dataclass(frozen=True)
class Interpolation:
    """The shape functions of a family: N_a is 1 at nodes[a] and 0 at the others.

    nodes: (k, d) reference nodes in VTK order; basis: the scikit-fem element;
    order: (k,) which of its functions belongs to each node.
    """

    nodes: Floats
    basis: Any
    order: tuple[int, ...]


@dataclass(frozen=True)
class Rule:
    """∫ f dξ ≈ Σ_q w_q f(ξ_q), with the shape functions of one family tabulated at the points.

    N: (q, k) N_a(ξ_q); dN: (q, k, d) ∂N_a/∂ξ_j; w: (q,).
    """

    N: Floats
    dN: Floats
    w: Floats


@dataclass(frozen=True)
class Element:
    """How the cells of one family are integrated.

    nodes: number of nodes k; stiffness, mass: the rules of K and M.
    """

    nodes: int
    stiffness: Rule
    mass: Rule


def _interpolation(
    basis: Any,
    corners: tuple[tuple[int, ...], ...],
    edges: tuple[tuple[int, int], ...] = (),
) -> Interpolation:
    """Match the nodes (corners, then midpoints of edges) to the basis by location."""
    points = np.array(corners, dtype=float)
    nodes = np.concatenate([points, *(points[list(edge)].mean(axis=0, keepdims=True) for edge in edges)])
    distance = np.abs(nodes[:, None, :] - basis.doflocs[None, :, :]).sum(axis=-1)
    return Interpolation(nodes, basis, tuple(int(i) for i in distance.argmin(axis=1)))


INTERPOLATIONS: Mapping[str, Interpolation] = {
    "tri3": _interpolation(element.ElementTriP1(), _TRI),
    "tri6": _interpolation(element.ElementTriP2(), _TRI, _TRI_EDGES),
    "quad4": _interpolation(element.ElementQuad1(), _QUAD),
    "quad8": _interpolation(element.ElementQuadS2(), _QUAD, _QUAD_EDGES),
    "tet4": _interpolation(element.ElementTetP1(), _TET),
    "tet10": _interpolation(element.ElementTetP2(), _TET, TET_EDGES),
    "wedge6": _interpolation(element.ElementWedge1(), _WEDGE),
    "hex8": _interpolation(element.ElementHex1(), _HEX),
    "hex20": _interpolation(element.ElementHexS2(), _HEX, HEX_EDGES),
}


def shape_functions(name: str, points: Floats) -> tuple[Floats, Floats]:
    """N_a(ξ_q) as (q, k) and ∂N_a/∂ξ_j(ξ_q) as (q, k, d), at reference points (q, d)."""
    interpolation = INTERPOLATIONS[name]
    q, d = points.shape
    N = np.empty((q, len(interpolation.order)))
    dN = np.empty((q, len(interpolation.order), d))
    for a, i in enumerate(interpolation.order):
        value, gradient = interpolation.basis.lbasis(points.T, i)
        N[:, a], dN[:, a] = value, gradient.T
    return N, dN


def _rule(name: str, points: Floats, weights: Floats) -> Rule:
    """Tabulate the shape functions of a family at points (d, q), as scikit-fem gives them."""
    return Rule(*shape_functions(name, points.T), weights)


def _prism(line_order: int, triangle_order: int) -> tuple[Floats, Floats]:
    """The product of a line's and a triangle's rule (scikit-fem's own one misplaces its points)."""
    z, w_line = get_quadrature(RefLine, line_order)
    xy, w_triangle = get_quadrature(RefTri, triangle_order)
    points = np.concatenate([np.tile(xy, z.shape[1]), np.repeat(z, xy.shape[1], axis=1)])
    return points, np.repeat(w_line, len(w_triangle)) * np.tile(w_triangle, len(w_line))


def _tetrahedron_5() -> tuple[Floats, Floats]:
    """Degree 5 by 14 points (Walkington, Quadrature on simplices of arbitrary dimension, 2000).

    All points are inside; those of scikit-fem's rule of this order lie on edges, where det J of a usable
    curved cell may vanish. Barycentric points (1 − 3a, a, a, a) and (b, b, ½ − b, ½ − b), permuted.
    """
    points, weights = [], []
    for a, weight in (
        (0.3108859192633006098, 0.1126879257180158508),
        (0.0927352503108912264, 0.0734930431163619495),
    ):
        points += [np.where(np.arange(4) == i, 1 - 3 * a, a) for i in range(4)]
        weights += 4 * [weight]
    b = 0.0455037041256496495
    points += [np.where(np.isin(np.arange(4), pair), b, 0.5 - b) for pair in combinations(range(4), 2)]
    weights += 6 * [0.0425460207770814664]
    return np.array(points)[:, 1:].T, np.array(weights) / 6


# All weights are positive (scikit-fem's tetrahedra of order 3, 4, 8 and triangles of order 3, 7 are not).
# tet10: ∇N∇N is quadratic and N N quartic where edges are straight: 4 and 14 points. On curved cells the
# error of these rules is of higher order than that of the element itself.
# hex8, wedge6: M exact for every shape, K by the two points per direction that the bilinear terms need.
_TET_1, _TET_4, _TET_14 = get_quadrature(RefTet, 1), get_quadrature(RefTet, 2), _tetrahedron_5()
_HEX_8, _HEX_27 = (get_quadrature(RefHex, order) for order in (3, 5))
_HEX8_K, _HEX8_M = _rule("hex8", *_HEX_8), _rule("hex8", *_HEX_27)
_HEX20_K, _HEX20_M = _rule("hex20", *_HEX_8), _rule("hex20", *_HEX_27)

ELEMENTS: Mapping[str, Element] = {
    "tet4": Element(4, _rule("tet4", *_TET_1), _rule("tet4", *_TET_4)),
    "tet10": Element(10, _rule("tet10", *_TET_4), _rule("tet10", *_TET_14)),
    "wedge6": Element(6, _rule("wedge6", *_prism(3, 2)), _rule("wedge6", *_prism(5, 4))),
    "hex8": Element(8, _HEX8_K, _HEX8_M),
    "hex8r": Element(8, _HEX8_K, _HEX8_M),  # K: the mean of the gradients over these points
    "hex20": Element(20, _HEX20_M, _HEX20_M),
    "hex20r": Element(20, _HEX20_K, _HEX20_M),
}

# ∫ N_a |∂x/∂ξ × ∂x/∂η| has no exact rule on a curved face: two orders more than a flat one needs.
FACE_RULES: Mapping[str, Rule] = {
    "tri3": _rule("tri3", *get_quadrature(RefTri, 2)),
    "tri6": _rule("tri6", *get_quadrature(RefTri, 6)),
    "quad4": _rule("quad4", *get_quadrature(RefQuad, 7)),
    "quad8": _rule("quad8", *get_quadrature(RefQuad, 7)),
}
