"""Ports that are held and moved, u = T û + P s, and the static shapes Ψ, against null spaces."""

import logging
from dataclasses import replace

import numpy as np
import pytest
from boxes import box, mapped
from scipy.linalg import eigh, null_space
from scipy.sparse import csr_array, vstack
from solids import held, system_of

from precompute.arrays import Floats, Ints
from precompute.constrained import Constrained
from precompute.dofs import mesh_dofs
from precompute.eigen import solve_modes
from precompute.errors import PartError
from precompute.moved_ports import hold_motions
from precompute.moving_shapes import MovingShapes, moving_shapes
from precompute.notice import LOGGER_NAME
from precompute.port_elements import with_springs
from precompute.port_motion import motion
from precompute.ports import PortNodes, port_nodes
from precompute.rigid_ports import constrain
from precompute.statics import static_solver
from precompute.system import System

NONE: Ints = np.zeros(0, dtype=np.int64)
SHAPE = box("hex8", (4, 2, 1), (4.0, 2.0, 1.0))
MESH = mapped(SHAPE, lambda p: p + 0.1 * np.sin(p[:, [1, 2, 0]]) + np.array([7, 0, -5]))
X, Y, Z = SHAPE.points.T
DOFS = mesh_dofs(len(X))
N = len(DOFS.node)
BODY = system_of(MESH, young=3.0, poisson=0.3, density=2.0)


def port(chosen: Floats, name: str, weights: str = "equal") -> PortNodes:
    return port_nodes(MESH, np.flatnonzero(chosen), weights, name)


LEFT, RIGHT, MIDDLE = port(X == 0, "left"), port(X == 4, "right", "area"), port(X == 2, "middle")
FLANGE = port(X == 4, "flange")
CORNER = port((X == 0) & (Y == 0) & (Z == 0), "corner")
Move = tuple[PortNodes, int]
ALL = range(6)
CASES: dict[str, tuple[Ints, list[PortNodes], list[Move]]] = {
    "free, one direction": (NONE, [], [(LEFT, 0)]),
    "free, a node": (NONE, [], [(CORNER, 0), (CORNER, 1), (CORNER, 2)]),
    "free, all of a face": (NONE, [], [(RIGHT, d) for d in ALL]),
    "free, a rigid face": (NONE, [FLANGE], [(FLANGE, d) for d in ALL]),
    "free, two of a rigid face": (NONE, [FLANGE], [(FLANGE, 1), (FLANGE, 5)]),
    "free, three ports": (NONE, [FLANGE], [(LEFT, 0), (FLANGE, 0), (MIDDLE, 0), (FLANGE, 4)]),
    "clamped": (held(X == 0, "xyz"), [], [(RIGHT, 2), (MIDDLE, 1), (RIGHT, 3)]),
    "partly held": (held(Y == 0, "z"), [], [(RIGHT, 2), (LEFT, 0)]),
    "slides": (held(Z == 0, "yz"), [], [(LEFT, 0)]),
}


def rows(moves: list[Move]) -> csr_array:
    return csr_array(vstack([motion(where, direction, DOFS) for where, direction in moves]))


def constrained(fixed: Ints, rigid: list[PortNodes], moves: list[Move]) -> Constrained:
    names = [(where.name, f"direction {direction}") for where, direction in moves]
    return hold_motions(constrain(BODY, fixed, DOFS, rigid), rows(moves), names)


def shapes(of: Constrained, fixed: Ints, system: System = BODY) -> MovingShapes:
    with static_solver(of.system, of.fixed) as solve:
        return moving_shapes(of, system, fixed, solve)


def free_of(of: Constrained) -> Ints:
    return np.setdiff1d(np.arange(of.T.shape[1]), of.fixed)


@pytest.mark.parametrize("name", CASES)
def test_what_is_held_rests_and_what_is_moved_moves(name: str) -> None:
    """W T = 0 whatever û is, W P = I, L T = I, as many DOFs fewer as there are motions."""
    fixed, rigid, moves = CASES[name]
    of, before = constrained(fixed, rigid, moves), constrain(BODY, fixed, DOFS, rigid)
    T = of.T.toarray()[:, free_of(of)]
    np.testing.assert_allclose(of.W @ T, 0, atol=1e-14)  # sums over some tens of nodes
    np.testing.assert_allclose((of.W @ of.P).toarray(), np.eye(len(moves)), atol=1e-13)
    np.testing.assert_allclose((of.L @ of.T).toarray(), np.eye(of.T.shape[1]), atol=1e-13)
    assert of.T.shape[1] == before.T.shape[1] - len(moves)
    np.testing.assert_array_equal(of.origin[of.fixed], before.origin[before.fixed])
    assert not of.P.toarray()[fixed].any()


