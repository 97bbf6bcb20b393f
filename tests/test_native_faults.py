"""Wrong pointers, references and values are refused with a reason, and change nothing."""

import numpy as np
import pytest
from examples import two_ports
from native_fmu import (
    CALLS,
    CO_SIMULATION,
    DISCARD,
    ERROR,
    MODEL_EXCHANGE,
    OK,
    POINTER,
    SIZE,
    alone,
    native_fmu,
)
from native_modes import KINDS, NOT_FINITE, elastic_ports, good_arguments, instance_in, refused
from test_native_calls import legal


def test_null_pointers() -> None:
    alone(_null_pointers)


def _null_pointers() -> None:
    tried = 0
    for kind, mode in [(MODEL_EXCHANGE, "event"), (MODEL_EXCHANGE, "continuous"), (CO_SIMULATION, "step")]:
        for call, kinds in CALLS.items():
            if not legal(kind, call, mode):
                continue
            for place in (k for k, argument in enumerate(kinds) if argument is POINTER):
                x = instance_in(kind, mode)
                arguments = list(good_arguments(x, call))
                if arguments[place] is None:  # an empty array: ask for one element of it
                    arguments[kinds.index(SIZE)] = 1
                arguments[place], before = None, x.save()
                x.log.clear()
                if call == "FreeFMUstate":
                    assert x.call(call, *arguments) == OK
                else:
                    assert x.call(call, *arguments) == ERROR, call
                    assert refused(x, ERROR, call)
                assert x.save() == before
                x.free()
                tried += 1
    assert tried > 60


@pytest.mark.parametrize("kind", KINDS)
def test_empty_arrays_may_be_null(kind: int) -> None:
    x = native_fmu(two_ports).instance(kind).initialise()
    for call in ("GetReal", "SetReal", "GetInteger", "SetInteger", "GetString", "SetString", "SetBoolean"):
        x.must(call, None, 0, None)
    x.must("GetDirectionalDerivative", None, 0, None, 0, None, None)
    if kind == CO_SIMULATION:
        x.must("SetRealInputDerivatives", None, 0, None, None)
        x.must("GetRealOutputDerivatives", None, 0, None, None)
    x.free()


@pytest.mark.parametrize("wrong", ["size", 0xFFFFFFFF, 0x80000000])
def test_references_that_do_not_exist(wrong: int | str) -> None:
    x = instance_in(CO_SIMULATION, "step")
    bad = x.fmu.size if wrong == "size" else int(wrong)
    references, reals = np.array([0, bad, 1], np.uint32), np.full(3, -7.0)
    orders, integers = np.ones(3, np.int32), np.full(3, 2, np.int32)
    before = x.save()
    x.log.clear()
    for call in ("GetReal", "SetReal"):
        assert x.call(call, references, 3, reals) == ERROR
        assert refused(x, ERROR, call, str(bad))
    places = np.array([0, bad, 0], np.uint32)
    for call in ("GetInteger", "SetInteger"):
        for vr in (places, np.ones(3, np.uint32)):  # 1: of a Real, but of no Integer
            assert x.call(call, vr, 3, integers) == ERROR
            assert refused(x, ERROR, call, "value reference")
    for call in ("GetBoolean", "SetBoolean", "GetString", "SetString"):
        assert x.call(call, places, 1, integers) == ERROR
        assert refused(x, ERROR, call, "no variable of this type")
    for call in ("SetRealInputDerivatives", "GetRealOutputDerivatives"):
        assert x.call(call, references, 3, orders, reals) == ERROR
        assert refused(x, ERROR, call, "value reference")
    seed, output = np.ones(3), np.array(x.fmu.outputs[:1], np.uint32)
    assert x.call("GetDirectionalDerivative", output, 1, references, 3, seed, reals) == ERROR
    assert refused(x, ERROR, "GetDirectionalDerivative", str(bad))
    assert x.call("GetDirectionalDerivative", references, 3, references, 1, seed, reals) == ERROR
    assert refused(x, ERROR, "GetDirectionalDerivative", "value reference")
    assert x.save() == before
    np.testing.assert_array_equal(reals, -7.0)
    np.testing.assert_array_equal(integers, 2)
    x.free()


def test_derivatives_of_the_wrong_variable_or_order() -> None:
    x = instance_in(CO_SIMULATION, "step")
    before = x.save()
    x.log.clear()
    for references, orders, word in (
        ([0, x.fmu.outputs[0]], [1, 1], "expected an input"),
        ([0, 1], [1, 0], "order 0"),
        ([0, 1], [1, 3], "order 3"),
        ([0, 1], [1, -1], "order -1"),
    ):
        assert x.set_rates(references, orders, [1.0, 1.0]) == ERROR
        assert refused(x, ERROR, "SetRealInputDerivatives", word)
    for reference, order, word in (
        (0, 1, "expected an output"),
        (x.fmu.outputs[0], 0, "order 0"),
        (x.fmu.outputs[0], 3, "order 3"),
    ):
        vr, orders_, value = np.array([reference], np.uint32), np.array([order], np.int32), np.full(1, -7.0)
        assert x.call("GetRealOutputDerivatives", vr, 1, orders_, value) == ERROR
        assert refused(x, ERROR, "GetRealOutputDerivatives", word)
        assert value == [-7.0]
    assert x.save() == before
    x.free()


