"""ModelStructure: exactly the declared dependencies exist, found by perturbing every known."""

from itertools import pairwise
from xml.etree import ElementTree as ET

import numpy as np
import pytest
from driven import part, reduced
from examples import oscillator, two_ports

from fmu_src.description import Twin, default_experiment, model_description
from fmu_src.runtime.instance import Instance
from fmu_src.runtime.model import ReducedModel
from fmu_src.runtime.step import State
from fmu_src.runtime.variables import layout, variables
from fmu_src.structure import structure


def sparse_model(initial: str) -> ReducedModel:
    """Symmetric parts have exact zeros in B and C; a structure must follow them."""
    lam = np.array([3.0, 7.0, 30.0, 30.0, 400.0, 9000.0])
    if initial == "rest":
        lam[:2] = 0.0
    full = two_ports()
    B, C = full.B.copy(), full.C.copy()
    B[[0, 3], 0] = B[2, :] = C[1, 3:] = C[2, :2] = C[3, 4] = 0.0
    return two_ports(lam=lam, B=B, C=C, initial=initial)


def declared(model: ReducedModel, group: str, derivatives: str = "true") -> dict[int, set[int]]:
    faces = {"CoSimulation": {"providesDirectionalDerivative": derivatives}}
    xml = model_description(model, Twin("test", faces, {}), "{x}")
    unknowns = ET.fromstring(xml).findall(f"ModelStructure/{group}/Unknown")
    return {
        int(u.attrib["index"]) - 1: {int(i) - 1 for i in u.attrib["dependencies"].split()} for u in unknowns
    }


def random_instance(model: ReducedModel, *, initialising: bool) -> Instance:
    rng = np.random.default_rng(5)
    r = len(model.lam)
    instance = Instance(model)
    if not initialising:
        instance.initialising = False
    instance.state = State(rng.standard_normal(r), rng.standard_normal(r))
    instance.set_inputs([0, 1, 2], rng.standard_normal(3))  # a static start settles here
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
        instance.set_state({known: reals[known] + 0.1})


def moved(model: ReducedModel, knowns: list[int], *, initialising: bool) -> dict[int, set[int]]:
    """The knowns that each Real truly depends on."""
    found: dict[int, set[int]] = {}
    for known in knowns:
        instance = random_instance(model, initialising=initialising)
        before = instance.reals().copy()
        perturb(instance, known)
        # forces that cancel in equilibrium leave roundings of their size, 9000 q at the largest
        for unknown in np.flatnonzero(np.abs(instance.reals() - before) > 1e-11):
            found.setdefault(int(unknown), set()).add(known)
    return found


@pytest.mark.parametrize("initial", ["rest", "static"])
def test_running_dependencies(initial: str) -> None:
    model = sparse_model(initial)
    place = Instance(model).layout
    knowns = [*range(3), *range(place.q.start, place.v.stop)]
    true = moved(model, knowns, initialising=False)
    for group, places in (("Outputs", place.outputs), ("Derivatives", slice(place.q_dot.start, place.size))):
        found = declared(model, group)
        assert list(found) == list(range(places.start, places.stop))
        for unknown, dependencies in found.items():
            assert dependencies == true.get(unknown, set()), variables(model)[unknown].name


@pytest.mark.parametrize("initial", ["rest", "static"])
def test_initial_dependencies(initial: str) -> None:
    model = sparse_model(initial)
    place = Instance(model).layout
    states = range(place.v.start if initial == "static" else place.q.start, place.v.stop)
    knowns = [*range(3), place.alpha, place.beta, *states, place.size]
    true = moved(model, knowns, initialising=True)
    found = declared(model, "InitialUnknowns")
    assert list(found) == [i for i, v in enumerate(variables(model)) if v.initial == "calculated"]
    for unknown, dependencies in found.items():
        assert dependencies == true.get(unknown, set()), variables(model)[unknown].name


Row = tuple[str, str, str | None, str | None, float | None, float | None, float | None]


