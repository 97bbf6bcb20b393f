"""Ports whose acceleration is prescribed, in the Python twin: against the full part, and closed forms."""

import math
from dataclasses import replace

import numpy as np
import pytest
from driven import Full, driven, part, reduced
from scipy.linalg import expm

from fmu_src.runtime.instance import Instance
from fmu_src.runtime.model import Floats, Port, ReducedModel

PARTS = {
    "three ports": {},
    "one, nothing that drags": {"k": 1, "dashpots": False, "alpha": 0.0},
    "two, α drags": {"k": 2, "dashpots": False},
    "two, a rigid mode": {"k": 2, "rigid": True},
    "three, most modes over-damped": {"beta": 0.2, "dashpots": False},
    "three, undamped": {"alpha": 0.0, "beta": 0.0, "dashpots": False},
}
# ε‖A‖h of both exponentials, ‖A‖ ≈ λ ≈ 700 before scaling; conditioning of M, K and W costs two digits more
CLOSE = 1e-10


def started(model: ReducedModel, s: Floats, s_dot: Floats) -> Instance:
    instance = Instance(model)
    instance.set_start(dict(enumerate([*s, *s_dot], start=instance.layout.start.start)))
    instance.initialising = False
    return instance


def outputs(instance: Instance) -> dict[str, float]:
    y = instance.reals()[instance.layout.outputs]
    return dict(zip(instance.model.outputs, y.tolist(), strict=True))


def advance(instance: Instance, t: float, h: float, u: Floats) -> None:
    instance.set_inputs(np.arange(len(u)), u)
    assert instance.advance(t, h) is None


@pytest.mark.parametrize("name", PARTS)
def test_every_output_is_that_of_the_full_part(name: str) -> None:
    """Displacements, reactions of ports and support, energies, from a start in motion."""
    of, rng = part(**PARTS[name]), np.random.default_rng(3)
    s, s_dot = rng.standard_normal((2, of.k))
    full, twin, t = Full(of, s, s_dot), started(reduced(of), s, s_dot), 0.0
    for h in (0.01, 0.3, 0.002, 0.05, 0.3, 1.0):
        u = rng.standard_normal(of.b.shape[1])
        full.move(h, u[None])
        advance(twin, t, h, u)
        t += h
        y = outputs(twin)
        for output, (expected, _, _) in full.outputs().items():
            assert y[output] == pytest.approx(expected, rel=CLOSE, abs=CLOSE), (output, t)


@pytest.mark.parametrize(
    "wrong", ["B", "D_rest", "C", "R", "M_s", "K_s"], ids=lambda key: f"{key} a little different"
)
def test_a_wrong_model_is_noticed(wrong: str) -> None:
    """The control: each array, a millionth larger where a prescribed motion has a part in it."""
    of, rng = part(), np.random.default_rng(3)
    array = getattr(reduced(of), wrong).copy()
    k = of.k
    places = {"B": np.s_[k:, of.motions], "D_rest": np.s_[k:, :k], "C": np.s_[:, :k], "R": np.s_[:, :]}
    array[places.get(wrong, np.s_[:, :])] *= 1 + 1e-6
    if wrong == "D_rest":
        array[:k, k:] = array[k:, :k].T
    full, twin = (
        Full(of, np.zeros(k), np.ones(k)),
        started(reduced(of, **{wrong: array}), np.zeros(k), np.ones(k)),
    )
    u = rng.standard_normal(of.b.shape[1])
    full.move(0.3, u[None])
    advance(twin, 0.0, 0.3, u)
    y = outputs(twin)
    apart = max(abs(y[name] / value[0] - 1) for name, value in full.outputs().items())
    assert apart > 100 * CLOSE


def mass_on_a_spring(stiffness: float, mass: float, dashpot: float, alpha: float) -> ReducedModel:
    """A base that is moved, a spring and a dashpot on it, a mass that is held by nothing else.

    u = (x, s): Ψ = (1, 1), φ = (1/√m, 0); the force that drives the base is m ẍ + α m ẋ.
    """
    m, root = mass, math.sqrt(mass)
    given = ("displacement.x", "velocity.x", "acceleration.x")
    return ReducedModel(
        name="shaken",
        description="a mass on a spring on a base",
        lam=np.array([0.0, stiffness / m]),
        alpha=alpha,
        beta=0.0,
        D_rest=np.array([[0.0, 0.0], [0.0, dashpot / m]]),
        B=np.array([[1.0], [-root]]),
        C=np.array([*[[1.0, 1 / root]] * 3, [m, root], [0.0, 0.0], [0.0, 0.0]]),
        R=np.zeros((6, 1)),
        R_in=np.zeros((1, 1)),
        ports=(Port("mass", (), given), Port("shaker", ("motion.x",), ("reaction.x",))),
        M_s=np.array([[m]]),
        K_s=np.zeros((1, 1)),
    )


