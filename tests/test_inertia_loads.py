"""Gravity and moving supports against the model in absolute coordinates."""

import logging

import numpy as np
import pytest
from boxes import box, mapped
from scipy.linalg import expm
from solids import held, system_of

from fmu_src.runtime.model import Port
from precompute.arrays import Floats, Ints
from precompute.dofs import mesh_dofs
from precompute.exchange import Exchange
from precompute.inertia_loads import base_load, gravity_load
from precompute.interface import Interface, build_interface
from precompute.notice import LOGGER_NAME
from precompute.port_elements import with_springs
from precompute.port_motion import motion
from precompute.ports import port_nodes
from precompute.statics import static_solver
from precompute.support_reactions import Held
from precompute.system import System

# sheared, so that pushing along x pushes along z too
MESH = mapped(
    box("hex8", (2, 1, 1), (2.0, 1.0, 1.0)), lambda p: p @ np.array([[1, 0, 0.5], [0, 1, 0], [0, 0, 1]])
)
DOFS = mesh_dofs(len(MESH.points))
ROOT = held(MESH.points[:, 0] == 0, "xyz")
TIP = np.flatnonzero(MESH.points[:, 0] == 2)
BETA = 0.03


def damped() -> System:
    """A soft block whose D = β K moves with its supports."""
    block = system_of(MESH, young=3.0, poisson=0.3, density=1.0)
    return System(block.M, block.K, block.rigid, D=block.K * BETA)


def interface(system: System, fixed: Ints = ROOT) -> Interface:
    tip = Port(
        "tip", (), ("displacement.x", "acceleration.x", "absolute_acceleration.x", "absolute_acceleration.z")
    )
    exchange = Exchange(
        [(tip, port_nodes(MESH, TIP, "area", "tip"))],
        supports=[Held(fixed, "root", ("reaction.x", "reaction.z"))],
        gravity=("x", "y", "z"),
        base=("x", "z"),
    )
    with static_solver(system, fixed) as solve:
        return build_interface(exchange, MESH, DOFS, system, fixed, solve=solve)


def test_gravity_is_the_weight() -> None:
    F = gravity_load(damped(), "z").reshape(-1, 3)
    np.testing.assert_allclose(F.sum(axis=0), [0, 0, 2.0], atol=1e-14)  # 2 m³ of 1 kg/m³
    np.testing.assert_allclose(base_load(damped(), "z", ROOT, DOFS).reshape(-1, 3), -F, rtol=1e-15)


def by_expm(A: Floats, x: Floats, t: float) -> Floats:
    """x(t) of ẋ = A x."""
    return expm(A * t) @ x