@pytest.mark.parametrize("name", ["free, one direction", "free, all of a face", "free, a node"])
def test_rigid_motions_are_the_nearest_that_leave_the_ports_at_rest(name: str) -> None:
    """T R̂ = (I − W⁺W) R: smooth, where a motion of the pivots alone would have their energy."""
    of = constrained(*CASES[name])
    W = of.W.toarray()
    wanted = BODY.rigid - np.linalg.pinv(W) @ (W @ BODY.rigid)
    np.testing.assert_allclose(of.T @ of.system.rigid, wanted, atol=1e-12)


@pytest.mark.parametrize("name", CASES)
def test_modes_are_those_of_the_null_space(name: str) -> None:
    """ZᵀKZ y = λ ZᵀMZ y with Z all that supports, rigid ports and held ones allow; as many rigid ones."""
    fixed, rigid, moves = CASES[name]
    of = constrained(fixed, rigid, moves)
    first = constrain(BODY, fixed, DOFS, rigid)
    allowed = first.T.toarray()[:, np.setdiff1d(np.arange(first.T.shape[1]), first.fixed)]
    allowed = allowed @ null_space(of.W @ allowed)
    K, M = (allowed.T @ A.toarray() @ allowed for A in (BODY.K, BODY.M))
    lam = eigh(K, M, eigvals_only=True)
    found = solve_modes(of.system, of.fixed, count=16)
    assert found.rigid == np.sum(lam < 1e-9 * lam[-1])
    np.testing.assert_allclose(found.lam[found.rigid :], lam[found.rigid : 16], rtol=1e-9)  # κ(K) ε
    assert np.abs(of.W @ of.T @ found.Phi).max() < 1e-13 * np.abs(of.T @ found.Phi).max()


@pytest.mark.parametrize("name", CASES)
def test_shapes_follow_statically(name: str) -> None:
    """Ψ = 0 at supports, W Ψ = I, the rigid port rigid; elsewhere K Ψ = Wᵀμ and forces within rigid ports."""
    fixed, rigid, moves = CASES[name]
    of = constrained(fixed, rigid, moves)
    found = shapes(of, fixed)
    Psi, KPsi = found.Psi, BODY.K @ found.Psi
    assert not Psi[fixed].any()
    np.testing.assert_allclose(of.W @ Psi, np.eye(len(moves)), atol=1e-12)
    scale = (abs(BODY.K) @ np.abs(Psi)).max()
    np.testing.assert_allclose((of.T.T @ KPsi)[free_of(of)], 0, atol=1e-14 * scale)
    np.testing.assert_allclose(BODY.K @ found.elastic, KPsi, atol=1e-14 * scale)
    if rigid:
        first = constrain(BODY, fixed, DOFS, rigid)
        np.testing.assert_allclose(first.T @ (first.L @ Psi), Psi, atol=1e-12 * np.abs(Psi).max())
    free = np.setdiff1d(np.arange(N), fixed)
    if not rigid:  # μ alone, spread as W says
        mu = np.linalg.lstsq(of.W.toarray()[:, free].T, KPsi[free], rcond=None)[0]
        np.testing.assert_allclose(of.W.toarray()[:, free].T @ mu, KPsi[free], atol=1e-13 * scale)


@pytest.mark.parametrize("name", ["free, one direction", "free, all of a face", "free, a rigid face"])
def test_a_free_part_follows_as_a_rigid_body(name: str) -> None:
    """K Ψ is not rounding but 0; all six: Ψ is the rigid motion itself."""
    fixed, rigid, moves = CASES[name]
    of = constrained(fixed, rigid, moves)
    found = shapes(of, fixed)
    assert not found.elastic.any()
    if len(moves) == 6:
        where = moves[0][0]
        r = MESH.points - where.weights @ where.points
        wanted = np.stack(
            [
                *(np.tile(e, (len(r), 1)).ravel() for e in np.eye(3)),
                *(np.cross(e, r).ravel() for e in np.eye(3)),
            ],
            axis=1,
        )
        np.testing.assert_allclose(found.Psi, wanted, atol=1e-13)


def test_only_what_the_body_cannot_follow_rigidly_deforms_it() -> None:
    """A flange moved in six directions, a face in x: sideways motions of the flange strain nothing."""
    found = shapes(constrained(NONE, [FLANGE], [*((FLANGE, d) for d in ALL), (LEFT, 0)]), NONE)
    assert not found.elastic[:, 1:4].any()  # y, z, about x
    assert found.elastic[:, [0, 6]].any(axis=0).all()
    np.testing.assert_allclose(found.elastic[:, 0], -found.elastic[:, 6], atol=1e-12)


