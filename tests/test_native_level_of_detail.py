"""modes.active of the native FMU: modes off and on again, over several registers, in every use."""

import ctypes

import numpy as np
import pytest
from examples import oscillator, two_ports
from native_fmu import CO_SIMULATION, DISCARD, MODEL_EXCHANGE, OK, native_fmu
from native_modes import elastic_ports

from fmu_src.runtime.instance import Instance as Twin
from fmu_src.runtime.model import Port, ReducedModel

R = 20  # three registers of eight


def many_modes(*, coupled: bool = False) -> ReducedModel:
    """Coupled: three in four modes by two dashpots, and modes that are off follow statically."""
    rng = np.random.default_rng(20)
    ports = (Port("tip", ("force.x", "force.y"), ("displacement.x", "velocity.y", "acceleration.z")),)
    w = rng.standard_normal((R, 2)) * coupled
    w[2::4] = 0.0
    return ReducedModel(
        name="many_modes",
        description="",
        lam=np.sort(rng.uniform(1.0, 1e4, R)),
        alpha=0.2,
        beta=1e-4,
        D_rest=np.diag(rng.uniform(0.0, 0.1, R)) + w @ w.T,
        B=rng.standard_normal((R, 2)),
        C=rng.standard_normal((3, R)),
        R=np.zeros((3, 2)),
        R_in=np.zeros((2, 2)),
        ports=ports,
        residual=coupled,
    )


@pytest.mark.parametrize("coupled", [False, True])
def test_any_number_of_modes_as_the_twin(coupled: bool) -> None:
    """Down and up through all registers between steps of three sizes."""
    model, rng, t = many_modes(coupled=coupled), np.random.default_rng(1), 0.0
    x, twin = native_fmu(many_modes, coupled=coupled).instance().initialise(), Twin(model)
    twin.initialising = False
    seen, difference = np.zeros(x.fmu.size), np.zeros(x.fmu.size)
    for k in range(600):
        if k % 3 == 0:
            active = int(rng.integers(0, R + 1))
            assert x.set_active(active) == OK
            twin.set_active(active)
        u, h = rng.standard_normal(2), float(rng.choice([1e-3, 0.01, 0.3]))
        assert x.set_real([0, 1], u) == OK
        twin.set_inputs([0, 1], u)
        assert x.step(t, h) == OK
        assert twin.advance(t, h) is None
        t += h
        difference = np.maximum(difference, np.abs(x.reals() - twin.reals()))
        seen = np.maximum(seen, np.abs(twin.reals()))
    assert (seen > 0).all()
    assert (difference <= 1e-12 * seen).all()  # a few roundings a step, and damping forgets the earlier ones
    x.free()


def test_a_static_start_with_other_modes() -> None:
    """q = f/λ of the modes that are active, again after some were off, all during initialisation."""
    x = native_fmu(elastic_ports, initial="static").instance()
    x.must("EnterInitializationMode")
    assert x.set({"left.force.x": 2.0}) == OK
    q = [f"modes.amplitude[{i}]" for i in range(1, 7)]
    whole = x.get(*q)
    assert (whole != 0.0).all()
    assert x.set_active(3) == OK
    np.testing.assert_array_equal(x.get(*q), [*whole[:3], 0, 0, 0])
    assert x.set_active(6) == OK
    np.testing.assert_array_equal(x.get(*q), whole)
    x.free()


@pytest.mark.parametrize("looked_at", [False, True])
def test_nothing_jumps_during_initialisation(looked_at: bool) -> None:
    x = native_fmu(elastic_ports, initial="static").instance(MODEL_EXCHANGE)
    x.must("EnterInitializationMode")
    assert x.set({"left.force.x": 2.0}) == OK
    if looked_at:
        x.reals()
    assert x.set_active(3) == OK
    x.must("ExitInitializationMode")
    assert x.new_discrete_states().states_changed == 0
    x.free()


