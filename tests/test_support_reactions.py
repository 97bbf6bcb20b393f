"""Reactions of supports against the full residual M ü + D u̇ + K u − F at the held DOFs."""

import logging
from dataclasses import replace

import numpy as np
import pytest
from boxes import box, mapped
from scipy.sparse import csr_array
from solids import held, system_of

from fmu_src.runtime.model import Port
from precompute.arrays import Ints
from precompute.dofs import mesh_dofs
from precompute.errors import ModalFmuError, PartError
from precompute.exchange import Exchange
from precompute.interface import Interface, build_interface
from precompute.notice import LOGGER_NAME
from precompute.port_motion import motion
from precompute.ports import port_nodes
from precompute.rigid_ports import constrain
from precompute.statics import static_solver
from precompute.support_reactions import Held, own_dofs
from precompute.system import System

MESH = mapped(
    box("hex8", (3, 1, 2), (3.0, 1.0, 2.0)), lambda p: p @ np.array([[1, 0, 0.3], [0, 1, 0], [0, 0, 1]])
)
X, Y, Z = MESH.points.T
DOFS = mesh_dofs(len(MESH.points))
LEFT, RIGHT = X == 0, X == 3
ALPHA, BETA = 0.2, 0.05


def softened() -> System:
    """A soft block, with some damping that is neither α M nor β K."""
    block = system_of(MESH, young=3.0, poisson=0.3, density=2.0)
    L = np.random.default_rng(1).standard_normal((len(DOFS.node), 3))
    return replace(block, D=csr_array(0.1 * L @ L.T))


SUPPORTS = {
    "clamped": [Held(held(LEFT, "xyz"), "left", ("reaction.x", "reaction.y", "reaction.z"))],
    "two": [
        Held(held(LEFT, "xyz"), "left", ("reaction.x", "reaction.z")),
        Held(held(RIGHT, "yz"), "right", ("reaction.y", "reaction.z")),
    ],
    "unnamed": [Held(held(LEFT, "xz")), Held(held(RIGHT, "yz"), "right", ("reaction.y", "reaction.z"))],
    "slides along x, y": [Held(held(LEFT, "z"), "left", ("reaction.z",))],
    "slides and turns": [Held(held(LEFT & (Z == 0), "z"), "left", ("reaction.z",))],
}


def fixed_of(supports: list[Held]) -> Ints:
    return np.unique(np.concatenate([support.dofs for support in supports]))


def tip_row(axis: int) -> csr_array:
    return motion(port_nodes(MESH, np.flatnonzero(RIGHT), "area", "tip"), axis, DOFS)


def interface(supports: list[Held]) -> tuple[System, Interface]:
    """Forces at a port that has held nodes of its own, gravity and base; a dashpot at it."""
    system, fixed = softened(), fixed_of(supports)
    tip = (Port("tip", ("force.x", "force.z"), ()), port_nodes(MESH, np.flatnonzero(RIGHT), "area", "tip"))
    exchange = Exchange([tip], supports=supports, gravity=("z",), base=("x",))
    with static_solver(system, fixed) as solve:
        dashpots = [(tip_row(2), 0.7)]
        return system, build_interface(exchange, MESH, DOFS, system, fixed, solve=solve, dashpots=dashpots)


@pytest.mark.parametrize("name", SUPPORTS)
def test_a_reaction_is_the_residual_at_the_held_dofs(name: str) -> None:
    """In any state u, u̇ under any inputs, with all of the damping; ü from the free DOFs."""
    supports = SUPPORTS[name]
    system, shared = interface(supports)
    fixed = fixed_of(supports)
    n = len(DOFS.node)
    free = np.setdiff1d(np.arange(n), fixed)
    M, K = system.M.toarray(), system.K.toarray()
    w = tip_row(2).toarray()
    physical = system.D.toarray() + 0.7 * w.T @ w
    D = physical + ALPHA * M + BETA * K
    rng = np.random.default_rng(0)
    for _ in range(3):
        u, du, ddu = np.zeros((3, n))
        u[free], du[free] = rng.standard_normal((2, len(free)))
        inputs = rng.standard_normal(shared.b.shape[1])
        F = shared.b @ inputs
        ff = np.ix_(free, free)
        ddu[free] = np.linalg.solve(M[ff], (F - D @ du - K @ u)[free])
        residual = M @ ddu + D @ du + K @ u - F
        np.testing.assert_allclose(residual[free], 0, atol=1e-12)
        wanted = [
            residual[support.dofs[support.dofs % 3 == "xyz".index(key[-1])]].sum()
            for support in supports
            for key in support.outputs
        ]
        rows, direct = shared.c.toarray().reshape(-1, 3, n), shared.direct.reshape(len(wanted), 3, -1)
        found = rows[:, 0] @ ddu + (rows[:, 1] + ALPHA * rows[:, 0]) @ du + direct[:, 0] @ inputs
        np.testing.assert_allclose(found, wanted, rtol=1e-10, atol=1e-11)
        assert not direct[:, 1:].any()
        np.testing.assert_allclose(rows[:, 2] @ u, 0, atol=1e-12)  # nothing moves the supports
        # without D or the nodes' own forces it would be another force
        assert np.abs(rows[:, 1] @ du).max() > 1e-3
        assert np.abs(direct[:, 0] @ inputs).max() > 1e-3


