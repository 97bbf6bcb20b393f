"""Displacement gradients at the nodes of cells, from the points where they are most accurate.

∂u_i/∂x_j at node a = Σ_s E_as ∂u_i/∂x_j(ξ_s): the gradients at the integration points ξ_s are continued to
the nodes by the (multi)linear function through them. In cells with straight edges that is the gradient
itself, except in hex20 and hex20r, whose strain is more accurate at the 2 × 2 × 2 points than anywhere else
(Barlow, Optimal stress locations in finite element models, Int. J. Numer. Methods Eng. 10 (1976) 243–251).
Hinton and Campbell, Local and global smoothing of discontinuous finite element functions using a least
squares method, Int. J. Numer. Methods Eng. 8 (1974) 461–480.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from .arrays import Floats
from .elements import ELEMENTS, INTERPOLATIONS, Rule, shape_functions


@dataclass(frozen=True)
class Recovery:
    """rule: the points ξ_s; extrapolation: E (k, s), each row of sum 1: constants stay what they are."""

    rule: Rule
    extrapolation: Floats


def _recovery(family: str, corner_family: str, rule: Rule) -> Recovery:
    """E = N(nodes) N(points)⁺ with the shape functions N of the corners; of one point, its value for all."""
    nodes = INTERPOLATIONS[family].nodes
    at_nodes, _ = shape_functions(corner_family, nodes)
    at_points, _ = shape_functions(corner_family, rule.N @ nodes)
    return Recovery(rule, at_nodes @ np.linalg.pinv(at_points))


_HEX8 = _recovery("hex8", "hex8", ELEMENTS["hex8"].stiffness)
_HEX20 = _recovery("hex20", "hex8", ELEMENTS["hex20r"].stiffness)

RECOVERIES: Mapping[str, Recovery] = {
    "tet4": _recovery("tet4", "tet4", ELEMENTS["tet4"].stiffness),
    "tet10": _recovery("tet10", "tet4", ELEMENTS["tet10"].stiffness),
    "wedge6": _recovery("wedge6", "wedge6", ELEMENTS["wedge6"].stiffness),
    "hex8": _HEX8,
    "hex8r": _HEX8,  # its mean strain alone knows no bending within a cell
    "hex20": _HEX20,
    "hex20r": _HEX20,
}
