"""Outputs of every law and their derivatives in C, against the laws written out and differentiated."""

from collections.abc import Mapping

import numpy as np
import pytest
from examples import everything
from native_fmu import DISCARD, MODEL_EXCHANGE, OK, Instance, native_fmu
from native_outputs import measured
from scipy.linalg import expm

from fmu_src.runtime.model import Floats, ReducedModel, row_starts

START = {f"modes.{kind}[{i}]": 0.3 * i - 1.0 for kind in ("amplitude", "velocity") for i in range(1, 8)}
U = np.array(
    [
        [1.0, -2.0, 3.0, 0.5, -9.81, 2.0, 1.0],
        [30.0, 10.0, -20.0, 5.0, 1.0, -7.0, 4.0],
        [-40.0, 300.0, 20.0, 0.0, 60.0, 10.0, -5.0],
    ]
)
INPUTS = [*range(7)]
ELASTIC = (3.0, 7.0, 30.0, 30.0, 400.0, 9000.0, 2e4)


def static(**changes: object) -> ReducedModel:
    return everything("static", lam=np.array(ELASTIC), initial="static", **changes)


def give(part: Instance, rows: Floats) -> None:
    """u and as many of its derivatives as there are rows."""
    assert part.set_real(INPUTS, rows[0]) == OK
    orders = range(1, len(rows))
    assert part.set_rates(INPUTS * len(orders), np.repeat([*orders], 7), np.ravel(rows[1:])) == OK


def y_of(part: Instance) -> Floats:
    """y, ẏ, ÿ: (3, p)."""
    listed = part.fmu.outputs
    return np.array([part.get_real(listed), *(part.get_rates(listed, [k] * len(listed)) for k in (1, 2))])


def states(part: Instance) -> Floats:
    r = part.fmu.modes
    names = (f"modes.{kind}[{i}]" for kind in ("amplitude", "velocity") for i in range(1, r + 1))
    return part.get(*names).reshape(2, r)


def moved(model: ReducedModel, rows: Floats, h: float) -> tuple[Floats, Floats]:
    """q … q⃜ (5, r) and u, u̇, ü (3, m) after h from START, by the exponential of the augmented matrix."""
    r, m = model.B.shape
    D = model.alpha * np.eye(r) + model.beta * np.diag(model.lam) + model.D_rest
    A = np.zeros((2 * r + 3 * m, 2 * r + 3 * m))
    A[:r, r : 2 * r] = np.eye(r)
    A[r : 2 * r, : 2 * r] = np.hstack([-np.diag(model.lam), -D])
    A[r : 2 * r, 2 * r : 2 * r + m] = model.B
    A[2 * r : 2 * r + 2 * m, 2 * r + m :] = np.eye(2 * m)
    u = np.vstack([rows, np.zeros((3 - len(rows), m))])
    x = expm(A * h) @ np.concatenate([[*START.values()], u.ravel()])
    q = np.array([(np.linalg.matrix_power(A, k) @ x)[:r] for k in range(5)])
    return q, x[2 * r :].reshape(3, m)


def close(model: ReducedModel, found: Floats, exact: Floats, q: Floats, u: Floats, tolerance: float) -> bool:
    """Each within this part of what its terms add up to."""
    size = measured(magnitude(model), np.abs(q), np.abs(u)) + np.abs(exact)
    return bool((np.abs(found - exact) <= tolerance * size).all())


def magnitude(model: ReducedModel) -> ReducedModel:
    """The model of absolute values: no sum in it cancels, but for normal stresses that are equal."""
    C = np.abs(model.C)
    start = row_starts(model.laws)[model.laws.index("mises")]
    C[start + 1 : start + 3] *= -1.0
    return everything(lam=model.lam, C=C, R=np.abs(model.R), R_in=np.abs(model.R_in), residual=model.residual)


@pytest.mark.parametrize("coupled", [True, False])
@pytest.mark.parametrize("rates", [0, 1, 2])
def test_every_output_and_its_derivatives(coupled: bool, rates: int) -> None:
    """At the start and after a step, with feed-through of the inputs and of their rates."""
    model, rows = everything(coupled=coupled), U[: rates + 1]
    part = native_fmu(everything, coupled=coupled).instance().initialise(START)
    for h in (0.0, 0.02):
        give(part, rows)
        if h:
            assert part.step(0.0, h) == OK
        q, u = moved(model, rows, h)
        assert close(model, y_of(part), measured(model, q, u), q, u, 1e-12)


