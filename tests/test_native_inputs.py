"""Derivatives of inputs are used exactly in the step, hold for it alone, and lead the inputs to its end."""

from itertools import product

import numpy as np
import pytest
from examples import two_ports
from native_fmu import DISCARD, ERROR, OK, native_fmu
from polynomials import FORCES, START, U, close, exact_outputs, give, outputs, polynomial, started

EPS = np.finfo(float).eps


@pytest.mark.parametrize("rates", [0, 1, 2])
@pytest.mark.parametrize("h", [1e-3, 0.02, 0.5])
def test_the_step_is_exact(rates: int, h: float) -> None:
    """Held, ramp and parabola against expm, whose own rounding is ε‖A‖h, 9000 · 0.5 at the largest."""
    part = started()
    give(part, U[: rates + 1])
    assert part.step(0.0, h) == OK
    assert close(outputs(part), exact_outputs(U[: rates + 1], h)[0], 1e-11)
    if rates > 0:  # the control: without the last derivative it would be elsewhere
        assert not close(outputs(part), exact_outputs(U[:rates], h)[0], 1e-9)


def test_orders_may_be_given_alone_and_in_any_order() -> None:
    """ü without u̇, one input at a time, the second before the first."""
    for rows, given in (
        (np.array([U[0], 0 * U[0], U[2]]), [(2, j) for j in FORCES]),
        (U, [(order, j) for order, j in product((2, 1), reversed(FORCES))]),
    ):
        part = started()
        part.set_real(FORCES, U[0])
        for order, j in given:
            assert part.set_rates([j], [order], [U[order, j]]) == OK
        assert part.step(0.0, 0.1) == OK
        assert close(outputs(part), exact_outputs(rows, 0.1)[0], 1e-12)


def test_held_pieces_converge_to_the_step() -> None:
    """The same parabola in n pieces, each held at its middle: second order in 1/n."""
    exact = started()
    give(exact, U)
    assert exact.step(0.0, 0.1) == OK
    errors = []
    for n in (50, 100, 200, 400):
        part, h = started(), 0.1 / n
        for k in range(n):
            part.set_real(FORCES, polynomial(U, (k + 0.5) * h)[0])
            assert part.step(k * h, h) == OK
        part.set_real(FORCES, polynomial(U, 0.1)[0])  # accelerations belong to the end
        errors.append(np.abs(outputs(part) - outputs(exact)).max())
    assert np.log2(np.array(errors[:-1]) / errors[1:]) == pytest.approx(2.0, abs=0.05)


@pytest.mark.parametrize("rates", [1, 2])
def test_one_step_is_two_halves(rates: int) -> None:
    """Under the same polynomial, the derivatives given anew at the half."""
    rows, h = U[: rates + 1], 0.2
    whole, halves = started(), started()
    give(whole, rows)
    assert whole.step(0.0, h) == OK
    for k in (0, 1):
        give(halves, polynomial(rows, k * h / 2)[: rates + 1])
        assert halves.step(k * h / 2, h / 2) == OK
    bound = 60 * EPS * (1 + np.sqrt(9000) * h)  # a few roundings, each up to ωh times as a phase
    assert close(outputs(halves), outputs(whole), bound)
    assert close(halves.get_real(FORCES), whole.get_real(FORCES), 4 * EPS)


@pytest.mark.parametrize("rates", [1, 2])
def test_inputs_are_extrapolated_to_the_end_and_then_held(rates: int) -> None:
    """The step clears the derivatives: the next one holds u where the first has led it."""
    rows, h = U[: rates + 1], 0.05
    part, held = started(), started()
    give(part, rows)
    assert part.step(0.0, h) == OK
    there = polynomial(rows, h)[0]
    assert close(part.get_real(FORCES), there, 4 * EPS)
    give(held, rows)
    assert held.step(0.0, h) == OK
    assert held.set_rates(FORCES, [1] * 3, [0.0] * 3) == OK  # clears them explicitly
    held.set_real(FORCES, there)
    assert (part.step(h, h), held.step(h, h)) == (OK, OK)
    assert close(outputs(part), outputs(held), 16 * EPS)
    assert close(part.get_real(FORCES), there, 4 * EPS)
    carried = started()
    give(carried, rows)
    assert carried.step(0.0, 2 * h) == OK
    assert not close(outputs(carried), outputs(part), 1e-3)  # what carrying them on would give


def test_derivatives_may_come_before_or_after_the_input() -> None:
    results = []
    for first in ("value", "rate"):
        part = started()
        for what in ("value", "rate") if first == "value" else ("rate", "value"):
            if what == "value":
                assert part.set_real(FORCES, U[0]) == OK
            else:
                assert part.set_rates(FORCES * 2, [1] * 3 + [2] * 3, np.ravel(U[1:])) == OK
        assert part.step(0.0, 0.1) == OK
        results.append(part.reals())
    np.testing.assert_array_equal(*results)


def test_derivatives_given_before_the_first_step() -> None:
    """Also while initialising; and the last value given counts."""
    part = native_fmu(two_ports).instance()
    part.must("SetupExperiment", 0, 0.0, 0.0, 0, 0.0)
    part.must("EnterInitializationMode")
    assert part.set(START) == OK
    give(part, np.array([U[0], 9 * U[1], 9 * U[2]]))
    give(part, U)
    part.must("ExitInitializationMode")
    assert part.step(0.0, 0.1) == OK
    assert close(outputs(part), exact_outputs(U, 0.1)[0], 1e-12)


@pytest.mark.parametrize(
    ("spoil", "time", "h", "status"),
    [(0.0, 0.0, -1.0, ERROR), (0.0, 5.0, 0.1, ERROR), (np.nan, 0.0, 0.1, ERROR), (0.0, 0.0, 1e200, DISCARD)],
    ids=["negative step", "elsewhere", "not a number", "beyond the numbers"],
)
def test_a_refused_step_keeps_them(spoil: float, time: float, h: float, status: int) -> None:
    part = started()
    give(part, U)
    part.set_real([0], [U[0, 0] + spoil])
    before = part.reals()
    assert part.step(time, h) == status
    np.testing.assert_array_equal(part.reals(), before)
    part.set_real([0], [U[0, 0]])
    assert part.step(0.0, 0.1) == OK
    assert close(outputs(part), exact_outputs(U, 0.1)[0], 1e-12)


def test_refused_derivatives_change_nothing() -> None:
    """Order 0 or 3, an output, no number: none of the call's values is taken."""
    for references, orders, values in (
        ([0, 1], [1, 0], [5.0, 5.0]),
        ([0, 1], [1, 3], [5.0, 5.0]),
        ([0, 3], [1, 1], [5.0, 5.0]),
        ([0, 1], [1, 2], [5.0, np.inf]),
    ):
        part = started()
        before = part.save()
        assert part.set_rates(references, orders, values) == ERROR
        assert part.save() == before
