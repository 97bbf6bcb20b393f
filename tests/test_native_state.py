"""States of the native FMU: saved, set and serialised in every mode, they replay to the last bit."""

import ctypes

import numpy as np
import pytest
from examples import two_ports
from native_fmu import (
    CO_SIMULATION,
    DISCARD,
    ERROR,
    MODEL_EXCHANGE,
    OK,
    Instance,
    NativeFmu,
    alone,
    native_fmu,
)
from native_modes import MODES, driven_ports, elastic_everything, elastic_ports, instance_in

from fmu_src.runtime.model import Floats


def observe(x: Instance) -> Floats:
    """All that can be read between two steps."""
    outputs = x.fmu.outputs
    rates = [x.get_rates(outputs, [order] * len(outputs)) for order in (1, 2)]
    return np.concatenate([x.reals(), *rates, [x.get_active()]])


def random_run(x: Instance, seed: int, t: float, steps: int = 40) -> tuple[float, Floats]:
    """Inputs, their rates, damping and modes.active at random; the time at the end and what was seen."""
    rng = np.random.default_rng(seed)
    sizes = rng.uniform(1e-3, 0.3, 5)
    seen = [observe(x)]
    for _ in range(steps):
        inputs = x.fmu.inputs
        assert x.set_real(inputs, rng.normal(size=len(inputs))) == OK
        if rng.random() < 0.5:
            places, order = rng.choice(inputs, 2), rng.integers(1, 3, 2)
            assert x.set_rates(places, order, rng.normal(size=2)) == OK
        if rng.random() < 0.2:
            assert (
                x.set({"damping.alpha": rng.uniform(0.0, 2.0), "damping.beta": rng.uniform(0.0, 0.1)}) == OK
            )
        if rng.random() < 0.2:
            assert x.set_active(int(rng.integers(0, x.fmu.modes + 1))) == OK
        h = rng.choice(sizes) if rng.random() < 0.7 else rng.uniform(1e-4, 0.5)
        assert x.step(t, h) == OK
        t += h
        seen.append(observe(x))
    return t, np.array(seen)


PARTS = ["rest", "static", "everything rest", "everything static", "driven rest", "driven static"]
MAKE = {"everything": elastic_everything, "driven": driven_ports}


def part(name: str) -> NativeFmu:
    return native_fmu(MAKE.get(name.split()[0], elastic_ports), initial=name.split()[-1])


def in_mid_run(initial: str, seed: int) -> tuple[Instance, float]:
    """An instance with rates set for the step to come."""
    x = part(initial).instance().initialise({"right.force.y": 1.0})
    t, _ = random_run(x, seed, 0.0)
    assert x.set_rates(x.fmu.inputs[:3], [1, 2, 1], [3.0, -5.0, 7.0]) == OK
    return x, t


def went_on(initial: str, saved: bytes, seed: int, t: float) -> Floats:
    """What a new instance sees that goes on from a state."""
    x = part(initial).instance()
    assert x.restore(saved) == OK
    _, seen = random_run(x, seed, t)
    x.free()
    return seen


@pytest.mark.parametrize("initial", PARTS)
@pytest.mark.parametrize("seed", range(2))
def test_replay(initial: str, seed: int) -> None:
    """In the same instance after other steps, in another one, and after a reset."""
    x, t = in_mid_run(initial, seed)
    saved = x.save()
    _, seen = random_run(x, 100 + seed, t)
    assert np.unique(seen, axis=0).shape[0] == len(seen)  # something happens in every step
    assert x.restore(saved) == OK
    assert x.save() == saved
    np.testing.assert_array_equal(random_run(x, 100 + seed, t)[1], seen)
    x.must("Reset")
    assert x.restore(saved) == OK
    np.testing.assert_array_equal(random_run(x, 100 + seed, t)[1], seen)
    np.testing.assert_array_equal(went_on(initial, saved, 100 + seed, t), seen)
    x.free()


def test_replay_in_another_process() -> None:
    x, t = in_mid_run("static", 5)
    saved = x.save()
    _, seen = random_run(x, 6, t)
    np.testing.assert_array_equal(alone(went_on, "static", saved, 6, t), seen)
    x.free()


def test_saving_changes_nothing() -> None:
    runs = []
    for save in (False, True):
        x = part("rest").instance().initialise()
        t, seen = 0.0, []
        for seed in range(20):
            if save:
                assert x.restore(x.save()) == OK
            t, part_seen = random_run(x, seed, t, steps=2)
            seen.append(part_seen)
        runs.append(np.array(seen))
        x.free()
    np.testing.assert_array_equal(runs[0], runs[1])


def test_pending_rates_belong_to_the_state() -> None:
    """Where the saved step had none, those set since are gone; where it had some, they are back."""
    x = part("rest").instance().initialise({"left.force.x": 1.0})
    assert x.step(0.0, 0.2) == OK
    without = x.save()
    assert x.set_rates([0], [1], [50.0]) == OK
    pending = x.save()
    ends = []
    for saved in (without, pending, without, pending):
        assert x.restore(saved) == OK
        assert x.step(0.2, 0.3) == OK
        ends.append(x.get("left.force.x", "left.displacement.x"))
    np.testing.assert_array_equal(ends[:2], ends[2:])
    assert [end[0] for end in ends[:2]] == [1.0, 16.0]  # 1 + 50·0.3
    assert ends[0][1] != ends[1][1]
    x.free()


