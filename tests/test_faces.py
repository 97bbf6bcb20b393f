"""Exterior faces: closed, outward; areas, normals and shares of known surfaces and faces."""

import numpy as np
import pytest
from boxes import box, joined, mapped, mesh_of

from precompute.arrays import Floats, Ints
from precompute.cell_matrices import determinants, jacobians
from precompute.elements import ELEMENTS, FACE_RULES
from precompute.faces import (
    CELL_FACES,
    exterior_faces,
    nodal_sums,
    node_areas,
    node_normals,
    node_shares,
    whole_faces,
)
from precompute.mesh import FAMILIES, Mesh

ROUNDING = 1e-13


def bent(p: Floats) -> Floats:
    """A smooth map that curves every face of the unit cube."""
    x, y, z = p.T
    return np.stack([x + 0.1 * np.sin(2 * y), y + 0.1 * z**2 + 0.1 * x * z, z + 0.1 * np.cos(2 * x)], axis=1)


def normals(mesh: Mesh) -> tuple[Floats, float]:
    """∮ n dA (3,) and ⅓ ∮ p·n dA of the exterior faces as they are oriented."""
    total, volume = np.zeros(3), 0.0
    for name, faces in exterior_faces(mesh).items():
        rule = FACE_RULES[name]
        T = jacobians(mesh.points[faces], rule.dN)
        n = np.cross(T[..., 0], T[..., 1]) * rule.w[:, None]
        total += n.sum(axis=(0, 1))
        volume += float(np.einsum("fqi,fqi->", n, rule.N @ mesh.points[faces])) / 3
    return total, volume


@pytest.mark.parametrize(
    ("family", "count", "face"),
    [
        *(("tet4", 48, "tri3"), ("tet10", 48, "tri6"), ("hex8", 24, "quad4"), ("hex20", 24, "quad8")),
        *(("hex8r", 24, "quad4"), ("hex20r", 24, "quad8")),
    ],
)
def test_a_box_of_two_cubes_a_side_has_its_faces(family: str, count: int, face: str) -> None:
    faces = exterior_faces(box(family, (2, 2, 2)))
    assert {name: len(nodes) for name, nodes in faces.items()} == {face: count}


def test_wedges_have_triangles_and_quadrilaterals() -> None:
    faces = exterior_faces(box("wedge6", (2, 2, 2)))
    assert {name: len(nodes) for name, nodes in faces.items()} == {"tri3": 16, "quad4": 16}


@pytest.mark.parametrize("family", FAMILIES)
def test_the_surface_is_closed_and_outward(family: str) -> None:
    mesh = mapped(box(family, (2, 1, 2), (1.0, 2.0, 0.5)), lambda p: p + np.array([3.0, -1.0, 2.0]))
    total, volume = normals(mesh)
    np.testing.assert_allclose(total, 0, atol=ROUNDING * 10)
    assert volume == pytest.approx(1.0, rel=1e-12)  # divergence theorem; inward faces would give −1
    total, _ = normals(mapped(mesh, bent))
    np.testing.assert_allclose(total, 0, atol=ROUNDING * 10)


@pytest.mark.parametrize("family", FAMILIES)
def test_each_face_points_away_from_its_own_cell(family: str) -> None:
    mesh = box(family, (1, 1, 1))
    for nodes in mesh.cells[family]:
        centre = mesh.points[nodes].mean(axis=0)
        for face in CELL_FACES[family]:
            a, b, c = mesh.points[nodes[list(face[:3])]]
            assert np.cross(b - a, c - a) @ (a - centre) > 0


def test_a_face_between_families_is_interior_and_full_and_reduced_cells_share_theirs() -> None:
    wedges = box("wedge6", (1, 1, 1))
    hexahedron = mapped(box("hex8", (1, 1, 1)), lambda p: p + np.array([1.0, 0.0, 0.0]))
    reduced = mapped(box("hex8r", (1, 1, 1)), lambda p: p + np.array([2.0, 0.0, 0.0]))
    faces = exterior_faces(joined(joined(wedges, hexahedron), reduced))
    assert {name: len(nodes) for name, nodes in faces.items()} == {"tri3": 4, "quad4": 3 + 4 + 5}


def test_faces_inside_a_crack_belong_to_one_cell_each() -> None:
    left, right = (
        box("hex8", (1, 1, 1)),
        mapped(box("hex8", (1, 1, 1)), lambda p: p + np.array([1.0, 0.0, 0.0])),
    )
    cells = np.concatenate([left.cells["hex8"], right.cells["hex8"] + 8])
    apart = mesh_of(np.concatenate([left.points, right.points]), {"hex8": cells})
    assert len(exterior_faces(apart)["quad4"]) == 12


def area_weights(mesh: Mesh, nodes: Ints) -> Floats | None:
    """∫ N_i dA / A over the whole faces between the nodes."""
    faces = whole_faces(mesh, nodes)
    areas = nodal_sums(mesh.points, nodes, faces, node_areas)
    return areas / areas.sum() if faces else None


