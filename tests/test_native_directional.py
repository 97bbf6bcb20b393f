"""Directional derivatives: equal differences, agree with ModelStructure, are linear, and refuse the rest."""

from collections.abc import Callable, Mapping

import numpy as np
import pytest
from examples import two_ports
from native_fmu import ERROR, Instance, NativeFmu, native_fmu
from structures import (
    MODELS,
    at_event,
    declared,
    initialising,
    inputs,
    integrating,
    names,
    settable_states,
    start_of,
    starts,
    states,
    static,
    static_start,
    stepping,
)

from fmu_src.runtime.model import Floats

DAMPING = ["damping.alpha", "damping.beta"]
Make = Callable[[NativeFmu, Mapping[str, float]], Instance]


@pytest.fixture(params=MODELS)
def fmu(request: pytest.FixtureRequest) -> NativeFmu:
    return native_fmu(MODELS[request.param])


def unknowns_of(fmu: NativeFmu, make: Make) -> dict[str, set[str]]:
    """The unknowns of this mode and the knowns that they are declared to depend on, Reals only."""
    groups = ("initialUnknowns",) if make is initialising else ("outputs", "derivatives")
    return {u: knowns - {"modes.active"} for u, knowns in declared(fmu, *groups).items()}


def knowns_of(fmu: NativeFmu, make: Make) -> list[str]:
    if make is initialising:
        return inputs(fmu) + DAMPING + settable_states(fmu) + starts(fmu)
    return inputs(fmu) + states(fmu)


def somewhere(fmu: NativeFmu, make: Make) -> dict[str, float]:
    """A value for each known that can be set in this mode."""
    reachable = [*inputs(fmu), *settable_states(fmu), *start_of(fmu)]
    knowns = [k for k in knowns_of(fmu, make) if make is not stepping or k in reachable]
    values = np.random.default_rng(12).uniform(0.5, 1.5, len(knowns)).tolist()
    return dict(zip(knowns, values, strict=True))


def vr(fmu: NativeFmu, listed: list[str] | set[str] | dict[str, set[str]]) -> list[int]:
    return [fmu.reference[name] for name in listed]


def jacobian(part: Instance, unknowns: list[str], knowns: list[str]) -> Floats:
    """∂unknown/∂known, a column for each direction."""
    references, others = vr(part.fmu, unknowns), vr(part.fmu, knowns)
    return np.column_stack([part.directional(references, [known], [1.0]) for known in others])


MODES = pytest.mark.parametrize(
    "make", [initialising, stepping, integrating, at_event], ids=lambda make: make.__name__
)


@MODES
def test_equal_central_differences(fmu: NativeFmu, make: Make) -> None:
    """Nothing but a von Mises stress is more than quadratic in one known: differences have roundings only."""
    values = somewhere(fmu, make)
    unknowns, knowns = [u for u in unknowns_of(fmu, make) if not u.endswith("mises")], [*values]
    if make is stepping and static_start(fmu):  # with the start of a motion all amplitudes are others
        knowns = [known for known in knowns if known not in start_of(fmu)]
    exact = jacobian(make(fmu, values), unknowns, knowns)
    # 1e-15 of an unknown's size, and of the forces λq, d q̇ that it is made of, over the difference's size
    size = np.abs(exact).sum(axis=1, keepdims=True) + np.abs(make(fmu, values).get(*unknowns))[:, None]
    for delta in (0.4, 0.01):
        difference = differences(fmu, make, values, unknowns, knowns, delta)
        assert (np.abs(difference - exact) <= 1e-14 / delta * size).all()


def differences(
    fmu: NativeFmu,
    make: Make,
    values: Mapping[str, float],
    unknowns: list[str],
    knowns: list[str],
    delta: float,
) -> Floats:
    """(y(x + δ) − y(x − δ))/2δ, a column for each known."""
    columns = []
    for known in knowns:
        there, back = (make(fmu, {**values, known: values[known] + s * delta}) for s in (1, -1))
        columns.append((there.get(*unknowns) - back.get(*unknowns)) / (2 * delta))
    return np.column_stack(columns)


