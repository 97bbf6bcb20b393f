"""What an instance keeps between calls: the place in time, the step coefficients, a rollback."""

import numpy as np
import pytest
from examples import two_ports

from fmu_src.runtime.instance import Instance


@pytest.fixture
def instance() -> Instance:
    made = Instance(two_ports())
    made.initialising = False
    made.set_inputs([0, 1, 2], [1.0, -0.5, 0.25])
    return made


@pytest.mark.parametrize(
    ("time", "offset", "h", "accepted"),
    [
        (0.0, 0.9e-9, 0.1, True),
        (0.0, 1.1e-9, 0.1, False),
        (0.0, 1e-6, 0.1, False),
        (1e6, 0.9e-3, 0.1, True),
        (1e6, 1.1e-3, 0.1, False),
        (2000.0, -1e-6, 1e-6, False),  # the same short step twice is not the next one
    ],
)
def test_a_step_starts_where_the_last_one_ended(
    instance: Instance, time: float, offset: float, h: float, accepted: bool
) -> None:
    instance.time = time
    reason = instance.advance(time + offset, h)
    assert (reason is None) == accepted
    assert instance.time == (time + offset + h if accepted else time)


def test_small_differences_of_time_do_not_add_up(instance: Instance) -> None:
    assert instance.advance(0.0, 0.1) is None
    assert instance.advance(0.1 + 1e-12, 0.1) is None
    assert instance.time == 0.1 + 1e-12 + 0.1


def test_warnings_made_errors_by_the_host_do_not_matter(instance: Instance) -> None:
    with np.errstate(all="raise"):
        assert instance.advance(0.0, 1e-9) is None
        assert instance.advance(1e-9, 100.0) is None
        instance.set_inputs([0], [np.inf])
        assert not np.isfinite(instance.reals()).all()
        assert "inf" in str(instance.advance(instance.time, 0.1))
        instance.set_inputs([0], [1.0])
        instance.set_damping(1e170, 0.0)
        assert instance.advance(instance.time, 0.1) is None
        assert np.isfinite(instance.reals()[: instance.layout.outputs.stop]).all()


def test_an_infinite_input_at_a_static_start_is_refused_by_the_step_only() -> None:
    lam = np.array([3.0, 7.0, 30.0, 30.0, 400.0, 9000.0])
    instance = Instance(two_ports(lam=lam, initial="static"))
    with np.errstate(all="raise"):
        instance.set_inputs([0], [np.inf])
        instance.set_damping(1e308, 1e308)
        instance.set_damping(0.3, 1e-3)
        instance.set_inputs([0], [1.0])
        instance.initialising = False
        assert instance.advance(0.0, 0.1) is None


def test_motion_beyond_numbers_is_refused_and_nothing_changes(instance: Instance) -> None:
    before = instance.reals().copy()
    assert "beyond the range of numbers" in str(instance.advance(0.0, 1e300))
    np.testing.assert_array_equal(instance.reals(), before)
    assert instance.time == 0.0


def test_rollback_keeps_the_step_coefficients(instance: Instance) -> None:
    instance.advance(0.0, 0.1)
    saved, coefficients = instance.save(), instance._propagators(0.1)
    instance.advance(0.1, 0.1)
    instance.restore(saved)
    assert instance._propagators(0.1) is coefficients
    instance.set_damping(0.5, 1e-3)
    assert instance._propagators(0.1) is not coefficients


def test_modes_switched_off_take_no_initial_values() -> None:
    instance = Instance(two_ports())
    instance.set_active(2)
    instance.set_state({instance.layout.q.start + 1: 1.0, instance.layout.q.start + 4: 1.0})
    assert instance.state.q.tolist() == [0, 1, 0, 0, 0, 0]