def side(mesh: Mesh, axis: int = 2, at: float = 0.0) -> Ints:
    return np.flatnonzero(np.isclose(mesh.points[:, axis], at))


@pytest.mark.parametrize(
    ("family", "corner", "middle"),
    [("hex8", 1 / 4, None), ("hex20", -1 / 12, 1 / 3), ("hex20r", -1 / 12, 1 / 3)],
)
def test_weights_of_one_square(family: str, corner: float, middle: float | None) -> None:
    mesh = box(family, (1, 1, 1))
    nodes = side(mesh)
    weights = area_weights(mesh, nodes)
    is_corner = np.isin(mesh.points[nodes], (0.0, 1.0)).all(axis=1)
    assert weights is not None
    np.testing.assert_allclose(weights[is_corner], corner, atol=ROUNDING)
    if middle is not None:
        np.testing.assert_allclose(weights[~is_corner], middle, atol=ROUNDING)


def test_weights_of_triangles() -> None:
    linear, quadratic = box("tet4", (1, 1, 1)), box("tet10", (1, 1, 1))
    face, face6 = exterior_faces(linear)["tri3"][0], exterior_faces(quadratic)["tri6"][0]
    np.testing.assert_allclose(area_weights(linear, face), 1 / 3, atol=ROUNDING)
    np.testing.assert_allclose(area_weights(quadratic, face6), [0, 0, 0, 1 / 3, 1 / 3, 1 / 3], atol=ROUNDING)


@pytest.mark.parametrize("family", FAMILIES)
def test_weights_average_linear_fields_over_the_area_in_the_order_of_the_nodes(family: str) -> None:
    mesh = box(family, (3, 2, 2), (3.0, 1.0, 1.0))
    nodes = np.random.default_rng(4).permutation(side(mesh))
    weights = area_weights(mesh, nodes)
    assert weights is not None
    assert weights.sum() == pytest.approx(1.0, abs=ROUNDING)
    np.testing.assert_allclose(weights @ mesh.points[nodes], [1.5, 0.5, 0.0], atol=1e-12)


def test_only_faces_whose_nodes_are_all_selected_count() -> None:
    mesh = box("hex8", (2, 1, 1), (2.0, 1.0, 1.0))
    below = mesh.points[:, 2] == 0
    nodes = np.flatnonzero(below & (mesh.points[:, 0] <= 1) | (mesh.points == [2.0, 0.0, 0.0]).all(axis=1))
    weights = area_weights(mesh, nodes)
    assert weights is not None
    alone = mesh.points[nodes, 0] == 2
    np.testing.assert_allclose(weights, np.where(alone, 0.0, 0.25), atol=ROUNDING)


@pytest.mark.parametrize("nodes", [[0], [0, 1, 2], []])
def test_no_whole_face_no_weights(nodes: list[int]) -> None:
    assert area_weights(box("hex20", (1, 1, 1)), np.array(nodes, dtype=np.int64)) is None


@pytest.mark.parametrize(("family", "missing"), [("tet10", 1), ("hex8", 1), ("hex20", 1)])
def test_a_face_without_one_of_its_nodes_does_not_count(family: str, missing: int) -> None:
    """All corners but one mid-edge node, or three corners of four, are no whole face."""
    mesh = box(family, (1, 1, 1))
    (_, faces), *_ = exterior_faces(mesh).items()
    assert area_weights(mesh, np.sort(faces[0])) is not None
    assert area_weights(mesh, np.sort(faces[0][:-missing])) is None


def test_a_whole_face_between_two_cells_is_not_a_surface() -> None:
    mesh = box("hex8", (2, 1, 1), (2.0, 1.0, 1.0))
    assert area_weights(mesh, side(mesh, axis=0, at=1.0)) is None


def area(mesh: Mesh, axis: int, at: float, shape: Mesh) -> float:
    """Area of the faces of `mesh` that are on one side of the box it was mapped from."""
    on_side = np.zeros(len(mesh.points), dtype=np.bool_)
    on_side[side(shape, axis, at)] = True
    faces = exterior_faces(mesh)
    return sum(
        float(node_areas(mesh.points, name, nodes[on_side[nodes].all(axis=1)]).sum())
        for name, nodes in faces.items()
    )


def cylinder(p: Floats) -> Floats:
    """A quarter of a tube, radius 1 … 2, from the unit cube."""
    angle, radius = np.pi / 2 * p[:, 0], 2.0 - p[:, 1]
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), -p[:, 2]], axis=1)


def sphere(p: Floats) -> Floats:
    """The sixth of a ball's shell between the planes |x| = z, |y| = z, radius 1 … 2."""
    t = np.tan(np.pi / 2 * (p[:, :2] - 0.5))
    direction = np.column_stack([t, np.ones(len(p))])
    return (1 + p[:, 2:]) * direction / np.linalg.norm(direction, axis=1)[:, None]