def life_after(x: Instance, mode: str) -> Floats:
    """From this mode to the end, with everything seen on the way."""
    seen = []
    if mode == "instantiated":
        x.must("SetupExperiment", 0, 0.0, 0.0, 0, 0.0)
        x.must("EnterInitializationMode")
        mode = "initialization"
    if mode == "initialization":
        seen.append(x.reals())
        x.must("ExitInitializationMode")
        mode = "step" if x.kind == CO_SIMULATION else "event"
    if mode == "event":
        seen.append(np.array([x.new_discrete_states().states_changed]))
        x.must("EnterContinuousTimeMode")
        mode = "continuous"
    if mode == "continuous":
        seen += [x.get_states(), x.get_states("GetDerivatives")]
    elif mode in ("step", "failed step"):
        seen.append(observe(x))
        assert x.step(0.0, 0.1) == OK
    if mode != "terminated":
        x.must("Terminate")
    return np.concatenate([*seen, x.reals()])


@pytest.mark.parametrize(("kind", "mode"), [(kind, mode) for kind in MODES for mode in MODES[kind]])
def test_a_state_brings_its_mode_with_it(kind: int, mode: str) -> None:
    x = instance_in(kind, mode)
    if mode not in ("terminated", "continuous"):
        assert x.set_active(4) == OK
    saved = x.save()
    expected = life_after(x, mode)
    x.free()
    for other in MODES[kind]:
        y = instance_in(kind, other)
        assert y.restore(saved) == OK
        assert y.save() == saved
        np.testing.assert_array_equal(life_after(y, mode), expected)
        y.free()


def test_a_jump_of_the_states_is_told_after_a_replay_too() -> None:
    x = instance_in(MODEL_EXCHANGE, "event")
    assert x.set_active(0) == OK
    saved = x.save()
    for _ in range(2):
        assert x.new_discrete_states().states_changed == 1
        assert x.new_discrete_states().states_changed == 0
        assert x.restore(saved) == OK
    x.free()


def test_model_exchange_replays() -> None:
    x = instance_in(MODEL_EXCHANGE, "continuous")
    rng = np.random.default_rng(3)
    states = rng.normal(size=2 * x.fmu.modes)
    assert x.set_real(x.fmu.inputs, rng.normal(size=3)) == OK
    assert x.set_states(states) == OK
    x.must("SetTime", 4.0)
    saved, derivatives, reals = x.save(), x.get_states("GetDerivatives"), x.reals()
    x.must("EnterEventMode")
    assert x.set_active(2) == OK
    assert x.set({"damping.alpha": 9.0, "left.force.x": 5.0}) == OK
    assert x.restore(saved) == OK
    np.testing.assert_array_equal(x.get_states(), states)
    np.testing.assert_array_equal(x.get_states("GetDerivatives"), derivatives)
    np.testing.assert_array_equal(x.reals(), reals)
    x.free()


@pytest.mark.parametrize("kind", [MODEL_EXCHANGE, CO_SIMULATION])
@pytest.mark.parametrize("initial", PARTS)
def test_a_reset_instance_is_a_new_one(initial: str, kind: int) -> None:
    fresh, x = (part(initial).instance(kind) for _ in range(2))
    x.must("SetupExperiment", 0, 0.0, 3.0, 1, 9.0)
    x.must("EnterInitializationMode")
    assert x.set({"left.force.x": 7.0, "damping.alpha": 2.0, "modes.velocity[3]": 1.0}) == OK
    x.must("ExitInitializationMode")
    assert x.set_active(3) == OK
    if kind == CO_SIMULATION:
        random_run(x, 8, 3.0, steps=10)
        assert x.set_rates([0], [1], [1.0]) == OK
        assert x.step(0.0, -1.0) == ERROR
    x.must("Reset")
    assert x.save() == fresh.save()
    for one in (fresh, x):
        one.initialise({"right.force.y": 2.0})
    if kind == CO_SIMULATION:
        np.testing.assert_array_equal(random_run(x, 9, 0.0)[1], random_run(fresh, 9, 0.0)[1])
    np.testing.assert_array_equal(x.reals(), fresh.reals())
    assert x.save() == fresh.save()
    fresh.free()
    x.free()


def test_handles_of_states() -> None:
    """Several at once, each usable often, by other instances too; a handle given again keeps its memory."""
    x = native_fmu(two_ports).instance().initialise({"left.force.x": 1.0})
    handles, seen = [], []
    for k in range(4):
        assert x.step(0.1 * k, 0.1) == OK
        handle = ctypes.c_void_p()
        x.must("GetFMUstate", ctypes.byref(handle))
        handles.append(handle)
        seen.append(x.reals())
    assert len({handle.value for handle in handles}) == 4
    y = native_fmu(two_ports).instance()
    for one in (x, y):
        for k in (2, 0, 3, 3, 1):
            one.must("SetFMUstate", handles[k])
            np.testing.assert_array_equal(one.reals(), seen[k])
    memory = handles[0].value
    x.must("SetFMUstate", handles[3])
    x.must("GetFMUstate", ctypes.byref(handles[0]))
    assert handles[0].value == memory
    y.must("SetFMUstate", handles[0])
    np.testing.assert_array_equal(y.reals(), seen[3])
    for handle in handles:
        x.must("FreeFMUstate", ctypes.byref(handle))
    x.free()
    y.free()


def test_a_discarded_step_is_tried_again_with_a_smaller_one() -> None:
    """With and without going back to the state before it."""
    ends = []
    for restore in (False, True):
        x = native_fmu(two_ports).instance().initialise({"left.force.x": 1.0})
        assert x.step(0.0, 0.1) == OK
        assert x.set_rates([1], [1], [2.0]) == OK
        saved = x.save()
        assert x.step(0.1, 1e200) == DISCARD
        if restore:
            assert x.restore(saved) == OK
        assert x.step(0.1, 0.1) == OK
        ends.append(observe(x))
        x.free()
    np.testing.assert_array_equal(ends[0], ends[1])