@pytest.mark.parametrize(
    ("model", "make"),
    [
        *(("everything", make) for make in (initialising, stepping, integrating, at_event)),
        ("everything static", initialising),
    ],
)
def test_von_mises_to_second_order(model: str, make: Make) -> None:
    """Its derivative by the chain rule: what differences leave falls by four with half the δ."""
    fmu, mises = native_fmu(MODELS[model]), ["left.stress.mises"]
    values = somewhere(fmu, make)
    exact = jacobian(make(fmu, values), mises, [*values])
    left = [
        np.abs(differences(fmu, make, values, mises, [*values], delta) - exact).max()
        for delta in (2e-3, 1e-3)
    ]
    assert left[0] / left[1] == pytest.approx(4.0, abs=0.02)
    assert left[1] < 1e-4 * np.abs(exact).max()


@MODES
def test_von_mises_of_no_stress_moves_nowhere(make: Make) -> None:
    """At rest, where it has no derivative: 0. It does move, of course."""
    fmu = native_fmu(MODELS["everything"])
    knowns = [known for known in knowns_of(fmu, make) if known not in DAMPING]
    at_rest, moved = make(fmu, {}), make(fmu, somewhere(fmu, make))
    assert (jacobian(at_rest, ["left.stress.mises"], knowns) == 0.0).all()
    assert (jacobian(moved, ["left.stress.mises"], knowns) != 0.0).any()


@MODES
def test_nonzero_exactly_where_declared(fmu: NativeFmu, make: Make) -> None:
    told = unknowns_of(fmu, make)
    knowns = knowns_of(fmu, make)
    found = jacobian(make(fmu, somewhere(fmu, make)), [*told], knowns)
    for row, (unknown, dependencies) in zip(found, told.items(), strict=True):
        assert {known for known, value in zip(knowns, row, strict=True) if value != 0.0} == dependencies, (
            unknown
        )


@MODES
def test_linear_in_the_direction(fmu: NativeFmu, make: Make) -> None:
    """J (2a − 3b) = 2 J a − 3 J b; several directions of one known add up; none gives 0."""
    rng = np.random.default_rng(13)
    part = make(fmu, somewhere(fmu, make))
    unknowns = vr(fmu, unknowns_of(fmu, make))
    knowns = vr(fmu, knowns_of(fmu, make))
    a, b = rng.standard_normal((2, len(knowns)))
    Ja, Jb = (part.directional(unknowns, knowns, direction) for direction in (a, b))
    together = part.directional(unknowns, knowns, 2 * a - 3 * b)
    size = np.abs(jacobian(part, [*unknowns_of(fmu, make)], knowns_of(fmu, make))).sum(axis=1)
    assert (np.abs(together - (2 * Ja - 3 * Jb)) <= 1e-14 * 10 * size).all()
    twice = part.directional(unknowns, knowns + knowns, [*(2 * a), *(-3 * b)])
    assert (np.abs(together - twice) <= 1e-14 * 10 * size).all()
    assert (part.directional(unknowns, [], []) == 0).all()
    shuffled = part.directional(unknowns[::-1], knowns[::-1], a[::-1])
    assert (np.abs(shuffled[::-1] - Ja) <= 1e-14 * size).all()


@MODES
def test_asking_changes_nothing(fmu: NativeFmu, make: Make) -> None:
    part, asked = make(fmu, somewhere(fmu, make)), make(fmu, somewhere(fmu, make))
    jacobian(asked, [*unknowns_of(fmu, make)], knowns_of(fmu, make))
    np.testing.assert_array_equal(asked.reals(), part.reals())
    assert asked.save() == part.save()