def test_states_are_no_knowns_where_the_fmu_gives_no_derivatives() -> None:
    """FMI 2.0.4, 2.2.8: co-simulation without providesDirectionalDerivative; inputs stay, and all else."""
    model = sparse_model("rest")
    place = layout(model)
    states = {*range(place.q.start, place.q.stop), *range(place.v.start, place.v.stop)}
    full, without = declared(model, "Outputs"), declared(model, "Outputs", "false")
    assert any(known & states for known in full.values())
    assert without == {output: known - states for output, known in full.items()}
    for group in ("Derivatives", "InitialUnknowns"):
        assert declared(model, group, "false") == declared(model, group)


def expected_face(name: str, r: int) -> Row:
    """causality, variability, initial, unit, start, min, max, as the table of variables promises."""
    units = {"force": "N", "displacement": "m", "velocity": "m/s", "acceleration": "m/s2"}
    if name.startswith("damping."):
        start, unit = {"alpha": (0.3, "1/s"), "beta": (1e-3, "s")}[name.split(".")[1]]
        return "parameter", "tunable", "exact", unit, start, 0.0, None
    if name == "modes.active":
        return "parameter", "tunable", "exact", None, r, 0, r
    if name.startswith("modes.frequency"):
        f = [0.0, 0.0, 30**0.5, 30**0.5, 20.0, 9000**0.5][int(name[-2]) - 1] / (2 * np.pi)
        return "local", "constant", "exact", "Hz", pytest.approx(f, rel=1e-15), None, None
    if name.startswith("modes.damping_ratio"):
        return "calculatedParameter", "tunable", "calculated", None, None, None, None
    if name.startswith("modes."):
        return "local", "continuous", "exact", None, 0.0, None, None
    if name.startswith("der("):
        return "local", "continuous", "calculated", None, None, None, None
    kind = name.split(".")[1]
    if kind == "force":
        return "input", "continuous", None, "N", 0.0, None, None
    return "output", "continuous", "calculated", units[kind], None, None, None


def test_every_variable_is_declared_as_promised() -> None:
    model = two_ports()
    interfaces = {"ModelExchange": {}, "CoSimulation": {"canBeTrue": "true"}}
    xml = model_description(model, Twin("test", interfaces, {"logAll": "all"}, ("one.c", "two.c")), "{x}")
    root = ET.fromstring(xml)
    listed = root.findall("ModelVariables/ScalarVariable")
    names = [v.attrib["name"] for v in listed]
    references = []
    for variable in listed:
        number = variable[0]

        def value(key: str, number: ET.Element = number) -> float | None:
            return float(number.attrib[key]) if key in number.attrib else None

        name = variable.attrib["name"]
        found = (
            variable.attrib["causality"],
            variable.attrib["variability"],
            variable.attrib.get("initial"),
            number.attrib.get("unit"),
            value("start"),
            value("min"),
            value("max"),
        )
        assert found == expected_face(name, 6), name
        if name.startswith("der("):
            assert names[int(number.attrib["derivative"]) - 1] == name[4:-1]
        nominal = value("nominal")
        assert (nominal is None) != name.startswith(("modes.amplitude", "modes.velocity"))
        references.append((number.tag, int(variable.attrib["valueReference"])))
    assert references == [("Real", i) for i in range(len(listed) - 1)] + [("Integer", 0)]
    exponents = {u.attrib["name"]: dict(u[0].attrib) for u in root.findall("UnitDefinitions/Unit")}
    assert exponents == {
        "1/s": {"s": "-1"},
        "Hz": {"s": "-1"},
        "N": {"kg": "1", "m": "1", "s": "-2"},
        "m": {"m": "1"},
        "m/s": {"m": "1", "s": "-1"},
        "m/s2": {"m": "1", "s": "-2"},
        "s": {"s": "1"},
    }
    assert [element.tag for element in root][:2] == ["ModelExchange", "CoSimulation"]  # the schema's order
    assert root[0].attrib == {"modelIdentifier": "two_ports"}
    assert root[1].attrib == {"modelIdentifier": "two_ports", "canBeTrue": "true"}
    for interface in root[:2]:
        assert [file.attrib["name"] for file in interface.findall("SourceFiles/File")] == ["one.c", "two.c"]
    assert [c.attrib for c in root.findall("LogCategories/Category")] == [
        {"name": "logAll", "description": "all"}
    ]
    assert root.attrib["variableNamingConvention"] == "structured"
    experiment = root.find("DefaultExperiment").attrib  # type: ignore[union-attr]  # there is one
    assert [float(experiment[k]) for k in ("startTime", "stopTime", "stepSize")] == [
        0,
        *default_experiment(model),
    ]


