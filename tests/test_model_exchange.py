"""Model exchange: a tool's own solver integrates the part and comes to what co-simulation computes."""

from collections.abc import Callable
from ctypes import byref, c_int

import numpy as np
import pytest
from examples import oscillator, two_ports
from fmpy import simulate_fmu
from native_fmu import ERROR, MODEL_EXCHANGE, OK, EventInfo, Instance, NativeFmu, native_fmu
from scipy.integrate import solve_ivp
from structures import inputs, static

from fmu_src.runtime.model import Floats, ReducedModel

KNOTS = np.array([0.0, 0.2, 0.5, 0.6, 1.0])  # where the forces jump; the last row is never felt
FORCES = np.array([[1.0, -2.0, 0.5], [3.0, 1.0, 0.0], [-2.0, 1.0, 4.0], [0.0, 0.0, 1.0], [2.0, -1.0, 1.0]])
NOTHING = (0, 0, 0, 0, 0)  # no event of any kind


def events(info: EventInfo) -> tuple[int, ...]:
    flags = ("new_discrete_states_needed", "terminate", "nominals_changed", "states_changed")
    return tuple(getattr(info, name) for name in (*flags, "next_event_defined"))


def exact(fmu: NativeFmu) -> Floats:
    """Outputs at the last knot by co-simulation: each force is held over one step."""
    part = fmu.instance().initialise(dict(zip(inputs(fmu), FORCES[0], strict=True)))
    for t, h, force in zip(KNOTS, np.diff(KNOTS), FORCES, strict=False):
        assert part.set_real(fmu.inputs, force) == OK
        assert part.step(t, h) == OK
    return part.get_real(fmu.outputs)


def by_cvode(fmu: NativeFmu, tolerance: float) -> Floats:
    """The same by FMPy's solver, which starts anew where a time stands twice in the table of the inputs."""
    times = np.concatenate([np.repeat(KNOTS[:-1], 2)[1:], KNOTS[-1:]])
    columns = [("time", float), *((name, float) for name in inputs(fmu))]
    rows = zip(times, np.repeat(FORCES[:-1], 2, axis=0), strict=True)
    names = [v.name for v in fmu.description.modelVariables if v.causality == "output"]
    result = simulate_fmu(
        str(fmu.folder),
        fmi_type="ModelExchange",
        stop_time=KNOTS[-1],
        relative_tolerance=tolerance,
        input=np.array([(t, *u) for t, u in rows], dtype=columns),
        output=names,
        output_interval=0.01,
    )
    assert result["time"][-1] == pytest.approx(KNOTS[-1])
    return np.array([result[name][-1] for name in names])


@pytest.mark.parametrize("make", [two_ports, static], ids=["with rigid modes", "from equilibrium"])
def test_cvode_converges_to_cosimulation(make: Callable[[], ReducedModel]) -> None:
    """Its error falls with its tolerance, by a factor that is a power of it."""
    fmu = native_fmu(make)
    reference, tolerances = exact(fmu), np.array([1e-4, 1e-5, 1e-6, 1e-7, 1e-8])
    errors = [np.abs(by_cvode(fmu, t) - reference).max() / np.abs(reference).max() for t in tolerances]
    assert (np.diff(errors) < 0).all(), errors
    order = np.polyfit(np.log(tolerances), np.log(errors), 1)[0]
    assert 0.6 < order < 1.2, errors
    assert errors[-1] < 300 * tolerances[-1]  # a global error is some multiple of that of the steps


# an integrator of our own, which comes close to rounding


def integrate(part: Instance, t: float, end: float) -> None:
    """Runge–Kutta of order 8 over the FMU's own derivatives, in continuous-time mode."""

    def rate(time: float, x: Floats) -> Floats:
        part.must("SetTime", time)
        assert part.set_states(x) == OK
        return part.get_states("GetDerivatives")

    solution = solve_ivp(rate, (t, end), part.get_states(), "DOP853", rtol=1e-11, atol=1e-13)
    part.must("SetTime", end)
    assert part.set_states(solution.y[:, -1]) == OK


def event(part: Instance, change: Callable[[Instance], int]) -> tuple[int, ...]:
    """Into event mode, the change, and back; what changed."""
    part.must("EnterEventMode")
    assert change(part) == OK
    found = events(part.new_discrete_states())
    part.must("EnterContinuousTimeMode")
    return found


def exchanging(fmu: NativeFmu, **start: float) -> Instance:
    part = fmu.instance(MODEL_EXCHANGE).initialise(start)
    part.new_discrete_states()
    part.must("EnterContinuousTimeMode")
    return part


