"""ModelStructure: exactly the declared dependencies exist, found by perturbing every known."""

from itertools import pairwise
from xml.etree import ElementTree as ET

import numpy as np
import pytest
from examples import oscillator, two_ports

from fmu_src.description import default_experiment, model_description
from fmu_src.runtime.instance import Instance
from fmu_src.runtime.model import ReducedModel
from fmu_src.runtime.step import State
from fmu_src.runtime.variables import variables


def sparse_model(initial: str) -> ReducedModel:
    """Symmetric parts have exact zeros in B and C; a structure must follow them."""
    lam = np.array([3.0, 7.0, 30.0, 30.0, 400.0, 9000.0])
    if initial == "rest":
        lam[:2] = 0.0
    full = two_ports()
    B, C = full.B.copy(), full.C.copy()
    B[[0, 3], 0] = B[2, :] = C[1, 3:] = C[2, :2] = C[3, 4] = 0.0
    return two_ports(lam=lam, B=B, C=C, initial=initial)


def declared(model: ReducedModel, group: str) -> dict[int, set[int]]:
    xml = model_description(model, guid="{x}", generation_tool="test", capabilities={})
    unknowns = ET.fromstring(xml).findall(f"ModelStructure/{group}/Unknown")
    return {
        int(u.attrib["index"]) - 1: {int(i) - 1 for i in u.attrib["dependencies"].split()} for u in unknowns
    }


def random_instance(model: ReducedModel, *, initialising: bool) -> Instance:
    rng = np.random.default_rng(5)
    r = len(model.lam)
    instance = Instance(model)
    instance.set_inputs(range(3), rng.standard_normal(3).tolist())
    instance.state = State(rng.standard_normal(r), rng.standard_normal(r))
    if not initialising:
        instance.reals()
        instance.initialising = False
        instance.state = State(rng.standard_normal(r), rng.standard_normal(r))
        instance.set_damping(model.alpha, model.beta)
    return instance


def perturb(instance: Instance, known: int) -> None:
    """Change one known of the model by a tenth."""
    place, reals = instance.layout, instance.reals().copy()
    if known < place.inputs.stop:
        instance.set_inputs([known], [reals[known] + 0.1])
    elif known == place.alpha:
        instance.set_damping(instance.alpha + 0.1, instance.beta)
    elif known == place.beta:
        instance.set_damping(instance.alpha, instance.beta + 0.1)
    elif known == place.size:
        instance.set_active(0)
    else:
        instance.set_state([known], [reals[known] + 0.1])


def moved(model: ReducedModel, knowns: list[int], *, initialising: bool) -> dict[int, set[int]]:
    """The knowns that each Real truly depends on."""
    found: dict[int, set[int]] = {}
    for known in knowns:
        instance = random_instance(model, initialising=initialising)
        before = instance.reals().copy()
        perturb(instance, known)
        for unknown in np.flatnonzero(instance.reals() != before):
            found.setdefault(int(unknown), set()).add(known)
    return found


@pytest.mark.parametrize("initial", ["rest", "static"])
def test_running_dependencies(initial: str) -> None:
    model = sparse_model(initial)
    place = Instance(model).layout
    knowns = [*range(3), *range(place.q.start, place.v.stop)]
    true = moved(model, knowns, initialising=False)
    for group in ("Outputs", "Derivatives"):
        for unknown, dependencies in declared(model, group).items():
            assert dependencies == true.get(unknown, set()), variables(model)[unknown].name


@pytest.mark.parametrize("initial", ["rest", "static"])
def test_initial_dependencies(initial: str) -> None:
    model = sparse_model(initial)
    place = Instance(model).layout
    states = range(place.v.start if initial == "static" else place.q.start, place.v.stop)
    knowns = [*range(3), place.alpha, place.beta, *states, place.size]
    true = moved(model, knowns, initialising=True)
    for unknown, dependencies in declared(model, "InitialUnknowns").items():
        assert dependencies == true.get(unknown, set()), variables(model)[unknown].name


def test_every_calculated_variable_is_an_initial_unknown() -> None:
    model = two_ports()
    calculated = {i for i, v in enumerate(variables(model)) if v.initial == "calculated"}
    assert set(declared(model, "InitialUnknowns")) == calculated


def test_default_experiment_resolves_the_highest_mode() -> None:
    for model in (two_ports(), oscillator(stiffness=4e9), oscillator(stiffness=1e-5)):
        stop, step = default_experiment(model)
        f = model.frequency[model.lam > 0]
        assert 1 / (50 * f[-1]) <= step <= 1 / (20 * f[-1])  # 1, 2, 5: neighbours differ by at most 2.5
        assert 10 / f[0] <= stop <= 25 / f[0]
    rigid = oscillator(stiffness=0.0)
    assert default_experiment(rigid) == (1.0, 1e-3)


def test_nominals_are_usable() -> None:
    for variable in variables(two_ports()):
        if variable.nominal is not None:
            assert 0 < variable.nominal < np.inf


def test_names_are_unique_and_in_the_order_of_the_layout() -> None:
    model = two_ports()
    listed, place = variables(model), Instance(model).layout
    assert len({v.name for v in listed}) == len(listed)
    assert [v.name for v in listed[place.inputs]] == list(model.inputs)
    assert [v.name for v in listed[place.outputs]] == list(model.outputs)
    assert listed[place.alpha].name == "damping.alpha"
    assert listed[place.v_dot.start].name == "der(modes.velocity[1])"
    starts = [s.start for s in (place.inputs, place.outputs, place.frequency, place.q, place.v, place.q_dot)]
    assert all(a < b for a, b in pairwise(starts))