def test_the_last_of_several_values_counts() -> None:
    x = native_fmu(two_ports).instance().initialise()
    assert x.set_real([0, 0, 0], [1.0, 2.0, 3.0]) == OK
    assert x.get_real([0]) == [3.0]
    assert x.call("SetInteger", np.zeros(2, np.uint32), 2, np.array([1, 4], np.int32)) == OK
    assert x.get_active() == 4
    x.free()


@pytest.mark.parametrize("value", NOT_FINITE)
def test_an_input_must_be_finite_where_it_is_used(value: float) -> None:
    undisturbed, x = (native_fmu(two_ports).instance().initialise() for _ in range(2))
    for k in range(3):
        for one in (undisturbed, x):
            assert one.set({"right.force.y": 1.0 + k}) == OK
        assert x.set({"right.force.y": value}) == OK
        x.log.clear()
        assert x.step(0.1 * k, 0.1) == ERROR
        assert refused(x, ERROR, "DoStep", "right.force.y is ", "expected a finite number")
        assert x.set({"right.force.y": 1.0 + k}) == OK
        assert x.step(0.1 * k, 0.1) == undisturbed.step(0.1 * k, 0.1) == OK
        np.testing.assert_array_equal(x.reals(), undisturbed.reals())
    undisturbed.free()
    x.free()


@pytest.mark.parametrize("value", NOT_FINITE)
def test_values_that_are_not_finite(value: float) -> None:
    x = instance_in(CO_SIMULATION, "initialization")
    before = x.save()
    x.log.clear()
    for name in ("damping.alpha", "damping.beta", "modes.amplitude[2]", "modes.velocity[6]"):
        assert x.set({"left.force.x": 1.0, name: value}) == ERROR
        assert refused(x, ERROR, "SetReal", "expected a finite number")
    for order in (1, 2):
        assert x.set_rates([0, 1], [order, order], [1.0, value]) == ERROR
        assert refused(x, ERROR, "SetRealInputDerivatives", "left.force.z", "expected a finite number")
    assert x.save() == before
    x.free()
    x = instance_in(MODEL_EXCHANGE, "continuous")
    before = x.save()
    x.log.clear()
    states = x.get_states()
    states[5] = value
    assert x.set_states(states) == DISCARD
    assert refused(x, DISCARD, "SetContinuousStates", "state 6")
    assert x.call("SetTime", value) == ERROR
    assert refused(x, ERROR, "SetTime", "expected a finite number")
    assert x.save() == before
    assert x.set({"left.force.x": value}) == OK
    assert x.call("GetDerivatives", states, len(states)) == DISCARD
    assert refused(x, DISCARD, "GetDerivatives", "left.force.x")
    x.free()


@pytest.mark.parametrize("value", NOT_FINITE)
def test_a_static_start_needs_finite_inputs(value: float) -> None:
    x = native_fmu(elastic_ports, initial="static").instance()
    x.must("EnterInitializationMode")
    assert x.set({"left.force.x": value}) == OK
    before = x.save()
    x.log.clear()
    assert x.call("ExitInitializationMode") == ERROR
    assert refused(x, ERROR, "ExitInitializationMode", "finite")
    saved = x.save()
    assert x.restore(saved) == OK  # such a state can be kept, too
    assert x.save() == before == saved
    assert x.set({"left.force.x": 1.0}) == OK
    x.must("ExitInitializationMode")
    assert np.isfinite(x.reals()).all()
    x.free()


@pytest.mark.parametrize("value", [-1e-300, -1.0])
def test_negative_damping(value: float) -> None:
    x = instance_in(CO_SIMULATION, "step")
    before = x.save()
    for name in ("damping.alpha", "damping.beta"):
        assert x.set({name: value}) == ERROR
    assert x.save() == before
    x.free()


@pytest.mark.parametrize("active", [-1, 7, 2**31 - 1, -(2**31)])
def test_modes_that_are_not_there(active: int) -> None:
    x = instance_in(CO_SIMULATION, "step")
    before = x.save()
    x.log.clear()
    assert x.set_active(active) == ERROR
    assert refused(x, ERROR, "SetInteger", f"modes.active = {active}", "0 ... 6")
    assert x.save() == before
    x.free()
