"""ModelStructure of the native FMU: every known is varied without a step; exactly what is declared moves."""

import shutil
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np
import pytest
from examples import two_ports
from native_fmu import OK, Instance, NativeFmu, native_fmu
from structures import (
    MODELS,
    at_event,
    declared,
    initialising,
    inputs,
    integrating,
    set_states,
    settable_states,
    start_of,
    starts,
    states,
    static_start,
    stepping,
)

DAMPING = ("damping.alpha", "damping.beta")
Moved = dict[str, set[str]]
Make = Callable[[NativeFmu, Mapping[str, float]], Instance]


@pytest.fixture(params=MODELS)
def fmu(request: pytest.FixtureRequest) -> NativeFmu:
    return native_fmu(MODELS[request.param])


def somewhere(fmu: NativeFmu) -> dict[str, float]:
    """Forces and states with start values that are all different and none 0."""
    knowns = inputs(fmu) + settable_states(fmu) + starts(fmu)
    return dict(zip(knowns, np.random.default_rng(5).uniform(0.5, 1.5, len(knowns)).tolist(), strict=True))


def reals(part: Instance) -> dict[str, float]:
    listed = [v.name for v in part.fmu.description.modelVariables if v.type == "Real"]
    return dict(zip(listed, part.reals().tolist(), strict=True))


def differ(before: Mapping[str, float], after: Mapping[str, float], known: str, rounding: float) -> set[str]:
    return {name for name in before if name != known and abs(after[name] - before[name]) > rounding}


def add(moved: Moved, unknowns: Iterable[str], known: str) -> None:
    for unknown in unknowns:
        moved.setdefault(unknown, set()).add(known)


def set_known(part: Instance, known: str, value: float) -> None:
    """Also the one Integer; and states in continuous-time mode, where they cannot be set as variables."""
    if known == "modes.active":
        assert part.set_active(int(value)) == OK
    elif part.set({known: value}) != OK:
        set_states(part, {known: value})


def vary(fmu: NativeFmu, make: Make, knowns: Iterable[str], rounding: float) -> Moved:
    """From rest, where a change is the contribution itself, however small; one instance before and after."""
    moved: Moved = {}
    for known in knowns:
        part = make(fmu, {})
        before = reals(part)
        set_known(part, known, 1.0)
        add(moved, differ(before, reals(part), known, rounding), known)
    return moved


def vary_settings(fmu: NativeFmu, make: Make) -> Moved:
    """Damping and modes.active act on a motion only."""
    moved: Moved = {}
    for known, values in (
        ("damping.alpha", [9.0]),
        ("damping.beta", [0.9]),
        ("modes.active", range(fmu.modes)),
    ):
        part = make(fmu, somewhere(fmu))
        before = reals(part)
        for value in values:
            set_known(part, known, value)
            add(moved, differ(before, reals(part), known, 1e-9), known)
    return moved


def merged(*parts: Moved) -> Moved:
    whole: Moved = {}
    for part in parts:
        for unknown, knowns in part.items():
            whole.setdefault(unknown, set()).update(knowns)
    return whole


def mismatches(told: Moved, moved: Moved) -> list[tuple[str, str]]:
    """(unknown, known) that are declared and do not exist, or exist and are not declared."""
    unknowns = told.keys() | moved.keys()
    pairs = ((u, known) for u in unknowns for known in told.get(u, set()) ^ moved.get(u, set()))
    return sorted(pairs)


def rounding(fmu: NativeFmu) -> float:
    """Forces that cancel in equilibrium, B u − λ q, leave their roundings; elsewhere nothing cancels."""
    return 1e-12 if static_start(fmu) else 0.0


def initial_dependencies(fmu: NativeFmu) -> Moved:
    knowns = inputs(fmu) + settable_states(fmu) + starts(fmu)
    return merged(
        vary(fmu, initialising, knowns, rounding(fmu)),
        vary_settings(fmu, initialising),
    )


def running_dependencies(fmu: NativeFmu) -> Moved:
    return merged(
        vary(fmu, stepping, inputs(fmu), 0.0),
        vary(fmu, integrating, states(fmu), 0.0),
    )