def test_a_wrong_term_would_be_seen() -> None:
    """The control: each law with one of its parts 1e-6 too large is off by more than the tolerance."""
    model = everything()
    q, u = moved(model, U, 0.02)
    exact = measured(model, q, u)
    for key in ("C", "R", "R_in", "lam"):
        array = getattr(model, key)
        other = measured(everything(**{key: array * (1 + 1e-6)}), q, u)
        assert not close(model, other, exact, q, u, 1e-12)


def one_by_one(part: Instance) -> Floats:
    return np.array([part.get_real([reference])[0] for reference in part.fmu.outputs])


def test_any_order_and_choice_of_references() -> None:
    """Runs of outputs with one row and with more, alone, backwards, twice."""
    part = native_fmu(everything).instance().initialise(START)
    give(part, U)
    listed, y = part.fmu.outputs, y_of(part)
    np.testing.assert_array_equal(one_by_one(part), y[0])
    np.testing.assert_array_equal(part.get_real(listed[::-1]), y[0, ::-1])
    mixed = np.random.default_rng(2).integers(0, len(listed), 60)
    np.testing.assert_array_equal(part.get_real([listed[k] for k in mixed]), y[0, mixed])
    orders = np.random.default_rng(3).integers(1, 3, 60)
    np.testing.assert_array_equal(part.get_rates([listed[k] for k in mixed], orders), y[orders, mixed])


def test_each_alone_after_a_step() -> None:
    """Nothing that was asked for before is needed."""
    part = native_fmu(everything).instance().initialise(START)
    give(part, U)
    assert part.step(0.0, 0.01) == OK
    saved, y = part.save(), y_of(part)
    for k, reference in enumerate(part.fmu.outputs):
        for order in range(3):
            new = native_fmu(everything).instance()
            assert new.restore(saved) == OK
            found = new.get_rates([reference], [order]) if order else new.get_real([reference])
            assert found[0] == y[order, k]
            new.free()


def one_entry(key: str, row: int) -> ReducedModel:
    """Feed-through in one entry of R or R_in only, and of no mode that is off."""
    model = everything()
    arrays = {"R": 0 * model.R, "R_in": 0 * model.R_in}
    arrays[key][row, 3 if key == "R" else row] = 2.0
    return everything(f"{key}_{row}", residual=False, **arrays)


@pytest.mark.parametrize(("key", "row"), [("R", 0), ("R", 9), ("R_in", 3)])
def test_feed_through_of_one_entry(key: str, row: int) -> None:
    """Of a displacement, of the last stress of mises, of the strain energy."""
    model = one_entry(key, row)
    part = native_fmu(one_entry, key=key, row=row).instance().initialise(START)
    plain = native_fmu(one_entry, key="R", row=len(model.R) - 1).instance().initialise(START)
    for one in (part, plain):
        assert one.set_real(INPUTS, U[0]) == OK
    q, u = moved(model, U[:1], 0.0)
    assert close(model, y_of(part), measured(model, q, u), q, u, 1e-12)
    found = part.get(*model.outputs) != plain.get(*model.outputs)
    name = {"R": "left.displacement.x" if row == 0 else "left.stress.mises", "R_in": "energy.strain"}[key]
    assert [n for n, other in zip(model.outputs, found, strict=True) if other] == [name]


def test_outputs_of_all_zeros() -> None:
    """At rest without inputs: 0, and no derivative of a von Mises stress, whatever the stress will be."""
    part = native_fmu(everything).instance().initialise()
    assert (y_of(part) == 0.0).all()
    give(part, np.array([0 * U[0], U[1]]))
    y = dict(zip(everything().outputs, y_of(part).T, strict=True))
    assert y["left.stress.mises"].tolist() == [0.0, 0.0, 0.0]
    assert y["left.stress.xy"][1] != 0.0
    assert y["energy.strain"][2] > 0.0


