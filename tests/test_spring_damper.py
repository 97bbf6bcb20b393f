"""Springs and dampers between two ports: a model without a state, run by both twins."""

import numpy as np
import pytest
from native_fmu import CO_SIMULATION, ERROR, MODEL_EXCHANGE, OK, native_fmu

from fmu_src.runtime.instance import Instance
from fmu_src.runtime.model import ReducedModel
from precompute.spring_damper import spring_damper


def mount() -> ReducedModel:
    return spring_damper("mount", {"x": 500.0, "z": 0.0, "rz": 7.0}, {"x": 3.0, "ry": 0.5})


MOTION = {
    "a.displacement.x": 0.25,
    "a.rotation.z": -0.5,
    "a.velocity.x": 2.0,
    "a.angular_velocity.y": 4.0,
    "b.displacement.x": -0.25,
    "b.rotation.z": 0.5,
    "b.velocity.x": 1.0,
    "b.angular_velocity.y": 1.0,
}
FORCES = {
    "a.force.x": -500.0 * 0.5 - 3.0 * 1.0,
    "a.moment.y": -0.5 * 3.0,
    "a.moment.z": 7.0 * 1.0,
    "b.force.x": 500.0 * 0.5 + 3.0 * 1.0,
    "b.moment.y": 0.5 * 3.0,
    "b.moment.z": -7.0 * 1.0,
}


def test_variables() -> None:
    """Those that a number > 0 asks for, and no others."""
    assert set(mount().inputs) == set(MOTION)
    assert set(mount().outputs) == set(FORCES)
    assert len(mount().lam) == 0


@pytest.mark.parametrize("kind", [CO_SIMULATION, MODEL_EXCHANGE], ids=["co-simulation", "model exchange"])
def test_forces_of_the_native_twin(kind: int) -> None:
    """At once, before and after a step; exact, as the numbers are."""
    fmu = native_fmu(mount)
    one = fmu.instance(kind).initialise(MOTION)
    assert one.get(*FORCES).tolist() == [*FORCES.values()]
    assert one.set({"a.displacement.x": -0.25}) == OK
    assert one.get("a.force.x", "b.force.x").tolist() == [-3.0, 3.0]
    if kind == CO_SIMULATION:
        assert one.step(0.0, 0.1) == OK
        assert one.get("a.force.x", "b.force.x").tolist() == [-3.0, 3.0]
    one.free()


def test_forces_follow_input_derivatives() -> None:
    """Outputs are those of the end of the step: −k (x + ẋ h)."""
    fmu = native_fmu(mount)
    one = fmu.instance().initialise({"a.displacement.x": 0.5})
    assert one.set_rates([fmu.reference["a.displacement.x"]], [1], [2.0]) == OK
    assert one.step(0.0, 0.25) == OK
    assert one.get("a.force.x").tolist() == [-500.0 * (0.5 + 2.0 * 0.25)]
    assert one.get_rates([fmu.reference["a.force.x"]], [1]).tolist() == [-500.0 * 2.0]
    one.free()


def test_directional_derivatives_and_states() -> None:
    """∂f/∂x = −k; a state that is saved comes back, though there is no q."""
    fmu = native_fmu(mount)
    one = fmu.instance().initialise(MOTION)
    unknowns = [fmu.reference["a.force.x"], fmu.reference["b.force.x"]]
    assert one.directional(unknowns, [fmu.reference["a.displacement.x"]], [1.0]).tolist() == [-500.0, 500.0]
    saved = one.save()
    assert one.set({"a.displacement.x": 9.0}) == OK
    assert one.restore(saved) == OK
    assert one.get(*FORCES).tolist() == [*FORCES.values()]
    assert one.call("Reset") == OK
    one.initialise()
    assert not one.get(*FORCES).any()
    one.free()


@pytest.mark.parametrize(
    "call", ["GetContinuousStates", "SetContinuousStates", "GetDerivatives", "GetNominalsOfContinuousStates"]
)
def test_no_array_of_no_states(call: str) -> None:
    """malloc(0) may be NULL, and a tool may pass it on; with a number of states it is wrong."""
    one = native_fmu(mount).instance(MODEL_EXCHANGE).initialise(MOTION)
    one.must("EnterContinuousTimeMode")
    assert one.call(call, None, 0) == OK
    assert one.call(call, None, 1) == ERROR
    one.free()


def test_python_twin() -> None:
    model = mount()
    one = Instance(model)
    one.set_inputs(slice(None), [MOTION[name] for name in model.inputs])
    assert one.advance(0.0, 0.1) is None
    found = dict(zip(model.outputs, one.reals()[one.layout.outputs].tolist(), strict=True))
    assert found == FORCES


def test_power_is_what_the_damper_takes() -> None:
    """f_a·v_a + f_b·v_b = −c (v_a − v_b)² for a damper alone, and never above 0."""
    R = spring_damper("d", {}, {"x": 3.0}).R
    rng = np.random.default_rng(1)
    for v in rng.standard_normal((20, 2)):
        assert v @ R @ v == pytest.approx(-3.0 * (v[0] - v[1]) ** 2, rel=1e-12)