@pytest.mark.parametrize("t", [0.4, 1.3, 3.1])
def test_moving_supports_as_in_absolute_coordinates(t: float) -> None:
    """The supports at r ½ a t², M_ff ẍ + D_ff ẋ + K_ff x = −(M_fs r a + D_fs r a t + K_fs r ½ a t²), against
    M ü + D u̇ + K u = −M r a with u = x − r ½ a t²; both by expm with the polynomials as states, so that
    displacement, absolute acceleration and the force that moves the supports agree to its rounding."""
    system = damped()
    shared = interface(system)
    base = inputs_of(shared).index("base.acceleration.x")
    a, r = 1.7, system.rigid[:, 0]
    free = np.setdiff1d(np.arange(len(r)), ROOT)
    k, ff, fs = len(free), np.ix_(free, free), np.ix_(free, ROOT)
    M, D, K = system.M.toarray(), system.D.toarray(), system.K.toarray()
    inverse = np.linalg.inv(M[ff])

    absolute = np.zeros((2 * k + 3, 2 * k + 3))  # states x, ẋ, a, a t, ½ a t²
    absolute[:k, k : 2 * k] = np.eye(k)
    absolute[k : 2 * k, :k], absolute[k : 2 * k, k : 2 * k] = -inverse @ K[ff], -inverse @ D[ff]
    absolute[k : 2 * k, 2 * k :] = -inverse @ np.stack([A[fs] @ r[ROOT] for A in (M, D, K)], axis=1)
    absolute[2 * k + 1, 2 * k] = absolute[2 * k + 2, 2 * k + 1] = 1.0
    state = by_expm(absolute, np.concatenate([np.zeros(2 * k), [a, 0, 0]]), t)
    x, dx, ddx = state[:k], state[k : 2 * k], (absolute @ state)[k : 2 * k]

    relative = np.zeros((2 * k + 1, 2 * k + 1))  # states u, u̇, a
    relative[: 2 * k, : 2 * k] = absolute[: 2 * k, : 2 * k]
    relative[k : 2 * k, 2 * k] = inverse @ shared.b.toarray()[free, base]
    state = by_expm(relative, np.concatenate([np.zeros(2 * k), [a]]), t)
    u, du, ddu = state[:k], state[k : 2 * k], (relative @ state)[k : 2 * k]

    np.testing.assert_allclose(u, x - r[free] * 0.5 * a * t**2, atol=1e-12)
    c, direct = shared.c.toarray()[:, free], shared.direct[:, base]
    assert c[2] @ ddu + direct[2] * a == pytest.approx(c[1] @ ddx, abs=1e-12)
    assert abs(c[1] @ ddu - c[1] @ ddx) == pytest.approx(a, abs=1e-12)  # the relative one is another

    whole = [r * at_supports for at_supports in (a, a * t, 0.5 * a * t**2)]
    for moved, at_free in zip(whole, (ddx, dx, x), strict=True):
        moved[free] = at_free
    force = (M @ whole[0] + D @ whole[1] + K @ whole[2]).reshape(-1, 3)[MESH.points[:, 0] == 0].sum(axis=0)
    for row, axis in ((4, 0), (7, 2)):
        assert c[row] @ ddu + c[row + 1] @ du + direct[row] * a == pytest.approx(force[axis], abs=1e-11)
    assert np.abs(force[[0, 2]]).min() > 1e-3


def inputs_of(shared: Interface) -> list[str]:
    return [f"{port.name}.{key}" for port in shared.ports for key in port.inputs]


def test_absolute_acceleration_takes_its_own_axis_only() -> None:
    shared = interface(damped())
    wanted = np.zeros((4, 5))
    inputs = inputs_of(shared)
    assert inputs == ["gravity.x", "gravity.y", "gravity.z", "base.acceleration.x", "base.acceleration.z"]
    wanted[2, 3] = wanted[3, 4] = 1.0
    np.testing.assert_array_equal(shared.direct[:4], wanted)


def test_a_free_direction_is_warned_of(caplog: pytest.LogCaptureFixture) -> None:
    free = damped()
    with caplog.at_level(logging.WARNING, LOGGER_NAME):
        base_load(free, "x", held(MESH.points[:, 0] == 0, "yz"), DOFS)
        assert (
            "no support holds the part in x, so base.acceleration.x moves the frame of reference"
            in caplog.text
        )
        caplog.clear()
        base_load(free, "y", held(MESH.points[:, 0] == 0, "yz"), DOFS)
        port = port_nodes(MESH, TIP, "area", "tip")
        base_load(with_springs(free, [(motion(port, 0, DOFS), 5.0)]), "x", np.zeros(0, dtype=np.int64), DOFS)
        assert not caplog.text


def test_ports_that_are_moved_go_with_the_base(caplog: pytest.LogCaptureFixture) -> None:
    """They hold the part where no support does: nothing to warn of."""
    with caplog.at_level(logging.WARNING, LOGGER_NAME):
        found = base_load(damped(), "x", np.zeros(0, dtype=np.int64), DOFS, driven=True)
    assert not caplog.text
    np.testing.assert_array_equal(found, -gravity_load(damped(), "x"))
