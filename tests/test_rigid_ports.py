"""Rigid ports u = T û against constraints by Lagrange multipliers, and the motions that they keep."""

import numpy as np
import pytest
from boxes import box, mapped
from scipy.linalg import eigh, null_space
from scipy.sparse import csr_array
from solids import held, system_of

from precompute.arrays import Floats, Ints
from precompute.assembly import assemble
from precompute.coupled_damping import projected_damping
from precompute.dofs import Dofs, mesh_dofs
from precompute.eigen import solve_modes
from precompute.errors import PartError
from precompute.material import CellMaterial
from precompute.node_table import NodeTable
from precompute.port_motion import motion
from precompute.ports import PortNodes, port_nodes
from precompute.rigid_ports import constrain
from precompute.statics import static_solver
from precompute.system import System, rigid_motions

NONE = np.zeros(0, dtype=np.int64)
MESH = mapped(
    box("hex8", (4, 2, 1), (4.0, 2.0, 1.0)),
    lambda p: p + 0.1 * np.sin(p[:, [1, 2, 0]]) + np.array([7, 0, -5]),
)
SHAPE = box("hex8", (4, 2, 1), (4.0, 2.0, 1.0)).points
DOFS = mesh_dofs(len(MESH.points))
ROOT = held(SHAPE[:, 0] == 0, "xyz")


def body() -> System:
    return system_of(MESH, young=3.0, poisson=0.3, density=2.0)


def port(chosen: Floats, name: str = "flange") -> PortNodes:
    return port_nodes(MESH, np.flatnonzero(chosen), "equal", name)


FLANGE = port(SHAPE[:, 0] == 4)
CORE = port((SHAPE[:, 0] == 2) & (SHAPE[:, 1] > 0), "core")


def violations(ports: list[PortNodes]) -> Floats:
    """G (g, n) with G u = 0 where the nodes of each port move as rigid bodies: G ⊥ their six motions."""
    rows = []
    for each in ports:
        arm = each.points - each.points[0]
        R = np.zeros((len(arm), 3, 6))
        for k in range(3):
            R[:, k, k] = 1.0
            R[:, :, 3 + k] = np.cross(np.eye(3)[k], arm)
        place = (3 * each.nodes[:, None] + np.arange(3)).ravel()
        G = null_space(R.reshape(-1, 6).T).T
        whole = np.zeros((len(G), len(DOFS.node)))
        whole[:, place] = G
        rows.append(whole)
    return np.concatenate(rows)


def test_statics_as_by_lagrange_multipliers() -> None:
    """[K Gᵀ; G 0] [u; μ] = [F; 0] at the free DOFs; forces and moments at each port, and any load."""
    system, ports = body(), [FLANGE, CORE]
    loads = [motion(each, direction, DOFS).toarray()[0] for each in ports for direction in range(6)]
    F = np.stack([*loads, np.random.default_rng(0).standard_normal(len(DOFS.node))], axis=1)
    free = np.setdiff1d(np.arange(len(F)), ROOT)
    G = violations(ports)[:, free]
    K = np.block([[system.K.toarray()[np.ix_(free, free)], G.T], [G, np.zeros((len(G), len(G)))]])
    exact = np.zeros_like(F)
    exact[free] = np.linalg.solve(K, np.concatenate([F[free], np.zeros((len(G), F.shape[1]))]))[: len(free)]
    c = constrain(system, ROOT, DOFS, ports)
    with static_solver(c.system, c.fixed) as solve:
        found = c.T @ solve(c.T.T @ F)
    np.testing.assert_allclose(found, exact, atol=1e-11 * np.abs(exact).max())
    # the same part without rigid ports is softer
    with static_solver(system, ROOT) as solve:
        assert np.abs(solve(F) - exact).max() > 0.01 * np.abs(exact).max()


