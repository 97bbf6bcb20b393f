"""The monolithic solution against closed forms, against another integrator, and against itself."""

from dataclasses import replace

import numpy as np
import pytest
from body import Body, full_body, joined, modal, point_mass, reduced_body, tied, together
from monolith import (
    Monolith,
    after,
    beside,
    crossing,
    driven,
    fed_back,
    monolith,
    output,
    polynomial,
    rate,
    sine,
    trajectory,
)
from ready_parts import MODELS, reduction
from scipy.integrate import solve_ivp

from precompute.arrays import Floats
from precompute.part import read_part

CLOSED = 1e-13  # of the peak: ε‖A‖t with ‖A‖t below 100


def two_masses(m1: float, m2: float, k: float, c: float = 0.0) -> Monolith:
    """Two free masses with a spring and a damper between them."""
    bodies = {"left": point_mass(m1, "port.x"), "right": point_mass(m2, "port.x")}
    return monolith(joined(together(bodies), "left.port.x", "right.port.x", k, c))


def test_two_masses_and_a_spring_in_closed_form() -> None:
    """Their distance is an oscillator of the reduced mass m₁m₂/(m₁+m₂), their centre moves on its own."""
    m1, m2, k, c, force = 2.0, 3.0, 700.0, 4.0, 5.0
    mu = m1 * m2 / (m1 + m2)
    d, omega = c / (2 * mu), np.sqrt(k / mu - (c / (2 * mu)) ** 2)
    system = driven(two_masses(m1, m2, k, c), {"right.port.force.x": polynomial(force)})
    x = trajectory(system, 0.01, 300)
    t = 0.01 * np.arange(301)
    u1, u2 = (output(system, x, f"{side}.port.displacement.x") for side in ("left", "right"))
    static = force / m2 * mu / k
    distance = static * (1 - np.exp(-d * t) * (np.cos(omega * t) + d / omega * np.sin(omega * t)))
    np.testing.assert_allclose(u2 - u1, distance, atol=CLOSED * distance.max())
    centre = force * t**2 / (2 * (m1 + m2))
    np.testing.assert_allclose((m1 * u1 + m2 * u2) / (m1 + m2), centre, atol=CLOSED * centre.max())


def test_signals_in_closed_form() -> None:
    """A free mass under r₀ + r₁t + r₂t²/2, and under a sin(ωt + φ)."""
    mass, t = monolith(point_mass(2.0, "port.x")), 1.7
    polynomially = driven(mass, {"port.force.x": polynomial(1.0, -3.0, 0.7)})
    moved = output(polynomially, after(polynomially, t), "port.displacement.x")
    assert moved == pytest.approx((t**2 / 2 - 3 * t**3 / 6 + 0.7 * t**4 / 24) / 2, rel=1e-13)
    a, w, phase = 3.0, 5.0, 0.4
    swung = driven(mass, {"port.force.x": sine(a, w, phase)})
    speed = a / (2 * w) * (np.cos(phase) - np.cos(w * t + phase))
    assert output(swung, after(swung, t), "port.velocity.x") == pytest.approx(speed, rel=1e-13)


def test_tied_masses_are_one() -> None:
    bodies = {"left": point_mass(2.0, "port.x"), "right": point_mass(3.0, "port.x")}
    body = tied(together(bodies), [("left.port.x", "right.port.x")])
    one = monolith(joined(body, "left.port.x", None, 45.0, 0.0))
    assert len(one.A) == 2
    np.testing.assert_allclose(np.linalg.eigvals(one.A).imag, [3.0, -3.0], rtol=1e-14)
    system = driven(one, {"right.port.force.x": polynomial(90.0)})
    assert output(system, after(system, np.pi / 3), "left.port.displacement.x") == pytest.approx(
        4.0, rel=1e-14
    )


def test_equals_another_integrator_on_two_parts() -> None:
    """Two cantilevers whose tips a spring and a damper join; DOP853 at 1e-12 on the equations themselves."""
    body = reduced_body(reduction("cantilever").model)
    both = joined(together({"a": body, "b": body}), "a.tip.z", "b.tip.z", 3e4, 20.0)
    omega = 2 * np.pi * 40
    system = driven(monolith(both), {"a.tip.force.z": sine(10.0, omega)})
    n, w, k = len(body.M), body.ports["tip.z"], (3e4, 20.0)

    def equations(t: float, x: Floats) -> Floats:
        q, v = x[: 2 * n].reshape(2, n), x[2 * n :].reshape(2, n)
        force = k[0] * w @ (q[1] - q[0]) + k[1] * w @ (v[1] - v[0])
        f = np.array([force + 10.0 * np.sin(omega * t), -force])
        return np.concatenate([v.ravel(), (np.outer(f, w) - v @ body.D - q @ body.K).ravel()])

    t = np.linspace(0.0, 0.05, 51)
    found = solve_ivp(equations, (0.0, 0.05), np.zeros(4 * n), "DOP853", t, rtol=1e-12, atol=1e-16)
    x = trajectory(system, 1e-3, 50)
    for k_body, name in enumerate("ab"):
        expected = w @ found.y[k_body * n : (k_body + 1) * n]
        mine = output(system, x, f"{name}.tip.displacement.z")
        np.testing.assert_allclose(mine, expected, atol=1e-10 * np.abs(expected).max())