@pytest.mark.parametrize("rates", [0, 1, 2])
def test_one_step_is_two_halves(rates: int) -> None:
    """Of coupled modes under the same polynomial, the derivatives given anew at the half."""
    rows, h = U[: rates + 1], 0.04
    whole, halves = (native_fmu(everything).instance().initialise(START) for _ in range(2))
    give(whole, rows)
    assert whole.step(0.0, h) == OK
    u = np.vstack([rows, np.zeros((2 - rates, 7))])
    middle = np.array([u[0] + h / 2 * u[1] + h**2 / 8 * u[2], u[1] + h / 2 * u[2], u[2]])
    for t, given in ((0.0, rows), (h / 2, middle[: rates + 1])):
        give(halves, given)
        assert halves.step(t, h / 2) == OK
    there, here = states(whole), states(halves)
    # a few roundings, each up to ωh = 6 times as a phase, of the largest amplitude and velocity
    assert (np.abs(there - here) <= 60 * 2.2e-16 * np.abs(there).max(axis=1, keepdims=True)).all()


def test_a_step_beyond_the_numbers_changes_nothing() -> None:
    """λh² of the uncoupled modes, |A| h of the coupled ones; and the next step is as if nothing had been."""
    for h in (1e14, 1e200):
        tried, other = (native_fmu(everything).instance().initialise(START) for _ in range(2))
        for part in (tried, other):
            give(part, U)
        before = tried.reals()
        assert tried.step(0.0, h) == DISCARD
        np.testing.assert_array_equal(tried.reals(), before)
        assert (tried.step(0.0, 0.1), other.step(0.0, 0.1)) == (OK, OK)
        np.testing.assert_array_equal(tried.reals(), other.reals())


def test_coupled_modes_that_decay_end_at_nothing() -> None:
    """As modes alone: below 1e-140 they are 0, not ever smaller numbers that slow a processor down."""
    tiny = {name: 1e-139 * (-1) ** k for k, name in enumerate(START) if "velocity" in name}
    part = native_fmu(static).instance().initialise(tiny)
    for k in range(3000):
        assert part.step(0.02 * k, 0.02) == OK
        if k == 3:
            assert (states(part)[1] != 0.0).any()
    assert (states(part) == 0.0).all()


def velocity_jump(model: ReducedModel, u_dot: Floats) -> Mapping[str, float]:
    """R u̇ of the velocities."""
    starts = dict(zip(model.outputs, row_starts(model.laws), strict=False))
    found = {n for n, law in zip(model.outputs, model.laws, strict=True) if law == "velocity"}
    return {n: float(model.R[starts[n]] @ u_dot) for n in found}


def test_velocities_know_the_rate_at_the_end_of_the_last_step() -> None:
    """R u̇ after a ramp, saved and restored, and gone with the next step, which is held."""
    model = everything()
    jump = velocity_jump(model, U[1])
    part = native_fmu(everything).instance().initialise(START)
    give(part, U[:2])
    assert part.step(0.0, 0.01) == OK
    with_ramp, saved = part.get(*jump), part.save()
    q_dot = states(part)[1]
    for name, value in zip(jump, with_ramp, strict=True):
        row = model.C[dict(zip(model.outputs, row_starts(model.laws), strict=False))[name]]
        assert value == pytest.approx(row @ q_dot + jump[name], rel=1e-12)
        assert abs(jump[name]) > 1e-3
    assert part.step(0.01, 0.01) == OK
    held, q_dot = part.get(*jump), states(part)[1]
    for name, value in zip(jump, held, strict=True):
        row = model.C[dict(zip(model.outputs, row_starts(model.laws), strict=False))[name]]
        assert value == pytest.approx(row @ q_dot, rel=1e-12)
    assert part.restore(saved) == OK
    np.testing.assert_array_equal(part.get(*jump), with_ramp)
    assert part.step(0.01, 0.01) == OK
    np.testing.assert_array_equal(part.get(*jump), held)
    part.must("Reset")
    part.initialise()
    assert (part.get(*jump) == 0.0).all()