@pytest.mark.parametrize(
    ("fixed", "end"), [(ROOT, FLANGE), (held(SHAPE[:, 0] == 4, "xyz"), port(SHAPE[:, 0] == 0))]
)
def test_frequencies_as_between_the_allowed_motions(fixed: Ints, end: PortNodes) -> None:
    """The eigenproblem in a basis of the null space of the constraints, with supports before and behind."""
    system, ports = body(), [end, CORE]
    free = np.setdiff1d(np.arange(len(DOFS.node)), fixed)
    N = null_space(violations(ports)[:, free])
    K, M = (N.T @ A.toarray()[np.ix_(free, free)] @ N for A in (system.K, system.M))
    c = constrain(system, fixed, DOFS, ports)
    assert c.system.K.shape[0] == len(DOFS.node) - 3 * len(end.nodes) - 3 * len(CORE.nodes) + 12
    found = solve_modes(c.system, c.fixed, count=10)
    np.testing.assert_allclose(found.lam, eigh(K, M, eigvals_only=True)[:10], rtol=1e-9)
    Phi = c.T @ found.Phi
    np.testing.assert_allclose(Phi.T @ system.M @ Phi, np.eye(10), atol=1e-11)
    np.testing.assert_allclose(violations(ports) @ Phi, 0, atol=1e-12)
    assert not Phi[fixed].any()


def test_a_free_body_keeps_its_six_rigid_modes() -> None:
    system = body()
    c = constrain(system, NONE, DOFS, [FLANGE])
    np.testing.assert_allclose(c.T @ c.system.rigid, system.rigid, atol=1e-12)
    assert np.count_nonzero(solve_modes(c.system, c.fixed, count=8).lam == 0) == 6


@pytest.mark.parametrize("inside", [1.0, 1e5])
def test_what_a_rigid_port_holds_may_be_of_any_stiffness(inside: float) -> None:
    """Its cells do not deform: λ and the damping of their β stay what they are, and rigid motions free of
    both, though the forces that cancel in a stiff port exceed all that the rest of the body has."""
    hub = (SHAPE[:, 0] <= 2)[MESH.cells["hex8"]].all(axis=1)
    materials = [
        CellMaterial("hub", 3.0 * inside, 0.3, 2.0, {"hex8": np.flatnonzero(hub)}, beta=0.1),
        CellMaterial("rest", 3.0, 0.3, 2.0, {"hex8": np.flatnonzero(~hub)}, beta=0.2),
    ]
    c = constrain(assemble(MESH, materials), NONE, DOFS, [port(SHAPE[:, 0] <= 2)])
    modes = solve_modes(c.system, c.fixed, count=12)
    assert modes.rigid == 6
    alone = constrain(body(), NONE, DOFS, [port(SHAPE[:, 0] <= 2)])
    np.testing.assert_allclose(
        modes.lam[6:], solve_modes(alone.system, alone.fixed, count=12).lam[6:], rtol=1e-9
    )  # rounding of a stiffness 1e5 times the rest's
    D = projected_damping(modes.lam, modes.Phi, c.system.D, [])
    assert not D[:6].any()
    np.testing.assert_allclose(D, np.diag(0.2 * modes.lam), atol=1e-9 * modes.lam[-1])


