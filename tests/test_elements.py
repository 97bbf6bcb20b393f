"""Shape functions against polynomials, node order against VTK's tables, rules against closed integrals."""

from itertools import product
from math import factorial

import numpy as np
import pytest

from precompute.elements import ELEMENTS, FACE_RULES, INTERPOLATIONS, Rule, shape_functions

ROUNDING = 1e-13  # sums of some twenty terms of order one, and rules tabulated to 15 digits


def inside(name: str, count: int = 20) -> np.ndarray:
    """Random points of the reference cell: convex combinations of its nodes."""
    nodes = INTERPOLATIONS[name].nodes
    return np.random.default_rng(1).dirichlet(np.ones(len(nodes)), count) @ nodes


@pytest.mark.parametrize("name", INTERPOLATIONS)
def test_each_shape_function_is_one_at_its_node_and_zero_at_the_others(name: str) -> None:
    N, _ = shape_functions(name, INTERPOLATIONS[name].nodes)
    np.testing.assert_allclose(N, np.eye(len(N)), atol=ROUNDING)


@pytest.mark.parametrize("name", INTERPOLATIONS)
def test_polynomials_of_the_families_order_are_reproduced_with_their_gradients(name: str) -> None:
    order = 2 if name in ("tri6", "quad8", "tet10", "hex20") else 1
    nodes, points = INTERPOLATIONS[name].nodes, inside(name)
    N, dN = shape_functions(name, points)
    d = nodes.shape[1]
    for powers in product(range(order + 1), repeat=d):
        if sum(powers) > order:
            continue
        at_nodes = np.prod(nodes**powers, axis=1)
        np.testing.assert_allclose(N @ at_nodes, np.prod(points**powers, axis=1), atol=ROUNDING)
        for i in range(d):
            lower = np.array(powers) - (np.arange(d) == i)
            slope = powers[i] * np.prod(points ** np.maximum(lower, 0), axis=1)
            np.testing.assert_allclose(dN[:, :, i].dot(at_nodes), slope, atol=ROUNDING)
    # one order more is beyond it: the check above can fail
    cubic = nodes[:, 0] ** (order + 1)
    assert np.abs(N @ cubic - points[:, 0] ** (order + 1)).max() > 1e-2


@pytest.mark.parametrize(
    ("name", "node", "ends"),
    [  # from the figures of VTK's quadratic cells
        *(("tet10", 4, (0, 1)), ("tet10", 6, (0, 2)), ("tet10", 8, (1, 3)), ("tet10", 9, (2, 3))),
        *(("hex20", 8, (0, 1)), ("hex20", 11, (3, 0)), ("hex20", 13, (5, 6)), ("hex20", 15, (7, 4))),
        *(("hex20", 16, (0, 4)), ("hex20", 18, (2, 6)), ("hex20", 19, (3, 7))),
        *(("tri6", 5, (2, 0)), ("quad8", 7, (3, 0))),
    ],
)
def test_mid_edge_nodes_are_where_vtk_has_them(name: str, node: int, ends: tuple[int, int]) -> None:
    nodes = INTERPOLATIONS[name].nodes
    np.testing.assert_array_equal(nodes[node], nodes[list(ends)].mean(axis=0))


def exact_integral(name: str, powers: tuple[int, ...]) -> float:
    """∫ ξ^i η^j ζ^k over the reference cell."""

    def simplex(*p: int) -> float:
        return float(np.prod([factorial(i) for i in p])) / factorial(sum(p) + len(p))

    if name.startswith(("tet", "tri")):
        return simplex(*powers)
    if name.startswith("wedge"):
        return simplex(*powers[:2]) / (powers[2] + 1)
    return float(np.prod([1 / (i + 1) for i in powers]))


RULES = {
    **{f"{name} K": (element.stiffness, name) for name, element in ELEMENTS.items()},
    **{f"{name} M": (element.mass, name) for name, element in ELEMENTS.items()},
    **{f"{name} dA": (rule, name) for name, rule in FACE_RULES.items()},
}
TOTAL_DEGREE = {
    **{"tet4 K": 1, "tet4 M": 2, "tet10 K": 2, "tet10 M": 5, "tri3 dA": 2, "tri6 dA": 6},
}  # simplices; the others by degree in each direction
DEGREE = {
    **{"hex8 K": 3, "hex8 M": 5, "hex8r K": 3, "hex8r M": 5, "hex20 K": 5, "hex20 M": 5},
    **{"hex20r K": 3, "hex20r M": 5, "wedge6 K": 2, "wedge6 M": 4, "quad4 dA": 7, "quad8 dA": 7},
}


@pytest.mark.parametrize("rule_name", RULES)
def test_rules_integrate_their_degree_exactly_with_positive_weights(rule_name: str) -> None:
    rule, name = RULES[rule_name]
    points = (
        rule.N @ INTERPOLATIONS[name.removesuffix("r")].nodes
    )  # x = Σ N_a x_a holds on the reference cell
    assert (rule.w > 0).all()
    assert (points > 0).all()
    assert (points < 1).all()
    degree = TOTAL_DEGREE.get(rule_name) or DEGREE[rule_name]
    for powers in product(range(degree + 1), repeat=points.shape[1]):
        in_triangle = name == "wedge6" and sum(powers[:2]) > degree
        if not in_triangle and (rule_name in DEGREE or sum(powers) <= degree):
            assert integral(rule, points, powers) == pytest.approx(exact_integral(name, powers), abs=ROUNDING)


@pytest.mark.parametrize(
    ("rule_name", "degree"), [("tet10 K", 3), ("tet10 M", 6), ("hex20r K", 4), ("hex20 K", 6)]
)
def test_rules_are_no_finer_than_they_claim(rule_name: str, degree: int) -> None:
    rule, name = RULES[rule_name]
    points = rule.N @ INTERPOLATIONS[name.removesuffix("r")].nodes
    powers = (degree, 0, 0)
    assert abs(integral(rule, points, powers) - exact_integral(name, powers)) > 1e-6


def integral(rule: Rule, points: np.ndarray, powers: tuple[int, ...]) -> float:
    return float(rule.w @ np.prod(points**powers, axis=1))
