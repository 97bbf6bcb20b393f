"""Derivatives of outputs at the end of a step: closed forms, the exponential, differences."""

from collections.abc import Callable

import mpmath as mp
import numpy as np
import pytest
from examples import oscillator, two_ports
from native_fmu import ERROR, OK, Instance, native_fmu
from polynomials import FORCES, U, close, exact_outputs, give, outputs, started


@pytest.mark.parametrize("rates", [0, 1, 2])
def test_output_derivatives_are_exact(rates: int) -> None:
    """ẏ and ÿ of displacements, velocities and accelerations, with q⁽ⁿ⁺²⁾ = f⁽ⁿ⁾ − d q⁽ⁿ⁺¹⁾ − λ q⁽ⁿ⁾."""
    part, rows = started(), U[: rates + 1]
    for h in (0.0, 0.1):
        if h:
            give(part, rows)
            assert part.step(0.0, h) == OK
        exact = exact_outputs(rows if h else np.zeros((1, 3)), h)
        references = part.fmu.outputs
        found = part.get_rates(references * 2, [1] * 5 + [2] * 5)
        # fourth powers of ω in q⃜ bring its terms to 9000²: their roundings are those of the largest output
        assert close(found[:5], exact[1], 1e-11)
        assert close(found[5:], exact[2], 1e-11)
        mixed = part.get_rates([references[k] for k in (4, 2, 4)], [2, 1, 1])
        np.testing.assert_array_equal(mixed, [found[9], found[2], found[4]])


def test_output_derivatives_against_a_closed_form() -> None:
    """One under-damped oscillator, unit force from rest: the derivatives of its textbook response."""
    K, D = 400.0, 0.4
    part = native_fmu(oscillator).instance().initialise({"tip.force.x": 1.0})
    t = 0.37
    assert part.step(0.0, t) == OK
    with mp.workdps(40):
        a = mp.mpf(D) / 2
        w = mp.sqrt(K - a * a)

        def x(s: mp.mpf) -> mp.mpf:
            return (1 - mp.exp(-a * s) * (mp.cos(w * s) + a / w * mp.sin(w * s))) / K

        derivatives = [float(mp.diff(x, mp.mpf(t), n)) for n in range(5)]
    names = ["tip.displacement.x", "tip.velocity.x", "tip.acceleration.x"]
    assert part.get(*names) == pytest.approx(derivatives[:3], rel=1e-12)
    references = [part.fmu.reference[name] for name in names]
    for order in (1, 2):
        found = part.get_rates(references, [order] * 3)
        assert found == pytest.approx(derivatives[order : order + 3], rel=1e-12)


@pytest.mark.parametrize("rates", [0, 1, 2])
def test_output_derivatives_are_limits_of_differences(rates: int) -> None:
    """(y(t+h) − y(t−h))/2h and (y(t+h) − 2y(t) + y(t−h))/h², each to second order."""
    rows, t = U[: rates + 1], 0.3

    def at(time: float) -> Instance:
        part = started()
        give(part, rows)
        assert part.step(0.0, time) == OK
        return part

    middle = at(t)
    references = middle.fmu.outputs
    exact = np.array([middle.get_rates(references, [order] * 5) for order in (1, 2)])
    errors = []
    for h in (4e-4, 2e-4, 1e-4):  # ωh = 0.04 … 0.01
        before, after, now = outputs(at(t - h)), outputs(at(t + h)), outputs(middle)
        differences = np.array([(after - before) / (2 * h), (after - 2 * now + before) / h**2])
        errors.append(np.abs(differences - exact).max(axis=1) / np.abs(exact).max(axis=1))
    found = np.log2(np.array(errors[:-1]) / errors[1:])
    assert found == pytest.approx(2.0, abs=0.1)
    assert (errors[-1] < 1e-4).all()


def test_derivatives_of_inputs_show_in_those_of_outputs_until_the_next_step() -> None:
    """d(acceleration)/dt has C B u̇: at the end of a ramp, and no more after a held step."""
    part, model = started(), two_ports()
    references = part.fmu.outputs
    give(part, U[:2])
    assert part.step(0.0, 0.1) == OK
    with_ramp = part.get_rates(references, [1] * 5)
    saved = part.save()
    assert part.set_rates(FORCES, [1] * 3, [0.0] * 3) == OK
    without = part.get_rates(references, [1] * 5)
    jump = np.where([law == "acceleration" for law in model.laws], model.C @ model.B @ U[1], 0.0)
    np.testing.assert_allclose(with_ramp - without, jump, atol=1e-12 * np.abs(with_ramp).max())
    assert np.abs(jump[[2, 3]]).min() > 1.0
    # the next step is held, by zeros or by nothing
    assert part.step(0.1, 0.1) == OK
    held = part.get_rates(references * 2, [1] * 5 + [2] * 5)
    assert part.restore(saved) == OK
    part.get_rates(references, [2] * 5)
    assert part.step(0.1, 0.1) == OK
    np.testing.assert_allclose(part.get_rates(references * 2, [1] * 5 + [2] * 5), held, rtol=1e-12)


def test_new_derivatives_count_after_outputs_were_asked_for() -> None:
    part = started()
    give(part, np.array([U[0], -3 * U[1], -3 * U[2]]))
    part.get_rates(part.fmu.outputs, [2] * 5)
    give(part, U)  # the inputs themselves stay
    assert part.step(0.0, 0.1) == OK
    assert close(outputs(part), exact_outputs(U, 0.1)[0], 1e-12)


def each_wrong_request(part: Instance) -> list[Callable[[], int]]:
    def ask(reference: int, order: int) -> Callable[[], int]:
        vr, o, value = np.array([reference], np.uint32), np.array([order], np.int32), np.zeros(1)
        return lambda: part.call("GetRealOutputDerivatives", vr, 1, o, value)

    output = part.fmu.outputs[0]
    return [ask(output, 0), ask(output, 3), ask(output, -1), ask(0, 1), ask(part.fmu.size, 1)]


def test_wrong_requests_are_refused() -> None:
    part = started()
    assert [request() for request in each_wrong_request(part)] == [ERROR] * 5