def test_forces_and_moments_act_on_the_ports_own_motions() -> None:
    """mᵀ projected is a combination of the port's six DOFs alone, and reads them back."""
    c = constrain(body(), ROOT, DOFS, [CORE, FLANGE])
    n = c.T.shape[1]
    rng = np.random.default_rng(1)
    for each, own in ((CORE, range(n - 12, n - 6)), (FLANGE, range(n - 6, n))):
        t, theta = rng.standard_normal((2, 3))
        u = np.zeros((len(DOFS.node) // 3, 3))
        u[each.nodes] = t + np.cross(theta, each.points - each.points.mean(axis=0))
        hat = np.linalg.lstsq(c.T.toarray(), u.ravel(), rcond=None)[0]
        np.testing.assert_allclose(c.T @ hat, u.ravel(), atol=1e-12)
        for direction, wanted in enumerate([*t, *theta]):
            row = (motion(each, direction, DOFS) @ c.T).toarray()[0]
            assert row @ hat == pytest.approx(wanted, abs=1e-12)
            np.testing.assert_allclose(np.delete(row, own), 0, atol=1e-14)


def test_matrices_stay_symmetric_sorted_and_scaled() -> None:
    system = body()
    damped = System(system.M, system.K, system.rigid, D=system.K * 0.1)
    c = constrain(damped, ROOT, DOFS, [FLANGE])
    assert c.system.D is not None
    for A in (c.system.M, c.system.K, c.system.D):
        assert (A != A.T).nnz == 0
        assert A.has_sorted_indices
        assert A.indices.dtype == np.int32
    np.testing.assert_allclose(c.system.D.toarray(), 0.1 * c.system.K.toarray(), atol=1e-13)
    TT = (c.T.T @ c.T).toarray()
    wanted = np.ones(len(TT))
    wanted[-6:] = len(FLANGE.nodes)
    np.testing.assert_allclose(TT, np.diag(wanted), atol=1e-12)


def test_every_dof_says_where_it_is_from() -> None:
    c = constrain(body(), ROOT, DOFS, [FLANGE])
    np.testing.assert_array_equal(c.origin[c.fixed], np.sort(ROOT))
    assert set(c.origin[-6:]) == {3 * FLANGE.nodes[0]}
    u = c.T @ np.arange(c.T.shape[1], dtype=float)
    np.testing.assert_array_equal(u[c.origin[:-6]], np.arange(c.T.shape[1] - 6))


def test_without_rigid_ports_nothing_changes() -> None:
    system = body()
    c = constrain(system, ROOT, DOFS, [])
    assert c.system is system
    assert (csr_array(np.eye(len(DOFS.node))) != c.T).nnz == 0
    np.testing.assert_array_equal(c.fixed, ROOT)


def frame(points: list[list[float]], directions: int) -> tuple[PortNodes, Dofs, System]:
    """Nodes with so many DOFs each in one port, and one node more; K = M = I."""
    k = len(points)
    table = NodeTable(np.array([*points, [3.0, 4, 5]]), 10 + np.arange(k + 1))
    dofs = Dofs(np.repeat(np.arange(k + 1), directions), np.tile(np.arange(directions), k + 1))
    unit = csr_array(np.eye((k + 1) * directions))
    return (
        port_nodes(table, np.arange(k), "equal", "hub"),
        dofs,
        System(unit, unit, rigid_motions(dofs, table.points)),
    )


LINE = [[0.0, 0, 0], [1, 1, 0], [2, 2, 0]]
ANGLE = [[0.0, 0, 0], [1, 0, 0], [0, 2, 0]]


@pytest.mark.parametrize(
    ("points", "each", "left"),
    [(LINE, 3, 5), (LINE, 6, 6), (LINE[:1], 3, 3), (LINE[:1], 6, 6), (ANGLE, 6, 6)],
)
def test_a_port_has_the_motions_that_its_nodes_show(points: list[list[float]], each: int, left: int) -> None:
    """A line of solid nodes does not show its turning, one with rotations of its own does."""
    hub, dofs, system = frame(points, each)
    c = constrain(system, NONE, dofs, [hub])
    assert c.T.shape[1] == left + each
    # they span the rigid motions, at displacements and rotations
    u = system.rigid @ np.array([0.1, 0.2, 0.3, 0.4, 0.5, 0.6])
    fit = np.linalg.lstsq(c.T.toarray(), u, rcond=None)[0]
    np.testing.assert_allclose(c.T @ fit, u, atol=1e-14)
    assert np.linalg.matrix_rank(c.T.toarray()) == left + each


def test_a_node_in_two_rigid_ports_is_refused() -> None:
    node = MESH.node_ids[FLANGE.nodes[0]]
    with pytest.raises(PartError, match=rf"port end: node {node} belongs to the rigid port flange too"):
        constrain(body(), ROOT, DOFS, [FLANGE, port(SHAPE[:, 0] >= 3, "end")])


def test_a_held_node_in_a_rigid_port_is_refused() -> None:
    with pytest.raises(PartError, match=r"port base: a support holds its node 1 in x; a rigid port must"):
        constrain(body(), ROOT, DOFS, [port(SHAPE[:, 0] == 0, "base")])


def test_a_port_of_all_nodes_is_refused() -> None:
    with pytest.raises(PartError, match="port flange: got all nodes of the part, which could not deform"):
        constrain(body(), NONE, DOFS, [port(SHAPE[:, 0] <= 4)])


def test_a_node_without_a_dof_is_refused() -> None:
    hub, dofs, system = frame(ANGLE, 2)
    with pytest.raises(PartError, match=r"port hub: node 10 has no DOF in z"):
        constrain(system, NONE, dofs, [hub])


def test_a_rigid_port_needs_coordinates() -> None:
    hub, dofs, system = frame([[0, 0, 0], [1, np.nan, 0], [0, 0, 1]], 3)
    with pytest.raises(PartError, match="port hub: node 11 has no coordinates"):
        constrain(system, NONE, dofs, [hub])