def test_a_base_that_begins_to_accelerate() -> None:
    """x = s − (a/ω²)(1 − cos ωt) above the base, and the base feels the spring: r = m a (1 − cos ωt)."""
    k, m, a = 400.0, 2.0, 3.0
    omega = math.sqrt(k / m)
    twin, t = started(mass_on_a_spring(k, m, 0.0, 0.0), np.zeros(1), np.zeros(1)), 0.0
    for h in (0.01, 0.4, 0.05, 2.0):
        advance(twin, t, h, np.array([a]))
        t += h
        y, turned = outputs(twin), 1 - math.cos(omega * t)
        assert y["mass.displacement.x"] == pytest.approx(a * t**2 / 2 - a / omega**2 * turned, rel=1e-13)
        assert y["shaker.reaction.x"] == pytest.approx(m * a * turned, abs=1e-13 * m * a * omega * t)


def test_a_base_that_moves_on_through_a_drag() -> None:
    """At constant velocity V with αm to the ground the mass hangs back, k (s − x) = α m V, and pulls."""
    k, m, alpha, V = 400.0, 2.0, 30.0, 0.7
    twin = started(mass_on_a_spring(k, m, 5.0, alpha), np.zeros(1), np.array([V]))
    advance(twin, 0.0, 5.0, np.zeros(1))  # 15 decay times of (α + c/m)/2
    y = outputs(twin)
    assert y["mass.velocity.x"] == pytest.approx(V, rel=1e-12)
    assert 5.0 * V - y["mass.displacement.x"] == pytest.approx(alpha * m * V / k, rel=1e-12)
    assert y["shaker.reaction.x"] == pytest.approx(alpha * m * V, rel=1e-12)


def test_a_static_start_in_motion() -> None:
    """q = (B u + N ṡ)/λ: under the inputs and velocities of the start no mode accelerates."""
    of, rng = part(), np.random.default_rng(5)
    model = reduced(of, initial="static")
    u, start = rng.standard_normal(len(model.inputs)), rng.standard_normal(6)
    twin = Instance(model)
    place = twin.layout
    twin.set_inputs(np.arange(len(u)), u)
    twin.set_start(dict(enumerate(start, start=place.start.start)))
    for alpha in (of.alpha, 5.0):
        twin.set_damping(alpha, 0.1)
        reals = twin.reals()
        scale = np.abs(model.lam * reals[place.q]).max()
        assert np.abs(reals[place.v_dot][3:]).max() < 1e-14 * scale
        np.testing.assert_array_equal(reals[place.v_dot][:3], u[model.motions])
        np.testing.assert_array_equal(np.concatenate([reals[place.q][:3], reals[place.v][:3]]), start)
        np.testing.assert_array_equal(reals[place.start], start)


@pytest.mark.parametrize("active", [0, 2])
def test_modes_that_are_off_leave_the_motion(active: int) -> None:
    """As the model that has these modes only; with none the part follows its ports as Ψ s."""
    of, rng = part(), np.random.default_rng(6)
    model, n = reduced(of), 3 + max(active, 1)
    few = reduced(
        of, lam=model.lam[:n], B=model.B[:n], C=model.C[:, :n].copy(), D_rest=model.D_rest[:n, :n].copy()
    )
    s, s_dot = rng.standard_normal((2, 3))
    twins = [started(one, s, s_dot) for one in (model, few)]
    for twin in twins:
        twin.set_active(active)
    for step in range(4):
        u = rng.standard_normal(len(model.inputs))
        for twin in twins:
            advance(twin, 0.1 * step, 0.1, u)
    whole, part_of = map(outputs, twins)
    for name, value in part_of.items():
        assert whole[name] == pytest.approx(value, rel=1e-12, abs=1e-14), name
    if active == 0:
        assert not twins[0].state.q[3:].any()
        assert whole["left.displacement.y"] == pytest.approx(twins[0].state.q[0], rel=1e-15)