@pytest.mark.parametrize("initial", ["rest", "static"])
def test_prescribed_motions_have_starts_and_states(initial: str) -> None:
    """As the contract of their variables says: names, units, and what a state starts from."""
    model = reduced(part(k=2), initial=initial)
    listed, place = variables(model), layout(model)
    found = [(v.name, v.unit, v.causality, v.variability, v.initial, v.start) for v in listed]
    fixed = ("parameter", "fixed", "exact", 0.0)
    assert found[place.start] == [
        ("left.start_displacement.y", "m", *fixed),
        ("left.start_rotation.z", "rad", *fixed),
        ("left.start_velocity.y", "m/s", *fixed),
        ("left.start_angular_velocity.z", "rad/s", *fixed),
    ]
    follows = ("local", "continuous", "calculated", None)
    assert found[place.q][:2] == [
        ("left.prescribed_displacement.y", "m", *follows),
        ("left.prescribed_rotation.z", "rad", *follows),
    ]
    assert found[place.v][:2] == [
        ("left.prescribed_velocity.y", "m/s", *follows),
        ("left.prescribed_angular_velocity.z", "rad/s", *follows),
    ]
    rates = [(v.name, v.unit, listed[v.derivative].name) for v in listed if v.derivative is not None]
    assert [name for name, _, _ in rates] == [f"der({state})" for _, _, state in rates]
    assert [unit for _, unit, _ in rates if unit] == ["m/s", "rad/s", "m/s2", "rad/s2"]
    assert listed[place.q.start + 2].name == "modes.amplitude[1]"
    assert listed[place.frequency.start].start == pytest.approx(model.lam[2] ** 0.5 / (2 * np.pi))
    initials = structure(model).initial
    for j, state in enumerate([*range(place.q.start, place.q.start + 2), place.v.start, place.v.start + 1]):
        assert initials[state] == [place.start.start + j]


def test_static_amplitudes_are_calculated() -> None:
    model = sparse_model("static")
    for variable in variables(model):
        if variable.name.startswith("modes.amplitude"):
            assert (variable.initial, variable.start) == ("calculated", None)
        if variable.name.startswith("modes.velocity"):
            assert (variable.initial, variable.start) == ("exact", 0.0)


def test_default_experiment_resolves_the_highest_mode() -> None:
    for model in (two_ports(), oscillator(stiffness=4e9), oscillator(stiffness=1e-5)):
        stop, step = default_experiment(model)
        f = model.frequency[model.lam > 0]
        assert 1 / (50 * f[-1]) <= step <= 1 / (20 * f[-1])  # 1, 2, 5: neighbours differ by at most 2.5
        assert 10 / f[0] <= stop <= 25 / f[0]
    rigid = oscillator(stiffness=0.0)
    assert default_experiment(rigid) == (1.0, 1e-3)


def test_default_experiment_around_round_numbers() -> None:
    for power in range(-6, 9):
        for near in (np.nextafter(10.0**power, 0), 10.0**power, np.nextafter(10.0**power, np.inf)):
            stop, step = default_experiment(oscillator(stiffness=float((2 * np.pi * near) ** 2)))
            assert 0 < step < stop


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