def test_initial_unknowns(fmu: NativeFmu) -> None:
    """In initialization mode: inputs, states with start values, starts of motions, α, β, modes.active."""
    told = declared(fmu, "initialUnknowns")
    moved = initial_dependencies(fmu)
    # modes switched off go to rest, but their states are no unknowns where they have start values
    for name in settable_states(fmu):
        assert moved.pop(name) == {"modes.active"}
    assert mismatches(told, moved) == []
    calculated = {v.name for v in fmu.description.modelVariables if v.initial == "calculated"}
    assert told.keys() == calculated


def test_communication_points(fmu: NativeFmu) -> None:
    """Inputs by setting them; states by starting from others, since they cannot be set later."""
    told = declared(fmu, "outputs", "derivatives")
    moved = vary(fmu, stepping, inputs(fmu), 0.0)
    before = reals(stepping(fmu, {}))
    begins = {} if static_start(fmu) else start_of(fmu)  # amplitudes follow from them there
    reachable = {*inputs(fmu), *settable_states(fmu), *begins}
    for known in reachable - {*inputs(fmu)}:
        add(moved, differ(before, reals(stepping(fmu, {known: 1.0})), known, 0.0), known)
    for unknown in (*starts(fmu), *states(fmu)):
        moved.pop(unknown, None)  # what it starts with, and what follows from that
    assert mismatches({u: knowns & reachable for u, knowns in told.items()}, moved) == []


@pytest.mark.parametrize("make", [integrating, at_event])
def test_model_exchange(fmu: NativeFmu, make: Make) -> None:
    """All inputs and all states, in both modes."""
    told = declared(fmu, "outputs", "derivatives")
    if make is integrating:
        moved = vary(fmu, integrating, inputs(fmu) + states(fmu), 0.0)
    else:
        moved = vary(fmu, at_event, inputs(fmu), 0.0)
        before = reals(at_event(fmu, {}))
        for known in states(fmu):
            add(moved, differ(before, reals(at_event(fmu, {known: 1.0})), known, 0.0), known)
    assert mismatches(told, moved) == []


AT_REST = {"moved static": "moved", "moved gaps static": "moved gaps"}  # equilibria that know α


@pytest.mark.parametrize("make", [stepping, at_event])
@pytest.mark.parametrize("model", MODELS)
def test_damping_while_running(model: str, make: Make) -> None:
    """α and β move what InitialUnknowns says, at any time: accelerations and damping ratios."""
    fmu, starting = native_fmu(MODELS[model]), native_fmu(MODELS[AT_REST.get(model, model)])
    told = {u: knowns & {*DAMPING} for u, knowns in declared(starting, "initialUnknowns").items()}
    moved = {u: knowns & {*DAMPING} for u, knowns in vary_settings(fmu, make).items()}
    assert mismatches(told, moved) == []
    assert sum(map(len, told.values())) >= 2 * fmu.modes  # rigid ones know no β


def changed(tmp_path: Path, edit: Callable[[ET.Element], None]) -> NativeFmu:
    """two_ports with another modelDescription.xml."""
    folder = tmp_path / "changed"
    shutil.copytree(native_fmu(two_ports).folder, folder)
    path = folder / "modelDescription.xml"
    tree = ET.parse(path)
    edit(tree.getroot())
    tree.write(path, encoding="UTF-8", xml_declaration=True)
    return NativeFmu(folder)


@pytest.mark.parametrize(
    ("group", "xml"),
    [("outputs", "Outputs"), ("derivatives", "Derivatives"), ("initialUnknowns", "InitialUnknowns")],
)
def test_a_wrong_dependency_is_noticed(tmp_path: Path, group: str, xml: str) -> None:
    """The control: the last dependency of an unknown left out of the description."""
    left_out: list[tuple[int, int]] = []

    def leave_out(root: ET.Element) -> None:
        unknown = next(u for u in root.findall(f"ModelStructure/{xml}/Unknown") if u.attrib["dependencies"])
        *kept, last = unknown.attrib["dependencies"].split()
        unknown.attrib["dependencies"] = " ".join(kept)
        left_out.append((int(unknown.attrib["index"]), int(last)))

    fmu = changed(tmp_path, leave_out)
    listed = fmu.description.modelVariables
    (index, known) = left_out[0]
    moved = initial_dependencies(fmu) if group == "initialUnknowns" else running_dependencies(fmu)
    told = declared(fmu, group)
    found = mismatches(told, {u: knowns for u, knowns in moved.items() if u in told})
    assert found == [(listed[index - 1].name, listed[known - 1].name)]
