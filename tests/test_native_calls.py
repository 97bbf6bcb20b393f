"""Which call is legal when: the tables of FMI 2.0.4, sections 3.2.3 and 4.2.4, call by call."""

import ctypes

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
    native_fmu,
)
from native_modes import MODES, elastic_ports, good_arguments, instance_in

# one column for each of MODES: x where the call is legal, - where it is not
COMMON = """
SetDebugLogging               x x x x x
SetupExperiment               x - - - -
EnterInitializationMode       x - - - -
ExitInitializationMode        - x - - -
Terminate                     - - x x -
Reset                         x x x x x
GetReal                       - x x x x
GetInteger                    - x x x x
GetBoolean                    - x x x x
GetString                     - x x x x
GetFMUstate                   x x x x x
SetFMUstate                   x x x x x
FreeFMUstate                  x x x x x
SerializedFMUstateSize        x x x x x
SerializeFMUstate             x x x x x
DeSerializeFMUstate           x x x x x
GetDirectionalDerivative      - x x x x
"""
TABLES = {
    MODEL_EXCHANGE: COMMON
    + """
SetReal                       x x x x -
SetInteger                    x x x - -
SetBoolean                    x x x - -
SetString                     x x x - -
EnterEventMode                - - x x -
NewDiscreteStates             - - x - -
EnterContinuousTimeMode       - - x - -
CompletedIntegratorStep       - - - x -
SetTime                       - - - x -
SetContinuousStates           - - - x -
GetDerivatives                - x x x x
GetEventIndicators            - x x x x
GetContinuousStates           - x x x x
GetNominalsOfContinuousStates x x x x x
""",
    CO_SIMULATION: COMMON
    + """
SetReal                       x x x - -
SetInteger                    x x x - -
SetBoolean                    x x x - -
SetString                     x x x - -
SetRealInputDerivatives       x x x - -
GetRealOutputDerivatives      - - x x x
DoStep                        - - x - -
GetStatus                     - - x x x
GetRealStatus                 - - x x x
GetIntegerStatus              - - x x x
GetBooleanStatus              - - x x x
GetStringStatus               - - x x x
""",
}
# where this FMU takes more than the table does
WIDER = {
    # FMI 2.0 … 2.0.3 have it in event mode, and masters use it there
    ("SetTime", "event"),
    # a step that was not made has changed nothing: no state need be restored before the next try
    *((call, "failed step") for call in ("SetReal", "SetInteger", "SetBoolean", "SetString")),
    ("SetRealInputDerivatives", "failed step"),
    ("DoStep", "failed step"),
}
WORDS = {
    "instantiated": "before fmi2EnterInitializationMode",
    "initialization": "in initialization mode",
    "event": "in event mode",
    "continuous": "in continuous-time mode",
    "step": "between the steps",
    "failed step": "between the steps",
    "terminated": "after fmi2Terminate",
}


def legal(kind: int, call: str, mode: str) -> bool:
    rows = {line.split()[0]: line.split()[1:] for line in TABLES[kind].split("\n") if line}
    return (call, mode) in WIDER or (call in rows and rows[call][MODES[kind].index(mode)] == "x")


@pytest.mark.parametrize("call", CALLS)
@pytest.mark.parametrize(("kind", "mode"), [(kind, mode) for kind in MODES for mode in MODES[kind]])
def test_every_call_in_every_mode(kind: int, mode: str, call: str) -> None:
    x = instance_in(kind, mode)
    arguments, before = good_arguments(x, call), x.save()
    x.log.clear()
    status = x.call(call, *arguments)
    if legal(kind, call, mode):
        # no status of a step is an integer
        assert status == (DISCARD if call == "GetIntegerStatus" else OK), x.log
    else:
        assert status == ERROR
        (message,) = x.log
        assert message.status == ERROR
        assert message.category == "logStatusError"
        both = legal_somewhere(kind, call)
        use = "in model exchange" if kind == MODEL_EXCHANGE else "in a co-simulation"
        assert f"fmi2{call}: not legal {WORDS[mode] if both else use}" in message.text
        assert x.save() == before
    x.free()


def legal_somewhere(kind: int, call: str) -> bool:
    # no step is asynchronous, so none can be cancelled, though it is a call of co-simulation
    return call in TABLES[kind] or (call == "CancelStep" and kind == CO_SIMULATION)


@pytest.mark.parametrize("call", CALLS)
def test_no_call_takes_no_component(call: str) -> None:
    fmu = native_fmu(two_ports)
    x = fmu.instance()
    arguments = good_arguments(x, call)
    assert fmu.call(call, None, *arguments) == ERROR
    x.free()


def test_functions_that_need_no_component() -> None:
    library = native_fmu(two_ports).library
    for function, text in (("fmi2GetVersion", b"2.0"), ("fmi2GetTypesPlatform", b"default")):
        getattr(library, function).restype = ctypes.c_char_p
        assert getattr(library, function)() == text
    library.fmi2FreeInstance(None)


SETTABLE = {
    # rule 1 leaves the inputs out; masters set their start values here nevertheless
    "instantiated": ("input", "parameter", "state"),
    "initialization": ("input", "parameter", "state"),
    "event": ("input", "parameter"),
    "step": ("input", "parameter"),
    "continuous": ("input", "state"),
    "terminated": (),
}