def test_a_jump_stays_one_until_it_is_told() -> None:
    x = native_fmu(two_ports).instance(MODEL_EXCHANGE).initialise({"modes.amplitude[5]": 1.0})
    assert x.set_active(3) == OK
    assert x.set_active(6) == OK
    assert x.new_discrete_states().states_changed == 1
    assert x.new_discrete_states().states_changed == 0
    x.free()


def test_a_saved_state_of_modes_that_are_off() -> None:
    """What stands behind modes.active in a damaged state does not come back with the modes."""
    x = native_fmu(two_ports).instance().initialise({f"modes.amplitude[{i}]": 1.0 for i in range(1, 7)})
    moving = x.save()
    assert x.set_active(3) == OK
    still = bytearray(x.save())
    places = [k for k in range(0, len(still), 8) if still[k : k + 8] != moving[k : k + 8]]
    assert len(places) == 4  # modes.active and three amplitudes
    for place in places[1:]:
        still[place : place + 8] = moving[place : place + 8]
    assert x.restore(bytes(still)) == OK
    assert x.set_active(6) == OK
    assert x.get(*(f"modes.amplitude[{i}]" for i in range(1, 7))).tolist() == [1, 1, 1, 0, 0, 0]
    x.free()


def beyond() -> ReducedModel:
    lam = np.array([1.0, 2.0, 3.0, 1e290])
    one = np.ones((4, 1))
    ports = (Port("tip", ("force.x",), ("displacement.x",)),)
    return oscillator("beyond", lam=lam, D_rest=np.zeros((4, 4)), B=one, C=one.T, ports=ports)


def test_a_mode_that_is_off_hinders_no_step() -> None:
    """λh² of the last mode is beyond the numbers; it shares a register with the others."""
    x = native_fmu(beyond).instance(CO_SIMULATION).initialise()
    assert x.step(0.0, 1e6) == DISCARD
    assert x.set_active(3) == OK
    assert x.step(0.0, 1e6) == OK
    x.free()


def test_derivatives_beyond_the_numbers() -> None:
    """−λq of the last mode; the values that were there are left alone."""
    x = native_fmu(two_ports).instance(MODEL_EXCHANGE).initialise()
    x.must("EnterContinuousTimeMode")
    states = np.zeros(12)
    states[5] = 1e306
    assert x.set_states(states) == OK
    found = np.full(12, -7.0)
    assert x.call("GetDerivatives", found, 12) == DISCARD
    assert (found == -7.0).all()
    assert "modes.velocity[6]" in x.log[-1].text
    x.free()


def light() -> ReducedModel:
    return oscillator("light", B=np.full((1, 1), 1e-200))


def test_nominals_of_a_force_that_is_next_to_nothing() -> None:
    """The description and the library take 1 where |B| is no usable number."""
    x = native_fmu(light).instance(MODEL_EXCHANGE).initialise()
    assert x.get_states("GetNominalsOfContinuousStates").tolist() == [1.0, 1.0]
    own = {v.name: v for v in x.fmu.description.modelVariables}
    assert float(own["modes.amplitude[1]"].nominal) == 1.0
    x.free()


def test_the_state_of_a_larger_part() -> None:
    """A handle of another FMU is refused by every call that takes one, and not read beyond its end."""
    x, other = native_fmu(many_modes).instance(), native_fmu(two_ports).instance()
    state, size, room = ctypes.c_void_p(), ctypes.c_size_t(7), ctypes.create_string_buffer(10000)
    other.must("GetFMUstate", ctypes.byref(state))
    before = other.save()
    assert x.call("SerializedFMUstateSize", state, ctypes.byref(size)) != OK
    assert size.value == 7
    assert x.call("SerializeFMUstate", state, room, len(room)) != OK
    assert x.call("GetFMUstate", ctypes.byref(state)) != OK
    assert x.call("DeSerializeFMUstate", x.save(), len(x.save()), ctypes.byref(state)) != OK
    other.must("SetFMUstate", state)
    assert other.save() == before
    other.must("FreeFMUstate", ctypes.byref(state))
    x.free()
    other.free()
