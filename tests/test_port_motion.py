"""Mean displacement and rotation of a port, and the forces and moments conjugate to them."""

import numpy as np
import pytest
from boxes import box, mapped

from precompute.arrays import Floats
from precompute.dofs import Dofs, mesh_dofs
from precompute.errors import PartError
from precompute.mesh import FAMILIES, Mesh
from precompute.node_table import NodeTable
from precompute.port_motion import motion
from precompute.ports import PortNodes, port_nodes

ROUNDING = 1e-13  # of sums over some tens of nodes of coordinates of order 1


def bent(p: Floats) -> Floats:
    """Curves every face, and puts the part away from the origin."""
    x, y, z = p.T
    return np.stack([5 + x + 0.1 * np.sin(2 * y), y + 0.1 * z**2 - 3, z + 0.2 * np.cos(2 * x)], axis=1)


def motions(port: PortNodes, dofs: Dofs) -> Floats:
    """All six rows, (6, n)."""
    return np.concatenate([motion(port, direction, dofs).toarray() for direction in range(6)])


def end(mesh: Mesh, shape: Mesh, weights: str = "area") -> PortNodes:
    return port_nodes(mesh, np.flatnonzero(shape.points[:, 2] == 1.0), weights, "end")


@pytest.mark.parametrize("weights", ["area", "equal"])
@pytest.mark.parametrize("family", FAMILIES)
def test_rigid_motions_are_read_exactly(family: str, weights: str) -> None:
    """u = t + θ × x on every family of faces, flat and curved: t + θ × x̄ and θ."""
    rng = np.random.default_rng(0)
    shape = box(family, (2, 3, 1))
    for mesh in (shape, mapped(shape, bent)):
        port = end(mesh, shape, weights)
        rows = motions(port, mesh_dofs(len(mesh.points)))
        for t, theta in rng.standard_normal((3, 2, 3)):
            u = (t + np.cross(theta, mesh.points)).ravel()
            centre = port.weights @ port.points
            np.testing.assert_allclose(rows[:3] @ u, t + np.cross(theta, centre), atol=20 * ROUNDING)
            np.testing.assert_allclose(rows[3:] @ u, theta, atol=20 * ROUNDING)


@pytest.mark.parametrize("family", FAMILIES)
def test_a_rotation_is_the_least_squares_one(family: str) -> None:
    """Of any motion: the θ of min Σ aᵢ |uᵢ − t − θ × xᵢ|² by a general least-squares solver."""
    shape = box(family, (2, 3, 1))
    mesh = mapped(shape, bent)
    port = end(mesh, shape)
    u = np.random.default_rng(1).standard_normal(mesh.points.shape)
    x, k = port.points, len(port.nodes)
    A = np.zeros((k, 3, 6))
    A[:, :, :3] = np.eye(3)
    for j in range(3):
        A[:, :, 3 + j] = np.cross(np.eye(3)[j], x)
    root = np.sqrt(np.repeat(port.shares, 3))
    fit = np.linalg.lstsq(root[:, None] * A.reshape(3 * k, 6), root * u[port.nodes].ravel(), rcond=None)[0]
    theta = motions(port, mesh_dofs(len(mesh.points)))[3:] @ u.ravel()
    np.testing.assert_allclose(theta, fit[3:], atol=100 * ROUNDING)
    # with equal shares it is another rotation
    other = motions(end(mesh, shape, "equal"), mesh_dofs(len(mesh.points)))[3:] @ u.ravel()
    assert np.abs(other - theta).max() > 1e-3


def test_a_moment_is_a_couple_and_a_force_has_none_about_the_centre() -> None:
    """Resultants of the nodal forces mᵀ: power-conjugate, so that Fᵀu = f·u_port + M·θ_port."""
    shape = box("hex20", (2, 2, 1))
    mesh = mapped(shape, bent)
    port = end(mesh, shape)
    rows = motions(port, mesh_dofs(len(mesh.points))).reshape(6, -1, 3)
    arm = mesh.points - port.weights @ port.points
    for k in range(3):
        force, moment = rows[k], rows[3 + k]
        np.testing.assert_allclose(force.sum(axis=0), np.eye(3)[k], atol=ROUNDING)
        np.testing.assert_allclose(np.cross(arm, force).sum(axis=0), 0, atol=10 * ROUNDING)
        np.testing.assert_allclose(moment.sum(axis=0), 0, atol=10 * ROUNDING)
        np.testing.assert_allclose(np.cross(arm, moment).sum(axis=0), np.eye(3)[k], atol=10 * ROUNDING)
    assert not rows[:, np.setdiff1d(np.arange(len(mesh.points)), port.nodes)].any()


def test_virtual_work_is_that_of_the_port() -> None:
    shape = box("tet10", (2, 2, 1))
    mesh = mapped(shape, bent)
    rows = motions(end(mesh, shape), mesh_dofs(len(mesh.points)))
    rng = np.random.default_rng(2)
    load, u = rng.standard_normal(6), rng.standard_normal(rows.shape[1])
    F = rows.T @ load
    moved = rows @ u
    assert F @ u == pytest.approx(load[:3] @ moved[:3] + load[3:] @ moved[3:], rel=1e-12)