def test_what_the_held_ports_leave_free_is_not_driven() -> None:
    """ΨᵀM R = 0 for the rigid motions R left: ΨᵀMΨ is the mass that the port feels, 1/(WR (RᵀMR)⁻¹RᵀWᵀ)."""
    of = constrained(NONE, [], [(LEFT, 1)])
    with static_solver(of.system, of.fixed) as solve:
        left = of.T @ solve.rigid
    Psi = shapes(of, NONE).Psi
    assert left.shape[1] == 5
    np.testing.assert_allclose(left.T @ (BODY.M @ Psi), 0, atol=1e-13)
    R = BODY.rigid
    felt = 1 / (of.W @ R @ np.linalg.inv(R.T @ (BODY.M @ R)) @ (of.W @ R).T)
    np.testing.assert_allclose(Psi.T @ (BODY.M @ Psi), felt, rtol=1e-12)
    assert felt[0, 0] < 0.5 * (R[:, 1] @ (BODY.M @ R[:, 1]))  # pushed at its end the part turns


def test_a_spring_to_ground_holds_the_part_as_a_support_does() -> None:
    """The port takes the part along in x, against the spring: ΨᵀKΨ is the stiffness of both in series.

    Guides leave nothing else: a part that could turn would get out of the spring's way.
    """
    guided = held(Z == 0, "yz")
    sprung = with_springs(BODY, [(motion(FLANGE, 0, DOFS), 0.5)])
    W = rows([(LEFT, 0)])
    of = hold_motions(constrain(sprung, guided, DOFS, []), W, [("left", "motion.x")])
    found = shapes(of, guided, sprung)
    both = rows([(LEFT, 0), (FLANGE, 0)])
    with static_solver(BODY, guided) as solve:
        F = solve(both.T.toarray())
    G, r = both @ F, both @ solve.rigid
    # [G + diag(0, 1/k), r; rᵀ, 0] [μ; c] = [1; 0; 0]: two forces in equilibrium with each other
    A = np.block([[G + np.diag([0.0, 2.0]), r], [r.T, np.zeros((1, 1))]])
    mu = np.linalg.solve(A, np.eye(3)[0])
    assert (found.elastic.T @ (sprung.K @ found.elastic))[0, 0] == pytest.approx(mu[0], rel=1e-10)
    assert 0 < mu[0] < 0.5


def test_no_motion_leaves_everything_as_it_is() -> None:
    before = constrain(BODY, CASES["clamped"][0], DOFS, [FLANGE])
    assert hold_motions(before, csr_array((0, N)), []) is before


def test_damping_matrices_are_held_too() -> None:
    damped = replace(BODY, D=csr_array(0.1 * BODY.M + 0.01 * BODY.K))
    of = hold_motions(constrain(damped, NONE, DOFS, [FLANGE]), rows([(LEFT, 0)]), [("left", "motion.x")])
    assert of.system.D is not None
    difference = of.system.D - 0.1 * of.system.M - 0.01 * of.system.K
    assert abs(difference).max() < 1e-14 * abs(of.system.D).max()


class TestMistakes:
    def told(self, fixed: Ints, rigid: list[PortNodes], moves: list[tuple[PortNodes, int, str]]) -> str:
        W = rows([(where, direction) for where, direction, _ in moves])
        names = [(where.name, key) for where, _, key in moves]
        with pytest.raises(PartError) as caught:
            hold_motions(constrain(BODY, fixed, DOFS, rigid), W, names)
        return str(caught.value)

    def test_a_support_holds_it(self) -> None:
        found = self.told(held(X == 0, "z"), [], [(LEFT, 0, "motion.x"), (LEFT, 2, "motion.z")])
        assert found == (
            "port left: got the input motion.z, but supports hold the port so; remove it, or hold less"
        )

    def test_another_port_moves_it_already(self) -> None:
        twin = port(X == 4, "right")
        moves = [(twin, 0, "motion.x"), (LEFT, 2, "motion.z"), (FLANGE, 0, "motion.x")]
        found = self.told(NONE, [FLANGE], moves)
        assert found == (
            "port flange: got the input motion.x, which follows from right.motion.x, left.motion.z already, "
            "expected motions that are independent; remove it, or let the ports overlap less"
        )

    def test_overlapping_ports_that_are_independent_are_legal(self) -> None:
        some = port((X == 4) & (Z == 1), "upper")
        of = hold_motions(constrain(BODY, NONE, DOFS, []), rows([(RIGHT, 0), (some, 0)]), [("", "")] * 2)
        np.testing.assert_allclose((of.W @ of.P).toarray(), np.eye(2), atol=1e-14)

    def test_a_seventh_motion_of_a_rigid_body(self) -> None:
        moves = [(FLANGE, d, f"direction {d}") for d in ALL] + [(RIGHT, 4, "angular_motion.y")]
        assert "got the input angular_motion.y, which follows from flange.direction 0, " in self.told(
            NONE, [FLANGE], moves
        )


def test_many_nodes_that_average_are_warned_of(
    caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("precompute.moved_ports.MANY", 4)
    with caplog.at_level(logging.WARNING, LOGGER_NAME):
        constrained(*CASES["free, a rigid face"])
        assert not caplog.text  # its six coordinates go, nothing is coupled
        constrained(*CASES["free, one direction"])
    assert "couples the 6 DOFs of its port with each other" in caplog.text
