"""Polynomial displacement fields: rigid motions, linear strain, quadratic strain."""

from itertools import product

import numpy as np

from .arrays import Floats, Ints
from .dofs import Dofs
from .errors import EigenError
from .rigid import holding, vanishing_at
from .system import System


def polynomial_fields(points: Floats, dofs: Dofs, order: int) -> Floats:
    """u = x^a y^b z^c e_i with a + b + c ≤ order; rotations are ½ curl u.

    points: (nodes, 3) in m; order 1: 12 fields, order 2: 30 fields, as columns (n, k). Coordinates are those
    about the centre of the points, divided by the part's half size, so that no field exceeds its unit.
    Raises EigenError: a node without coordinates.
    Source: Pentland & Williams, Computer Graphics 23(3), 1989 (deformation modes of order 0, 1, 2).
    """
    used = np.unique(dofs.node)
    missing = int(np.sum(~np.isfinite(points[used]).all(axis=1)))
    if missing:
        raise EigenError(
            f"basis: polynomials need the coordinates of every node, {missing} have none; give "
            "the part a mesh, or take another kind"
        )
    low, high = points[used].min(axis=0), points[used].max(axis=0)
    size = float((high - low).max()) / 2 or 1.0
    p = (points[dofs.node] - (low + high) / 2) / size
    powers = [e for e in product(range(order + 1), repeat=3) if sum(e) <= order]
    V = np.zeros((len(dofs.node), len(powers), 3))
    for k, exponents in enumerate(powers):
        value, gradient = _monomial(p, np.array(exponents))
        for i, e in enumerate(np.eye(3)):
            motions = np.column_stack([np.outer(value, e), 0.5 * np.cross(gradient / size, e)])
            V[:, k, i] = np.take_along_axis(motions, dofs.direction[:, None], axis=1)[:, 0]
    return V.reshape(len(V), -1)


def vanishing_at_supports(V: Floats, system: System, fixed: Ints) -> Floats:
    """The combinations of the fields V (n, k) that are 0 at the fixed DOFs: (n, ≤ k).

    Raises EigenError: none is left.
    """
    V = V[:, np.any(V, axis=0)]
    V = V / np.max(np.abs(V), axis=0)
    left: Floats = V @ vanishing_at(V[holding(system.K, fixed)])
    left[fixed] = 0.0
    if left.shape[1] == 0:
        raise EigenError(
            f"basis: got {V.shape[1]} polynomial fields, none of whose combinations vanishes at the "
            "supports; raise order (up to 2), hold less, or take another kind"
        )
    return left


def _monomial(p: Floats, exponents: Ints) -> tuple[Floats, Floats]:
    """x^a y^b z^c (n,) and its gradient (n, 3) at p (n, 3)."""
    gradient = np.zeros_like(p)
    for k in np.flatnonzero(exponents):
        lower = exponents.copy()
        lower[k] -= 1
        gradient[:, k] = exponents[k] * np.prod(p**lower, axis=1)
    return np.prod(p**exponents, axis=1), gradient