@pytest.mark.parametrize(
    ("family", "order"), [("tet4", 2), ("wedge6", 2), ("hex8", 2), ("tet10", 4), ("hex20", 4)]
)
@pytest.mark.parametrize(
    ("f", "axis", "at", "exact"),
    [(cylinder, 1, 0.0, np.pi), (sphere, 2, 1.0, 4 * np.pi * 2.0**2 / 6)],
    ids=["cylinder", "sphere"],
)
def test_curved_areas_converge(family, order, f, axis, at, exact) -> None:
    """Area of an interpolated surface: h² with flat faces, h⁴ with quadratic ones."""
    errors = []
    for count in (2, 4, 8):
        shape = box(family, (count, count, 1) if axis == 2 else (count, 1, count))
        errors.append(abs(area(mapped(shape, f), axis, at, shape) - exact) / exact)
    assert np.log2(errors[-2] / errors[-1]) > order - 0.3
    assert errors[-1] < 0.02 if order == 2 else errors[-1] < 1e-4


def test_curved_faces_weigh_where_their_area_is() -> None:
    """∫ p dA / A of a quarter of a cylinder: radius · 2/π in x and y, the middle in z."""
    shape = box("hex20", (8, 1, 2))
    mesh = mapped(shape, cylinder)
    nodes = side(shape, 1, 0.0)
    weights = area_weights(mesh, nodes)
    assert weights is not None
    np.testing.assert_allclose(weights @ mesh.points[nodes], [4 / np.pi, 4 / np.pi, -0.5], rtol=1e-5)
    # equal weights per node are another mean: the corners' negative weights matter
    assert abs(mesh.points[nodes].mean(axis=0) - [4 / np.pi, 4 / np.pi, -0.5]).max() > 1e-3


@pytest.mark.parametrize("family", FAMILIES)
def test_whole_faces_are_those_exterior_ones_whose_nodes_are_all_there(family: str) -> None:
    mesh = box(family, (3, 2, 2))
    chosen = np.random.default_rng(3).permutation(len(mesh.points))[: 3 * len(mesh.points) // 4]
    for nodes in (chosen, side(mesh), side(mesh, 0, 1 / 3), np.arange(len(mesh.points))):
        wanted = {name: f[np.isin(f, nodes).all(axis=1)] for name, f in exterior_faces(mesh).items()}
        found = whole_faces(mesh, nodes)
        assert found.keys() == {name for name, faces in wanted.items() if len(faces)}
        for name, faces in found.items():
            np.testing.assert_array_equal(faces, wanted[name])


@pytest.mark.parametrize(
    ("family", "face", "shares"),
    [
        ("tet4", "tri3", [1 / 3] * 3),
        ("hex8", "quad4", [1 / 4] * 4),
        ("tet10", "tri6", [3 / 57] * 3 + [16 / 57] * 3),
        ("hex20", "quad8", [3 / 76] * 4 + [16 / 76] * 4),
    ],
)
def test_shares_of_flat_faces_are_the_published_ones(family: str, face: str, shares: list[float]) -> None:
    """3/76 and 16/76, 3/57 and 16/57 (Cook, Malkus & Plesha, Concepts and Applications of Finite Element
    Analysis, 3rd ed., section 13.3)."""
    mesh = box(family, (1, 1, 1), (2.0, 3.0, 5.0))
    faces = exterior_faces(mesh)[face]
    areas = node_areas(mesh.points, face, faces).sum(axis=1)
    wanted = areas[:, None] * np.array(shares)
    np.testing.assert_allclose(node_shares(mesh.points, face, faces), wanted, rtol=1e-12)


@pytest.mark.parametrize("family", FAMILIES)
def test_shares_of_curved_faces_are_positive_and_add_up(family: str) -> None:
    mesh = mapped(box(family, (2, 2, 2)), bent)
    for name, faces in exterior_faces(mesh).items():
        shares = node_shares(mesh.points, name, faces)
        assert (shares > 0).all()
        areas = node_areas(mesh.points, name, faces)
        np.testing.assert_allclose(shares.sum(axis=1), areas.sum(axis=1), rtol=1e-13)


@pytest.mark.parametrize("family", FAMILIES)
def test_normals_point_outward_and_enclose_the_volume(family: str) -> None:
    """⅓ ∮ x·n dA = V of the isoparametric cells, to rounding on curved faces too: all is polynomial."""
    mesh = mapped(box(family, (2, 1, 2)), bent)
    enclosed, resultant = 0.0, np.zeros(3)
    for name, faces in exterior_faces(mesh).items():
        normals = node_normals(mesh.points, name, faces)
        enclosed += float(np.einsum("fai,fai->", normals, mesh.points[faces])) / 3
        resultant += normals.sum(axis=(0, 1))
    rule = ELEMENTS[family].mass
    volume = float((determinants(jacobians(mesh.points[mesh.cells[family]], rule.dN)) @ rule.w).sum())
    assert enclosed == pytest.approx(volume, rel=1e-12)
    np.testing.assert_allclose(resultant, 0, atol=1e-14)