@MODES
@pytest.mark.parametrize("model", ["two_ports", "static", "moved static"])
def test_other_variables_are_refused(model: str, make: Make) -> None:
    """Exactly the unknowns and knowns of ModelStructure can be asked for."""
    fmu = native_fmu(MODELS[model])
    part = make(fmu, somewhere(fmu, make))
    legal_unknowns, legal_knowns = {*unknowns_of(fmu, make)}, {*knowns_of(fmu, make)}
    reals = [v.name for v in fmu.description.modelVariables if v.type == "Real"]
    values, one = np.full(1, -7.0), np.ones(1)
    unknown_given = np.array(vr(fmu, [next(iter(legal_unknowns))]), np.uint32)
    known_given = np.array(vr(fmu, ["left.force.x"]), np.uint32)
    for name in reals:
        reference = np.array(vr(fmu, [name]), np.uint32)
        arguments = (reference, 1, known_given, 1, one, values)
        accepted = part.call("GetDirectionalDerivative", *arguments) == 0
        assert accepted == (name in legal_unknowns), name
        arguments = (unknown_given, 1, reference, 1, one, values)
        accepted = part.call("GetDirectionalDerivative", *arguments) == 0
        assert accepted == (name in legal_knowns), name
    beyond = np.array([fmu.size], np.uint32)
    values[0] = -7.0
    for arguments in ((beyond, 1, known_given, 1, one, values), (unknown_given, 1, beyond, 1, one, values)):
        assert part.call("GetDirectionalDerivative", *arguments) == ERROR
    assert values[0] == -7.0
    assert "ModelStructure" in part.log[-1].text


@MODES
def test_modes_switched_off_do_not_move(make: Make) -> None:
    """Their columns and rows are 0, the others those of the model that has the first modes only."""
    fmu = native_fmu(two_ports)
    values = somewhere(fmu, make)
    unknowns, knowns = [*unknowns_of(fmu, make)], knowns_of(fmu, make)
    part = make(fmu, values)
    before = jacobian(part, unknowns, knowns)
    if make is integrating:
        part.must("EnterEventMode")
    assert part.set_active(3) == 0
    if make is integrating:
        part.must("EnterContinuousTimeMode")
    after = jacobian(part, unknowns, knowns)
    off = [f"[{i}]" in name for name in knowns for i in (4, 5, 6)]
    off_knowns = np.array(off).reshape(-1, 3).any(axis=1)
    off_rows = [name.startswith("der(") and any(f"[{i}]" in name for i in (4, 5, 6)) for name in unknowns]
    assert (after[:, off_knowns] == 0).all()
    assert (after[off_rows] == 0).all()
    # outputs see a state of a mode that is on as before, and rows of such modes are as before
    outputs = [name in declared(fmu, "outputs") for name in unknowns]
    on = ~off_knowns & np.array([name in states(fmu) for name in knowns])
    np.testing.assert_array_equal(after[np.ix_(outputs, on)], before[np.ix_(outputs, on)])
    shown = [name.startswith("der(") and any(f"[{i}]" in name for i in (1, 2, 3)) for name in unknowns]
    np.testing.assert_array_equal(after[shown], before[shown])
    assert np.abs(before[off_rows]).sum() > 0


def test_a_static_start_moves_with_its_inputs() -> None:
    """∂q/∂u = B/λ and ∂y/∂u = C B/λ of displacements; accelerations stay 0 whatever the force."""
    model, fmu = static(), native_fmu(static)
    part = initialising(fmu, {})
    given = inputs(fmu)
    q = jacobian(part, names(fmu, "modes.amplitude["), given)
    np.testing.assert_allclose(q, model.B / model.lam[:, None], rtol=1e-15)
    y = jacobian(part, ["left.displacement.x", "right.displacement.y"], given)
    np.testing.assert_allclose(y, model.C[[0, 4]] @ (model.B / model.lam[:, None]), rtol=1e-13)
    a = jacobian(part, ["left.acceleration.z", *names(fmu, "der(modes.velocity[")], given)
    assert (a == 0).all()
    part.must("ExitInitializationMode")
    after = jacobian(part, ["left.displacement.x", "left.acceleration.z"], given)
    assert (after[0] == 0).all()  # the position no longer follows at once
    np.testing.assert_allclose(after[1], model.C[2] @ model.B, rtol=1e-13)