def table(points: list[list[float]]) -> NodeTable:
    return NodeTable(np.array(points, dtype=float), 100 + np.arange(len(points)))


def port_of(body: NodeTable) -> PortNodes:
    return port_nodes(body, np.arange(len(body.points)), "equal", "hub")


def six(nodes: int) -> Dofs:
    """All six DOFs at each node."""
    return Dofs(np.repeat(np.arange(nodes), 6), np.tile(np.arange(6), nodes))


@pytest.mark.parametrize(
    "points",
    [
        [[1, 2, 3]],
        [[0.3, 0.7, 1], [0.1 + 0.2, 0.7, 1], [0.3, 0.1 * 7, 1]],
        [[0.1 * k, 0.7, 0.3] for k in range(7)],
    ],
)
def test_nodes_at_one_place_or_on_a_line_do_not_turn_about_it(points: list[list[float]]) -> None:
    """The three at one place are apart by the rounding of their coordinates."""
    port = port_of(table(points))
    with pytest.raises(PartError, match=r"port hub: got a rotation or moment about x, which .* not tell"):
        motion(port, 3, mesh_dofs(len(points)))


def test_nodes_on_a_line_turn_about_the_axes_across_it() -> None:
    body = table([[0.1 * k, 0.7, 0.3] for k in range(7)])
    u = np.cross([0.0, 2.0, 3.0], body.points).ravel()
    for direction, angle in ((4, 2.0), (5, 3.0)):
        row = motion(port_of(body), direction, mesh_dofs(7))
        assert (row @ u)[0] == pytest.approx(angle, rel=1e-12)
        assert not (abs(row.toarray()[0]).reshape(-1, 3)[:, 0] > 0).any()  # nothing along the line


def test_a_slanted_line_tells_no_axis() -> None:
    body = table([[k, k, 2.0 * k] for k in range(4)])
    for direction in (3, 4, 5):
        with pytest.raises(PartError, match="select nodes around the axis"):
            motion(port_of(body), direction, mesh_dofs(4))


def test_a_strip_a_thousand_times_longer_than_wide_turns_about_its_length() -> None:
    body = table([[x, y, 0.0] for x in range(5) for y in (0.0, 0.004)])
    u = np.cross([0.5, 0.0, 0.0], body.points).ravel()
    assert (motion(port_of(body), 3, mesh_dofs(10)) @ u)[0] == pytest.approx(0.5, rel=1e-9)


@pytest.mark.parametrize("points", [[[1, 2, 3]], [[k, k, 2 * k] for k in range(4)]])
def test_nodes_that_do_not_tell_a_rotation_give_their_own(points: list[list[float]]) -> None:
    body = table(points)
    dofs = six(len(points))
    u = np.random.default_rng(3).standard_normal((len(points), 6))
    for direction in range(6):
        row = motion(port_of(body), direction, dofs)
        assert (row @ u.ravel())[0] == pytest.approx(u[:, direction].mean(), rel=1e-12)


def test_nodes_around_an_axis_give_the_rotation_of_their_displacements() -> None:
    """Also where they have rotations of their own, such as the local ones of a shell."""
    body = table([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0.5]])
    u = np.zeros((4, 6))
    u[:, :3] = np.cross([0.1, 0.2, 0.3], body.points)
    u[:, 3:] = 7.0
    rows = motions(port_of(body), six(4))
    np.testing.assert_allclose(rows[3:] @ u.ravel(), [0.1, 0.2, 0.3], atol=ROUNDING)


def test_a_missing_dof_is_named_and_one_that_is_not_needed_is_not() -> None:
    """Four nodes in the plane z = 0 that move in x and y only, the third without y."""
    body = table([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    plane = Dofs(np.repeat(np.arange(4), 2), np.tile(np.arange(2), 4))
    row = motion(port_of(body), 5, plane)
    u = np.cross([0, 0, 0.25], body.points)[:, :2].ravel()
    assert (row @ u)[0] == pytest.approx(0.25, rel=1e-12)
    keep = np.arange(8) != 5
    without = Dofs(plane.node[keep], plane.direction[keep])
    motion(port_of(body), 0, without)
    with pytest.raises(PartError, match=r"port hub: node 102 has no DOF in y, expected one"):
        motion(port_of(body), 1, without)
    with pytest.raises(PartError, match=r"node 102 has no DOF in y"):
        motion(port_of(body), 5, without)
    with pytest.raises(PartError, match=r"node 100 has no DOF in z"):
        motion(port_of(body), 2, plane)


def test_rotations_need_coordinates() -> None:
    body = table([[0, 0, 0], [1, 0, np.nan], [1, 1, 0]])
    motion(port_of(body), 0, mesh_dofs(3))
    with pytest.raises(PartError, match="node 101 has no coordinates"):
        motion(port_of(body), 3, mesh_dofs(3))