def test_a_rate_is_the_derivative() -> None:
    """Acceleration of a driven, coupled mass: (F − k(u₁ − u₂))/m₁."""
    system = driven(two_masses(2.0, 3.0, 700.0), {"left.port.force.x": polynomial(5.0, 1.0)})
    t = 0.3
    x = after(system, t)
    u1, u2 = (output(system, x, f"{side}.port.displacement.x") for side in ("left", "right"))
    expected = (5.0 + t - 700.0 * (u1 - u2)) / 2.0
    assert rate(system, "left.port.velocity.x") @ x == pytest.approx(expected, rel=1e-12)


def test_feedback_between_two_systems() -> None:
    """A mass pushed by −k times its own displacement, the other by none: cos ωt and rest."""
    one, other = monolith(point_mass(2.0, "a.x")), monolith(point_mass(1.0, "b.x"))
    system = beside(one, other)
    system = fed_back(system, "a.force.x", -18.0 * system.outputs["a.displacement.x"])
    start = system.outputs["a.displacement.x"] + 0.5 * system.outputs["b.velocity.x"]
    x = after(system, 0.7, start)
    assert output(system, x, "a.displacement.x") == pytest.approx(np.cos(2.1), rel=1e-13)
    assert output(system, x, "b.displacement.x") == pytest.approx(0.35, rel=1e-13)


def test_crossings_in_closed_form() -> None:
    """u = sin ωt − 1/2 comes to 0 from below at ωt = π/6, then at 2π + π/6; from above it is no crossing."""
    system = monolith(joined(point_mass(1.0, "a.x"), "a.x", None, 100.0, 0.0))
    system = beside(system, Monolith(np.zeros((1, 1)), np.ones(1), {}, {"one": np.ones(1)}))
    row = system.outputs["a.displacement.x"] - 0.5 * system.outputs["one"]
    start = 10.0 * system.outputs["a.velocity.x"] + system.outputs["one"]
    first, x = crossing(system, start, row, 0.01, 1.0)
    assert first == pytest.approx(np.pi / 60, abs=1e-14)
    assert row @ x == pytest.approx(0.0, abs=1e-13)
    second, _ = crossing(system, x, row, 0.01, 1.0)
    assert second == pytest.approx(np.pi / 5, abs=1e-14)
    assert crossing(system, x, row, 0.01, 0.6)[0] == np.inf


def response(body: Body, omega: float) -> Floats:
    """H = wᵀ(K + iωD − ω²M)⁻¹w between all ports."""
    W = np.column_stack([*body.ports.values()])
    return np.asarray(W.T @ np.linalg.solve(body.K + 1j * omega * body.D - omega**2 * body.M, W))


@pytest.mark.parametrize("name", ["stop", "servo", "chain"])
def test_full_and_reduced_bodies_answer_alike(name: str) -> None:
    """At a tenth of the first elastic frequency ω₁, where n Krylov vectors at 0 err by (ω/ω₁)²ⁿ, n ≥ 3."""
    full, reduced = full_body(read_part(MODELS / name)), reduced_body(reduction(name).model)
    assert full.ports.keys() == reduced.ports.keys()
    omega = np.sqrt(min(k for k in np.diag(reduced.K) if k > 0)) / 10
    expected, found = response(full, omega), response(reduced, omega)
    assert np.abs(found - expected).max() < 1e-6 * np.abs(expected).max()
    without = response(replace(reduced, K=1.01 * reduced.K), omega)
    assert np.abs(without - expected).max() > 1e-4 * np.abs(expected).max()


def test_a_body_in_its_own_modes_is_the_same() -> None:
    both = together({"a": reduced_body(reduction("stop").model), "b": reduced_body(reduction("stop").model)})
    both = joined(both, "a.tip.z", "b.tip.z", 5e3, 0.4)
    own, few = modal(both), modal(both, 5)
    np.testing.assert_allclose(response(own, 1000.0), response(both, 1000.0), rtol=1e-10)
    np.testing.assert_allclose(np.diag(few.K), np.diag(own.K)[:5], rtol=1e-12)


def test_only_what_has_a_matrix_is_a_full_body() -> None:
    with pytest.raises(ValueError, match="alpha and beta"):
        full_body(read_part(MODELS / "cantilever"))  # ratio = 0.02