def test_a_reaction_is_the_residual_beside_a_rigid_port_too() -> None:
    """u = T û: the forces inside the rigid port act on its own nodes alone, so that those held tell all."""
    supports = SUPPORTS["two"]
    system, fixed = softened(), fixed_of(supports)
    flange = port_nodes(MESH, np.flatnonzero(X == 2), "equal", "flange")
    c = constrain(system, fixed, DOFS, [flange])
    exchange = Exchange([(Port("flange", ("moment.y",), ()), flange)], supports=supports, gravity=("z",))
    with static_solver(c.system, c.fixed) as solve:
        shared = build_interface(exchange, MESH, DOFS, system, fixed, solve=lambda b: c.T @ solve(c.T.T @ b))
    free = np.setdiff1d(np.arange(c.T.shape[1]), c.fixed)
    T = c.T.toarray()[:, free]
    rng = np.random.default_rng(0)
    u, du = rng.standard_normal((2, T.shape[1])) @ T.T
    inputs = rng.standard_normal(2)
    F = shared.b @ inputs
    assert system.D is not None
    ddu = T @ np.linalg.solve(T.T @ (system.M @ T), T.T @ (F - system.D @ du - system.K @ u))
    residual = system.M @ ddu + system.D @ du + system.K @ u - F
    left, right = (residual.reshape(-1, 3)[end].sum(axis=0) for end in (LEFT, RIGHT))
    wanted = [left[0], left[2], right[1], right[2]]
    rows, direct = shared.c.toarray().reshape(4, 3, -1), shared.direct.reshape(4, 3, -1)
    np.testing.assert_allclose(rows[:, 0] @ ddu + rows[:, 1] @ du + direct[:, 0] @ inputs, wanted, rtol=1e-10)
    # the ψ of the part without its rigid port gives other forces
    _, soft = interface(supports)
    assert np.abs(soft.c[::3] @ ddu - rows[:, 0] @ ddu).max() > 1e-3


def test_reactions_at_rest_carry_the_weight_and_the_force() -> None:
    """Exactly, with no mode at all: u̇ = ü = 0 leaves the direct part. 6 m³ of 2 kg/m³ under −9.81 m/s²."""
    _, shared = interface(SUPPORTS["two"])
    inputs = np.array([5.0, 3.0, -9.81, 0.0])  # force.x, force.z, gravity.z, base.acceleration.x
    reaction = dict(zip(("left x", "left z", "right y", "right z"), shared.direct[::3] @ inputs, strict=True))
    assert reaction["left x"] == pytest.approx(-5.0, rel=1e-12)
    assert reaction["left z"] + reaction["right z"] == pytest.approx(12 * 9.81 - 3.0, rel=1e-12)
    assert abs(reaction["left z"]) > 1
    assert abs(reaction["right z"]) > 1


def test_a_dof_held_twice_counts_once(caplog: pytest.LogCaptureFixture) -> None:
    both = [
        Held(held(LEFT, "z"), "left", ("reaction.z",)),
        Held(held(LEFT | RIGHT, "z"), "right", ("reaction.z",)),
        Held(held(LEFT | RIGHT, "xy")),
    ]
    with caplog.at_level(logging.INFO, LOGGER_NAME):
        own = own_dofs(both)
    assert caplog.messages == [
        "support right: a support before it in the file holds some of its nodes too; "
        "their reaction counts there"
    ]
    np.testing.assert_array_equal(own[1].dofs, held(RIGHT, "z"))
    _, shared = interface(both)
    assert (shared.direct[::3] @ [0, 0, 1.0, 0]).sum() == pytest.approx(-12.0, rel=1e-12)


def test_what_is_not_held_has_no_reaction() -> None:
    slide = [Held(held(LEFT, "xyz")), Held(held(RIGHT, "y"), "slide", ("reaction.z",))]
    with pytest.raises(
        PartError, match=r'support slide: got the output reaction\.z, but .* add "z" to its fix'
    ):
        interface(slide)


def test_reactions_need_a_solver() -> None:
    exchange = Exchange([], supports=SUPPORTS["clamped"])
    with pytest.raises(ModalFmuError, match="expected solve"):
        build_interface(exchange, MESH, DOFS, softened(), held(LEFT, "xyz"))