def test_model_exchange_measures_the_same() -> None:
    """There inputs have no rates; values at the same states and inputs are equal to the last bit."""
    part = native_fmu(everything).instance().initialise(START)
    assert part.set_real(INPUTS, U[0]) == OK
    other = native_fmu(everything).instance(MODEL_EXCHANGE).initialise()
    other.must("EnterContinuousTimeMode")
    assert other.set_states(np.array([*START.values()])) == OK
    assert other.set_real(INPUTS, U[0]) == OK
    np.testing.assert_array_equal(other.reals(), part.reals())


def test_modes_that_are_off_follow_statically() -> None:
    """At rest in equilibrium displacements, stresses and the strain energy do not depend on modes.active."""
    part = native_fmu(static).instance()
    part.must("EnterInitializationMode")
    assert part.set_real(INPUTS, U[0]) == OK
    still = [
        n for n in static().outputs if n.split(".")[1] in ("displacement", "rotation", "stress", "strain")
    ]
    whole = part.get(*still)
    for active in (6, 3, 0, 5, 7):
        assert part.set_active(active) == OK
        assert part.get(*still) == pytest.approx(whole, rel=1e-12)
    truncated = native_fmu(static, residual=False).instance()
    truncated.must("EnterInitializationMode")
    assert truncated.set_real(INPUTS, U[0]) == OK
    np.testing.assert_allclose(truncated.get(*still), whole, rtol=1e-12)  # all are on
    assert truncated.set_active(3) == OK
    assert (np.abs(truncated.get(*still) / whole - 1) > 1e-6).all()


def test_a_part_that_only_follows() -> None:
    """All modes off: y = (R + C Λ⁻¹ B) u with u and its rates, whatever the step; accelerations R u alone."""
    model = static()
    flexible = model.B / model.lam[:, None]
    part = native_fmu(static).instance().initialise()
    assert part.set_active(0) == OK
    give(part, U)
    h = 0.3
    assert part.step(0.0, h) == OK
    u = [U[0] + h * U[1] + h**2 / 2 * U[2], U[1] + h * U[2], U[2], 0 * U[2]]
    found = y_of(part)
    for k, (law, first) in enumerate(zip(model.laws, row_starts(model.laws), strict=False)):
        if law in ("position", "velocity", "acceleration", "reaction"):
            R = model.R[first] + (model.C[first] @ flexible if law in ("position", "velocity") else 0.0)
            orders = [order + (law == "velocity") for order in range(3)]
            exact = [float(R @ u[order]) for order in orders]
            assert found[:, k] == pytest.approx(exact, rel=1e-12), model.outputs[k]
    R_in = model.R_in + model.B.T @ flexible
    strain = [u[0] @ R_in @ u[0] / 2, u[0] @ R_in @ u[1], u[1] @ R_in @ u[1] + u[0] @ R_in @ u[2]]
    assert found[:, -1] == pytest.approx(strain, rel=1e-12)
    assert (found[:, -2] == 0.0).all()


def first_modes(active: int) -> ReducedModel:
    model = everything()
    return everything(
        f"first_{active}",
        lam=model.lam[:active],
        D_rest=model.D_rest[:active, :active].copy(),
        B=model.B[:active],
        C=model.C[:, :active].copy(),
        residual=False,
    )


@pytest.mark.parametrize("active", [6, 5, 3, 2, 1])
def test_modes_that_are_off_couple_nothing(active: int) -> None:
    """As the model that has the first modes alone, to the last bit; of two modes none is coupled."""
    x = native_fmu(everything, residual=False).instance().initialise(START)
    few = native_fmu(first_modes, active=active).instance()
    few.initialise({name: START[name] for name in few.fmu.reference if name in START})
    assert x.set_active(active) == OK
    t = 0.0
    for h in (0.05, 0.01, 0.05):
        for part in (x, few):
            give(part, U)
            assert part.step(t, h) == OK
        t += h
    np.testing.assert_array_equal(states(x)[:, :active], states(few)[:, :active])
    np.testing.assert_array_equal(y_of(x), y_of(few))
    assert x.set_active(7) == OK
    assert x.step(t, 0.01) == OK
    assert (states(x)[:, active:] != 0.0).any()