def test_modes_that_are_off_follow_what_is_prescribed() -> None:
    """With the residual and nothing that drags, equilibrium in an acceleration does not need the modes."""
    of, rng = part(dashpots=False, alpha=0.0), np.random.default_rng(6)
    model = reduced(of, initial="static", residual=True)
    twin, u = Instance(model), rng.standard_normal(len(model.inputs))
    twin.set_inputs(np.arange(len(u)), u)
    twin.set_start(dict(enumerate(rng.standard_normal(6), start=twin.layout.start.start)))
    whole = outputs(twin)
    twin.set_active(1)
    for name in ("gap.displacement.z", "left.displacement.y", "left.stress.mises", "energy.strain"):
        assert outputs(twin)[name] == pytest.approx(whole[name], rel=1e-12), name
    truncated = Instance(reduced(of, initial="static"))
    truncated.set_inputs(np.arange(len(u)), u)
    truncated.set_active(1)
    assert abs(outputs(truncated)["gap.displacement.z"] / whole["gap.displacement.z"] - 1) > 1e-3


def test_damping_that_is_tuned_while_the_ports_move() -> None:
    """N follows α from step to step: as the full part with other damping from the same motion."""
    of, rng = part(), np.random.default_rng(7)
    s, s_dot = rng.standard_normal((2, 3))
    twin = started(reduced(of), s, s_dot)
    full, t = Full(of, s, s_dot), 0.0
    for alpha, beta in ((0.4, 2e-3), (9.0, 0.0), (0.0, 0.05)):
        x, full = full.x, Full(replace(of, alpha=alpha, beta=beta), s, s_dot)
        full.x = x
        twin.set_damping(alpha, beta)
        u = rng.standard_normal(len(twin.model.inputs))
        full.move(0.2, u[None])
        advance(twin, t, 0.2, u)
        t += 0.2
        y = outputs(twin)
        for name, (expected, _, _) in full.outputs().items():
            assert y[name] == pytest.approx(expected, rel=CLOSE, abs=CLOSE), name


def test_a_saved_state_goes_on_to_the_bit() -> None:
    """Starts that are remembered among it; and a state of no other lengths."""
    rng = np.random.default_rng(8)
    s, s_dot, later = rng.standard_normal((3, 3))
    twin = started(driven(), s, s_dot)
    u = rng.standard_normal((3, len(twin.model.inputs)))
    advance(twin, 0.0, 0.1, u[0])
    saved = twin.save()
    advance(twin, 0.1, 0.1, u[1])
    after = twin.reals().copy()
    other = started(driven(), later, later)
    other.restore(saved)
    advance(other, 0.1, 0.1, u[1])
    np.testing.assert_array_equal(other.reals(), after)
    with pytest.raises(ValueError, match="lengths"):
        other.restore({**saved, "start": saved["start"][:-1]})


def exact(model: ReducedModel, x: Floats, x_dot: Floats, u: Floats, h: float) -> tuple[Floats, Floats]:
    """[x, ẋ, u, u̇, ü] after h by the exponential of the augmented matrix, N ṡ in it as damping."""
    n, m, k = len(model.lam), len(model.inputs), model.k
    D = np.diag(model.damping(model.alpha, model.beta))
    D[k:, k:] += model.D_rest[k:, k:] - np.diag(np.diag(model.D_rest[k:, k:]))
    D[:, :k] -= model.drag(model.alpha)
    A = np.zeros((2 * n + 3 * m, 2 * n + 3 * m))
    A[:n, n : 2 * n], A[2 * n : 2 * n + 2 * m, 2 * n + m :] = np.eye(n), np.eye(2 * m)
    A[n : 2 * n, : 2 * n + m] = np.hstack([-np.diag(model.lam), -D, model.B])
    end = expm(A * h) @ np.concatenate([x, x_dot, u.ravel()])
    return end[:n], end[n : 2 * n]


def test_the_reduced_equations_alone() -> None:
    """Arrays that are no part's: modes that N drags and nothing couples; a D between s that moves nothing."""
    rng = np.random.default_rng(9)
    of = part(dashpots=False)
    model = reduced(of)
    D_rest = np.diag(rng.uniform(0, 3, len(model.lam)))
    D_rest[3:, :3] = rng.standard_normal((model.r, 3))
    D_rest[:3, 3:] = D_rest[3:, :3].T
    model = reduced(of, D_rest=D_rest)
    s, s_dot = rng.standard_normal((2, 3))
    twin, t = started(model, s, s_dot), 0.0
    x, x_dot = twin.state.q, twin.state.v
    for h in (0.01, 0.3, 2.0):
        u = rng.standard_normal(len(model.inputs))
        x, x_dot = exact(model, x, x_dot, np.array([u, 0 * u, 0 * u]), h)
        advance(twin, t, h, u)
        t += h
        assert np.abs(twin.state.q - x).max() < 1e-12 * np.abs(x).max()
        assert np.abs(twin.state.v - x_dot).max() < 1e-12 * np.abs(x_dot).max()