@pytest.mark.parametrize("make", [two_ports, static], ids=["with rigid modes", "from equilibrium"])
def test_changes_at_events(make: Callable[[], ReducedModel]) -> None:
    """Inputs, modes.active down and up again, damping: at events, as co-simulation does between steps."""
    fmu = native_fmu(make)
    force = dict(zip(inputs(fmu), [1.0, -0.5, 2.0], strict=True))
    me, cs = exchanging(fmu, **force), fmu.instance().initialise(force)
    damping = {"damping.alpha": 2.0, "damping.beta": 3e-3}
    changes: list[tuple[Callable[[Instance], int], bool]] = [
        (lambda part: part.set({"left.force.z": 1.5}), False),
        (lambda part: part.set_active(3), True),  # states jump to rest
        (lambda part: part.set(damping), False),
        (lambda part: part.set_active(6), False),  # switched on from rest: no jump
        (lambda part: OK, False),
    ]
    t, h = 0.0, 0.11
    for change, jump in changes:
        integrate(me, t, t + h)
        assert cs.step(t, h) == OK
        t += h
        peak = np.abs(cs.reals()).max()
        np.testing.assert_allclose(me.reals(), cs.reals(), rtol=1e-8, atol=1e-10 * peak)
        before = me.get_states()
        assert event(me, change) == (0, 0, 0, int(jump), 0)
        assert change(cs) == OK
        assert (not np.array_equal(me.get_states(), before)) == jump
        np.testing.assert_allclose(me.reals(), cs.reals(), rtol=1e-8, atol=1e-10 * peak)
        off = np.arange(12) % 6 >= me.get_active()
        assert (me.get_states()[off] == 0).all()
        assert (me.get_states("GetDerivatives")[off] == 0).all()
        assert (me.get_states("GetDerivatives")[~off] != 0).any()


def test_states_of_modes_switched_off_stay_zero() -> None:
    """Even if the solver gives them values, as the rounding of its linear algebra may do."""
    part = exchanging(native_fmu(two_ports), **{"left.force.x": 1.0})
    event(part, lambda one: one.set_active(2))
    assert part.set_states(np.ones(12)) == OK
    assert part.get_states().tolist() == [1, 1, 0, 0, 0, 0] * 2
    assert (part.get_states("GetDerivatives").reshape(2, 6)[:, 2:] == 0).all()


def test_a_free_body_flies() -> None:
    """No spring, no damping: x = v t + F t²/2m."""
    fmu = native_fmu(oscillator, stiffness=0.0, damping=0.0, mass=4.0)
    part = exchanging(fmu, **{"tip.force.x": 6.0, "modes.velocity[1]": -3.0})
    integrate(part, 0.0, 2.0)
    # the velocity of the mode is √m times that of the mass
    expected = [-1.5 * 2 + 6.0 * 2**2 / 8, -1.5 + 6.0 * 2 / 4, 1.5]
    found = part.get("tip.displacement.x", "tip.velocity.x", "tip.acceleration.x")
    assert found == pytest.approx(expected, rel=1e-12, abs=1e-12)


def test_settings_belong_to_event_mode() -> None:
    part = exchanging(native_fmu(two_ports))
    before = part.reals()
    assert part.set({"damping.alpha": 1.0}) == ERROR
    assert "event mode" in part.log[-1].text
    assert part.set_active(2) == ERROR
    np.testing.assert_array_equal(part.reals(), before)
    assert part.get_active() == 6


def test_states_stand_in_the_order_of_the_derivatives() -> None:
    """The i-th of ModelStructure's Derivatives is that of the i-th state; nominals are the declared ones."""
    fmu = native_fmu(static)
    part = exchanging(fmu, **{"left.force.x": 1.0})
    derivatives = [unknown.variable for unknown in fmu.description.derivatives]
    own = [variable.derivative for variable in derivatives]
    x = np.arange(1.0, 13.0)
    assert part.set_states(x) == OK
    np.testing.assert_array_equal(part.get_states(), x)
    np.testing.assert_array_equal(part.get_real(v.valueReference for v in own), x)
    rates = part.get_states("GetDerivatives")
    np.testing.assert_array_equal(part.get_real(v.valueReference for v in derivatives), rates)
    np.testing.assert_array_equal(rates[:6], x[6:])
    nominals = part.get_states("GetNominalsOfContinuousStates")
    assert nominals == pytest.approx([float(v.nominal) for v in own], rel=1e-15)
    assert len({*nominals}) == 12


def test_there_are_no_events() -> None:
    fmu = native_fmu(two_ports)
    part = fmu.instance(MODEL_EXCHANGE).initialise({"left.force.x": 1.0})
    assert events(part.new_discrete_states()) == NOTHING
    part.must("EnterContinuousTimeMode")
    step_event, terminate = c_int(7), c_int(7)
    part.must("CompletedIntegratorStep", 1, byref(step_event), byref(terminate))
    assert (step_event.value, terminate.value) == (0, 0)
    part.must("GetEventIndicators", None, 0)
    assert fmu.description.numberOfEventIndicators == 0
    assert not fmu.description.modelExchange.needsCompletedIntegratorStep


def test_time_alone_changes_nothing() -> None:
    part = exchanging(native_fmu(two_ports), **{"left.force.x": 1.0, "modes.amplitude[3]": 0.5})
    before = part.reals(), part.get_states("GetDerivatives")
    part.must("SetTime", 123.0)
    np.testing.assert_array_equal(part.reals(), before[0])
    np.testing.assert_array_equal(part.get_states("GetDerivatives"), before[1])
