"""Which steps are made: where they start and end, and how large they are."""

import math

import numpy as np
import pytest
from examples import two_ports
from native_fmu import (
    DISCARD,
    ERROR,
    MODEL_EXCHANGE,
    OK,
    Instance,
    native_fmu,
)
from native_modes import NOT_FINITE, elastic_ports, instance_in, refused


def stepped() -> Instance:
    """One step made, the next one refused: so the status of the last step does not change any more."""
    x = native_fmu(two_ports).instance().initialise({"left.force.x": 1.0})
    assert x.step(0.0, 0.5) == OK
    assert x.set_rates([0, 1, 2], [1, 2, 1], [1.0, 2.0, 3.0]) == OK
    assert x.step(0.5, -1.0) == ERROR
    x.log.clear()
    return x


@pytest.mark.parametrize("h", [-1.0, -5e-324, 0.0, -0.0, *NOT_FINITE])
def test_sizes_that_are_no_step(h: float) -> None:
    x = stepped()
    before = x.save()
    assert x.step(0.5, h) == ERROR
    assert refused(x, ERROR, "DoStep", "communicationStepSize", "expected a finite number > 0")
    assert x.save() == before
    x.free()


@pytest.mark.parametrize("time", [0.0, 0.4999, 0.5001, -0.5, 1e300, *NOT_FINITE])
def test_a_step_starts_where_the_last_one_ended(time: float) -> None:
    x = stepped()
    before = x.save()
    assert x.step(time, 0.1) == ERROR
    assert refused(x, ERROR, "DoStep", "currentCommunicationPoint", "expected 0.5")
    assert x.save() == before
    x.free()


@pytest.mark.parametrize(
    ("start", "offset", "h", "expected"),
    [
        (0.0, 0.9e-9, 0.1, OK),
        (0.0, -0.9e-9, 0.1, OK),
        (0.0, 1.1e-9, 0.1, ERROR),
        (0.5, -1.1e-9, 0.1, ERROR),
        (1e3, 0.9e-6, 0.1, OK),
        (1e3, 1.1e-6, 0.1, ERROR),
        (-1e3, -0.9e-6, 0.1, OK),
        # steps shorter than that tolerance: another point is half a step away
        (0.0, 4e-11, 1e-10, OK),
        (0.0, 6e-11, 1e-10, ERROR),
    ],
)
def test_the_same_point(start: float, offset: float, h: float, expected: int) -> None:
    x = native_fmu(two_ports).instance().initialise(start=start)
    assert x.step(start + offset, h) == expected
    x.free()


@pytest.mark.parametrize("h", [1e3, 1e9, 1e100, 1e140])
def test_enormous_steps(h: float) -> None:
    """Rigid modes run beyond the numbers; elastic damped ones come to the static solution."""
    free_part = native_fmu(two_ports).instance().initialise({"left.force.x": 1e100})
    assert free_part.step(0.0, 0.5) == OK
    before = free_part.reals()
    status = free_part.step(0.5, h)
    assert status == (DISCARD if h > 1e60 else OK)
    if status == DISCARD:
        np.testing.assert_array_equal(free_part.reals(), before)
        assert "beyond the range of numbers" in free_part.log[-1].text
        assert free_part.step(0.5, 0.5) == OK
    free_part.free()
    held = native_fmu(elastic_ports, initial="rest").instance().initialise({"left.force.x": 1.0})
    assert held.step(0.0, h) == OK
    static = native_fmu(elastic_ports, initial="static").instance().initialise({"left.force.x": 1.0})
    names = [f"modes.amplitude[{i + 1}]" for i in range(6)]
    # h = 1000 s is 150 decay times of the slowest mode: e^-150
    np.testing.assert_allclose(held.get(*names), static.get(*names), rtol=1e-12)
    held.free()
    static.free()


def test_a_step_to_a_time_beyond_the_numbers() -> None:
    x = native_fmu(two_ports).instance().initialise(start=1.5e308)
    assert x.set_active(0) == OK  # so that nothing but the time leaves the range
    assert x.step(1.5e308, 1e308) == DISCARD
    time = np.zeros(1)
    x.must("GetRealStatus", 2, time)
    assert time == [1.5e308]
    assert x.restore(x.save()) == OK
    x.free()


def test_inputs_extrapolated_beyond_the_numbers() -> None:
    """Nothing moves, but an input or its rate would leave the range: the step is not made."""
    x = native_fmu(two_ports).instance().initialise()
    assert x.set_active(0) == OK
    start = x.save()
    for order in (1, 2):
        assert x.set_rates([0], [order], [1e300]) == OK
        assert x.step(0.0, 1e20) == DISCARD
        assert x.get("left.force.x") == [0.0]
        assert x.step(0.0, 1e-3) == OK
        assert x.restore(start) == OK
    x.free()


def test_the_last_step_may_round() -> None:
    """Within 1e-9 of stopTime, as of where a step starts."""
    x = native_fmu(two_ports).instance()
    x.must("SetupExperiment", 0, 0.0, 0.0, 1, 1e4)
    x.must("EnterInitializationMode")
    x.must("ExitInitializationMode")
    assert x.step(0.0, 1e4 * (1 + 2e-9)) == ERROR
    assert x.step(0.0, 1e4 * (1 + 5e-10)) == OK
    x.free()


def test_no_step_beyond_the_stop_time() -> None:
    x = native_fmu(two_ports).instance()
    x.must("SetupExperiment", 0, 0.0, 0.0, 1, 0.3)
    x.must("EnterInitializationMode")
    x.must("ExitInitializationMode")
    t = 0.0
    for _ in range(3):  # ends at 0.30000000000000004
        assert x.step(t, 0.1) == OK
        t += 0.1
    x.log.clear()
    assert x.step(t, 0.1) == ERROR
    assert refused(x, ERROR, "DoStep", "expected no later than stopTime")
    x.must("Reset")
    x.initialise()
    assert x.step(0.0, 2.0) == OK  # the stop time is forgotten
    x.free()


@pytest.mark.parametrize(
    ("start", "defined", "stop"),
    [*((value, 0, 0.0) for value in NOT_FINITE), (1.0, 1, 0.5), (0.0, 1, math.nan), (0.0, 1, -math.inf)],
)
def test_experiments_that_cannot_be(start: float, defined: int, stop: float) -> None:
    x = native_fmu(two_ports).instance()
    before = x.save()
    x.log.clear()
    assert x.call("SetupExperiment", 0, 0.0, start, defined, stop) == ERROR
    assert refused(x, ERROR, "SetupExperiment", "startTime")
    assert x.save() == before
    x.must("SetupExperiment", 0, math.nan, 0.0, 0, math.nan)  # what is not defined means nothing
    x.must("SetupExperiment", 1, 1e-6, 0.0, 1, math.inf)
    x.free()


@pytest.mark.parametrize(
    "call",
    ["SetContinuousStates", "GetContinuousStates", "GetDerivatives", "GetNominalsOfContinuousStates"],
)
def test_wrong_numbers_of_states(call: str) -> None:
    x = instance_in(MODEL_EXCHANGE, "continuous")
    before, values = x.save(), np.full(13, -7.0)
    for count in (0, 1, 11, 13, 2**64 - 1):
        x.log.clear()
        assert x.call(call, values, count) == ERROR
        assert refused(x, ERROR, call, f"got {count} values", "12")
    assert x.call("GetEventIndicators", values, 1) == ERROR
    np.testing.assert_array_equal(values, -7.0)
    assert x.save() == before
    x.free()