@pytest.mark.parametrize("initial", ["rest", "static"])
@pytest.mark.parametrize(
    ("kind", "mode"), [(kind, mode) for kind in MODES for mode in MODES[kind] if mode != "failed step"]
)
def test_which_variables_can_be_set(kind: int, mode: str, initial: str) -> None:
    """The conditions 1, 3, 4, 5 and 6 of the tables."""
    fmu = native_fmu(elastic_ports, initial=initial)
    names = {name: reference for name, reference in fmu.reference.items() if name != "modes.active"}
    x = fmu.instance(kind)
    if mode != "instantiated":
        x.must("EnterInitializationMode")
    if mode not in ("instantiated", "initialization"):
        x.must("ExitInitializationMode")
    if mode == "continuous":
        x.must("EnterContinuousTimeMode")
    elif mode == "terminated":
        x.must("Terminate")
    for name, reference in names.items():
        group = (
            "input"
            if reference in fmu.inputs
            else "parameter"
            if name in ("damping.alpha", "damping.beta")
            else "state"
            if name.startswith(("modes.amplitude", "modes.velocity"))
            else "calculated"
        )
        expected = group in SETTABLE[mode]
        if initial == "static" and name.startswith("modes.amplitude"):
            expected = mode == "continuous"  # calculated at the start
        before = x.save()
        assert x.set({name: 0.25}) == (OK if expected else ERROR), name
        if expected and mode != "instantiated":
            assert x.get(name) == [0.25]
        elif not expected:
            assert x.save() == before
    active = mode not in ("continuous", "terminated")
    assert x.set_active(1) == (OK if active else ERROR)
    x.free()


@pytest.mark.parametrize("kind", [MODEL_EXCHANGE, CO_SIMULATION])
def test_everything_can_be_read_from_initialization_on(kind: int) -> None:
    for mode in MODES[kind][1:]:
        x = instance_in(kind, mode)
        assert np.isfinite(x.reals()).all()
        assert x.get_active() == x.fmu.modes
        x.free()


@pytest.mark.parametrize("kind", [MODEL_EXCHANGE, CO_SIMULATION])
def test_a_run_goes_on_after_refused_calls(kind: int) -> None:
    """What a refused call leaves is not only equal, it also runs on alike."""
    runs = []
    for refuse in (False, True):
        x = native_fmu(two_ports).instance(kind).initialise({"left.force.x": 2.0})
        if kind == MODEL_EXCHANGE:
            x.must("EnterContinuousTimeMode")
        for k in range(5):
            if refuse:
                for call in CALLS:
                    if not legal(kind, call, "step" if kind == CO_SIMULATION else "continuous"):
                        assert x.call(call, *good_arguments(x, call)) == ERROR
            if kind == CO_SIMULATION:
                assert x.step(0.1 * k, 0.1) == OK
            else:
                assert x.set_states(x.get_states() + 0.1 * x.get_states("GetDerivatives")) == OK
        runs.append(x.reals())
        x.free()
    np.testing.assert_array_equal(runs[0], runs[1])
    assert runs[0].any()


def test_status_of_the_last_step() -> None:
    x = native_fmu(two_ports).instance().initialise()
    status, done, time, text = ctypes.c_int(-7), ctypes.c_int(-7), np.zeros(1), ctypes.c_char_p()
    for h, force, expected, end in ((0.1, 1.0, OK, 0.1), (1e6, 1e308, DISCARD, 0.1), (-1.0, 0.0, ERROR, 0.1)):
        assert x.set({"left.force.x": force}) == OK
        assert x.step(0.1 if expected != OK else 0.0, h) == expected
        x.must("GetStatus", 0, ctypes.byref(status))
        x.must("GetRealStatus", 2, time)
        x.must("GetBooleanStatus", 3, ctypes.byref(done))
        x.must("GetStringStatus", 1, ctypes.byref(text))
        assert (status.value, time[0], done.value, text.value) == (expected, end, 0, b"")
    assert x.step(0.1, 0.1) == OK  # and the run goes on
    x.must("GetStatus", 0, ctypes.byref(status))
    x.must("GetRealStatus", 2, time)
    assert (status.value, time[0]) == (OK, 0.2)
    x.free()


@pytest.mark.parametrize(
    ("call", "kinds"),
    [
        ("GetStatus", (1, 2, 3, 4, -1)),
        ("GetRealStatus", (0, 1, 3, 4, -1)),
        ("GetIntegerStatus", (0, 1, 2, 3, 4, -1)),
        ("GetBooleanStatus", (0, 1, 2, 4, -1)),
        ("GetStringStatus", (0, 2, 3, 4, -1)),
    ],
)
def test_a_status_that_has_no_such_value_is_discarded(call: str, kinds: tuple[int, ...]) -> None:
    x = native_fmu(two_ports).instance().initialise()
    value = np.full(2, -7.0)
    for kind in kinds:
        x.log.clear()
        assert x.call(call, kind, value) == DISCARD
        assert x.log[0].category == "logStatusDiscard"
    np.testing.assert_array_equal(value, -7.0)
    x.free()


def test_events_of_model_exchange() -> None:
    """No event is ever asked for, but switching moving modes off changes states, once."""
    x = native_fmu(two_ports).instance(MODEL_EXCHANGE).initialise({"modes.velocity[6]": 1.0})
    never = ("new_discrete_states_needed", "terminate", "nominals_changed", "next_event_defined")

    def changed() -> bool:
        info = x.new_discrete_states()
        assert [getattr(info, name) for name in never] == [0, 0, 0, 0]
        return bool(info.states_changed)

    assert not changed()
    assert x.set_active(5) == OK
    assert changed()
    assert not changed()
    assert x.get_states()[11] == 0.0
    assert x.set_active(3) == OK
    assert not changed()  # these were at rest
    assert x.set_active(6) == OK
    assert not changed()
    x.must("EnterContinuousTimeMode")
    event, end = np.full(1, -7, np.int32), np.full(1, -7, np.int32)
    x.must("CompletedIntegratorStep", 1, event, end)
    assert (event[0], end[0]) == (0, 0)
    x.must("EnterEventMode")
    assert not changed()
    x.free()
