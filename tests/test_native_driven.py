"""Ports whose acceleration is prescribed, in the native FMU: against the full part, in both uses."""

import math
import shutil
import struct
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
from driven import Full, driven, part
from fmpy import platform, sharedLibraryExtension
from native_fmu import CO_SIMULATION, ERROR, MODEL_EXCHANGE, OK, Instance, NativeFmu, native_fmu
from native_library import compile_into
from native_modes import driven_ports
from scipy.integrate import solve_ivp
from structures import inputs, start_of, starts, states

from fmu_src.runtime.instance import Instance as Twin
from fmu_src.runtime.model import Floats

PARTS: Mapping[str, Mapping[str, float]] = {
    "three ports": {},
    "one, nothing that drags": {"k": 1, "dashpots": False, "alpha": 0.0},
    "two, α drags": {"k": 2, "dashpots": False},
    "two, a rigid mode": {"k": 2, "rigid": True},
    "three, most modes over-damped": {"beta": 0.2, "dashpots": False},
}
# of the largest of its kind: ε‖A‖h of the full part's exponential, ‖A‖ ≈ 700; third derivatives of the motion
# have λ more of it
CLOSE = 1e-10


def begun(fmu: NativeFmu, s: Floats, s_dot: Floats, kind: int = CO_SIMULATION) -> Instance:
    return fmu.instance(kind).initialise(dict(zip(starts(fmu), [*s, *s_dot], strict=True)))


def give(x: Instance, rows: Floats) -> None:
    """u and as many of its derivatives as there are rows."""
    assert x.set_real(x.fmu.inputs, rows[0]) == OK
    for order, row in enumerate(rows[1:], start=1):
        assert x.set_rates(x.fmu.inputs, [order] * len(row), row) == OK


def y_of(x: Instance) -> Floats:
    """y, ẏ, ÿ: (3, p)."""
    listed = x.fmu.outputs
    return np.array([x.get_real(listed), *(x.get_rates(listed, [k] * len(listed)) for k in (1, 2))])


@pytest.mark.parametrize("name", PARTS)
def test_outputs_and_their_derivatives_are_those_of_the_full_part(name: str) -> None:
    """Over steps with inputs that are held, linear and quadratic, one after the other."""
    of, rng = part(**PARTS[name]), np.random.default_rng(4)
    s, s_dot = rng.standard_normal((2, of.k))
    fmu = native_fmu(driven, **PARTS[name])
    x, full, t = begun(fmu, s, s_dot), Full(of, s, s_dot), 0.0
    names = [v.name for v in fmu.description.modelVariables if v.causality == "output"]
    for h, rates in ((0.05, 2), (0.3, 0), (0.002, 1), (0.3, 2), (1.0, 1), (0.05, 0), (0.4, 2)):
        rows = rng.standard_normal((1 + rates, len(fmu.inputs))) * [[1.0], [4.0], [20.0]][: 1 + rates]
        give(x, rows)
        assert x.step(t, h) == OK
        full.move(h, rows)
        t += h
        found, expected = y_of(x), full.outputs()
        largest = np.abs([*expected.values()]).max(axis=0)
        for output, value in expected.items():
            assert (np.abs(found[:, names.index(output)] - value) <= CLOSE * largest).all(), (output, t)
    x.free()


@pytest.mark.parametrize("dashpots", [True, False], ids=["coupled", "alone"])
@pytest.mark.parametrize("rates", [0, 1, 2])
def test_two_steps_are_one(dashpots: bool, rates: int) -> None:
    """Semigroup, under the same polynomial: a wrong G₃ would show. Of any step size, to rounding."""
    fmu, rng = native_fmu(driven, dashpots=dashpots), np.random.default_rng(5)
    start = rng.standard_normal(6)
    rows = np.zeros((3, len(fmu.inputs)))
    rows[: 1 + rates] = rng.standard_normal((1 + rates, len(fmu.inputs)))
    for h in (1e-6, 1e-3, 0.1, 3.0):
        ends = []
        for parts in ((1.0,), (0.5, 0.5), (0.3, 0.7)):
            x, t = begun(fmu, start[:3], start[3:]), 0.0
            for fraction in parts:
                u, u1, u2 = rows
                give(x, np.array([u + t * u1 + t**2 / 2 * u2, u1 + t * u2, u2])[: 1 + rates])
                assert x.step(t, fraction * h) == OK
                t += fraction * h
            ends.append(x.get(*states(fmu)))
            x.free()
        for other in ends[1:]:
            # ωh ≤ 80 roundings of the phase
            assert np.abs(other - ends[0]).max() <= 3e-14 * (1 + 25 * h) * np.abs(ends[0]).max()


def test_energy_is_what_the_ports_and_forces_put_in() -> None:
    """d(T + V)/dt = Σ r_j ṡ_j where nothing damps and nothing else is driven, at any time."""
    undamped = {"alpha": 0.0, "beta": 0.0, "dashpots": False}
    fmu, rng = native_fmu(driven, **undamped), np.random.default_rng(6)
    x = begun(fmu, *rng.standard_normal((2, 3)))
    moves = [name for name in inputs(fmu) if "motion" in name]
    energies = [fmu.reference[f"energy.{kind}"] for kind in ("kinetic", "strain")]
    velocities = [name for name in start_of(fmu) if "velocity" in name]
    for t, h in ((0.0, 0.1), (0.1, 0.02), (0.12, 0.7)):
        assert x.set(dict(zip(moves, rng.standard_normal(3), strict=True))) == OK
        assert x.step(t, h) == OK
        rates = x.get_rates(energies, [1, 1])
        reactions = x.get("left.reaction.y", "left.reaction_moment.z", "right.reaction.x")
        power = reactions @ x.get(*velocities)
        assert rates.sum() == pytest.approx(power, abs=1e-12 * np.abs(rates).sum())
        assert abs(power) > 1e-3 * np.abs(rates).sum()
    x.free()


def test_starts_are_parameters() -> None:
    """They can be set until the initialisation ends, are what motions begin with, and stay as they were."""
    fmu = native_fmu(driven)
    x = fmu.instance()
    names, begins = starts(fmu), start_of(fmu)
    values = dict(zip(names, np.arange(1.0, 7.0), strict=True))
    assert x.set(dict.fromkeys(names, 7.0)) == OK  # instantiated
    x.must("EnterInitializationMode")
    assert x.get(*begins).tolist() == [7.0] * 6
    assert x.set(values) == OK
    assert x.get(*begins).tolist() == [values[start] for start in begins.values()]
    for state in begins:
        assert x.set({state: 1.0}) == ERROR
    for bad in (math.nan, math.inf):
        assert x.set({names[0]: bad}) == ERROR
    x.must("ExitInitializationMode")
    assert x.set(values) == ERROR
    assert x.step(0.0, 0.5) == OK
    assert x.get(*names).tolist() == [*values.values()]
    moved = x.get(*begins).reshape(2, 3)
    np.testing.assert_allclose(moved, [[1 + 0.5 * 4, 2 + 0.5 * 5, 3 + 0.5 * 6], [4, 5, 6]], rtol=1e-15)
    x.must("Reset")
    x.must("EnterInitializationMode")
    assert x.get(*names, *begins).tolist() == [0.0] * 12
    x.free()


def test_a_saved_state_remembers_the_starts() -> None:
    """In another instance with other starts, during initialisation and later."""
    fmu = native_fmu(driven_ports, initial="static")
    values = dict(zip(starts(fmu), np.arange(1.0, 7.0), strict=True))
    x, other = fmu.instance(), fmu.instance()
    for instance in (x, other):
        instance.must("EnterInitializationMode")
    assert x.set(values) == OK
    assert other.set(dict.fromkeys(values, -1.0)) == OK
    saved, seen = x.save(), x.reals()
    assert other.restore(saved) == OK
    np.testing.assert_array_equal(other.reals(), seen)
    other.must("ExitInitializationMode")
    assert other.step(0.0, 0.1) == OK
    later = other.reals()
    assert x.restore(other.save()) == OK
    np.testing.assert_array_equal(x.reals(), later)
    start = np.array([4.0]).tobytes()
    damaged = saved.replace(start, np.array([math.nan]).tobytes(), 1)
    assert damaged != saved
    assert x.restore(damaged) == ERROR
    np.testing.assert_array_equal(x.reals(), later)
    x.free()
    other.free()


@pytest.mark.parametrize("initial", ["rest", "static"])
def test_damping_is_tuned_with_nothing_else_changed(initial: str) -> None:
    """All Reals as the Python twin has them, at the start and from step to step."""
    fmu, twin = native_fmu(driven_ports, initial=initial), Twin(driven_ports(initial))
    x, place, start = fmu.instance(), twin.layout, np.arange(1.0, 7.0)
    x.must("EnterInitializationMode")
    assert x.set(dict(zip(starts(fmu), start, strict=True))) == OK
    assert x.set_real(fmu.inputs, 0.1 * np.arange(len(fmu.inputs))) == OK
    twin.set_start(dict(enumerate(start, start=place.start.start)))
    twin.set_inputs(fmu.inputs, 0.1 * np.arange(len(fmu.inputs)))
    for k, alpha in enumerate((0.4, 7.0, 0.0, 2.0)):
        assert x.set({"damping.alpha": alpha, "damping.beta": 0.01 * alpha}) == OK
        twin.set_damping(alpha, 0.01 * alpha)
        found, expected = x.reals(), twin.reals()
        # λq, of which accelerations and reactions are left, is up to 1e4
        assert np.abs(found - expected).max() < 1e-14 * 1e4, alpha
        if k == 1:
            x.must("ExitInitializationMode")
            twin.initialising = False
        if k >= 1:
            assert x.step(0.2 * (k - 1), 0.2) == OK
            assert twin.advance(0.2 * (k - 1), 0.2) is None
            assert np.abs(x.reals() - twin.reals()).max() < 1e-14 * 1e4, alpha
    x.free()


def test_a_state_that_stops_a_port_is_damaged() -> None:
    """The motions count as active: fewer than k coordinates are refused, k are not."""
    fmu = native_fmu(driven)
    x = begun(fmu, np.zeros(3), np.ones(3))
    saved, seen = x.save(), x.reals()
    k, n, m = fmu.coordinates - fmu.modes, fmu.coordinates, len(fmu.inputs)
    head = struct.pack("=QQQ", n, m, n)
    assert saved.count(head) == 1
    for active, status in ((k - 1, ERROR), (k, OK)):
        assert x.restore(saved.replace(head, struct.pack("=QQQ", n, m, active))) == status
        if status == ERROR:
            np.testing.assert_array_equal(x.reals(), seen)
    assert x.get_active() == 0
    x.free()


def test_the_level_of_detail_counts_modes() -> None:
    """0 … r; the ports move on, whatever is off."""
    fmu = native_fmu(driven)
    x = begun(fmu, np.zeros(3), np.ones(3))
    r = fmu.modes
    assert (r, fmu.coordinates) == (5, 8)
    assert x.get_active() == r
    assert [x.set_active(k) for k in (r + 1, -1, r, 0)] == [ERROR, ERROR, OK, OK]
    assert x.get_active() == 0
    assert x.step(0.0, 0.25) == OK
    assert x.get(*start_of(fmu)).tolist() == [0.25] * 3 + [1.0] * 3
    assert not x.get(*(f"modes.amplitude[{i}]" for i in range(1, r + 1))).any()
    assert x.get("left.displacement.y")[0] == 0.25
    x.free()


def test_the_tools_solver_comes_to_what_the_steps_compute() -> None:
    """Model exchange: derivatives are functions of states and inputs, integrated to 1e-11 by DOP853."""
    fmu, rng = native_fmu(driven), np.random.default_rng(7)
    s, s_dot = rng.standard_normal((2, 3))
    rows = rng.standard_normal((3, len(fmu.inputs)))
    stepped, x = begun(fmu, s, s_dot), begun(fmu, s, s_dot, MODEL_EXCHANGE)
    give(stepped, rows)
    assert stepped.step(0.0, 0.6) == OK
    x.must("EnterContinuousTimeMode")

    def rate(t: float, state: Floats) -> Floats:
        assert x.set_real(fmu.inputs, rows[0] + t * rows[1] + t**2 / 2 * rows[2]) == OK
        assert x.set_states(state) == OK
        return x.get_states("GetDerivatives")

    begin = x.get_states()
    np.testing.assert_array_equal(begin, [*s, *[0.0] * 5, *s_dot, *[0.0] * 5])
    assert x.get_states("GetNominalsOfContinuousStates").tolist()[:3] == [1.0] * 3
    end = solve_ivp(rate, (0.0, 0.6), begin, method="DOP853", rtol=1e-12, atol=1e-12).y[:, -1]
    np.testing.assert_allclose(end, stepped.get(*states(fmu)), rtol=1e-10, atol=1e-10)
    rate(0.6, end)
    np.testing.assert_allclose(x.get_real(fmu.outputs), stepped.get_real(fmu.outputs), rtol=1e-8, atol=1e-8)
    assert x.set({"left.prescribed_velocity.y": 3.0}) == OK  # a state like others while a solver is at work
    assert x.get_states()[8] == 3.0
    x.free()
    stepped.free()


def test_the_embedded_model_is_the_same(tmp_path: Path) -> None:
    """Compiled in, with no resources beside it: the same run."""
    fmu, rng = native_fmu(driven), np.random.default_rng(8)
    folder = tmp_path / "embedded"
    shutil.copytree(fmu.folder, folder)
    name = f"{driven().name}{sharedLibraryExtension}"
    flags = ("-shared", "-fPIC", "-O1", "-mcpu=baseline", "-DMODALFMU_EMBEDDED_MODEL")
    source = folder / "sources" / "modalfmu.c"
    shutil.copy(compile_into(tmp_path, name, [source], flags), folder / "binaries" / platform / name)
    shutil.rmtree(folder / "resources")
    rows, start = rng.standard_normal((3, len(fmu.inputs))), rng.standard_normal(6)
    ends = []
    for one in (fmu, NativeFmu(folder)):
        x = begun(one, start[:3], start[3:])
        give(x, rows)
        assert x.step(0.0, 0.3) == OK
        ends.append([x.reals(), y_of(x)])
        x.free()
    for found, expected in zip(*ends, strict=True):
        np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-12 * np.abs(expected).max())


def test_a_motion_beyond_the_numbers() -> None:
    """The step is discarded and changes nothing; an acceleration that is no number is refused."""
    fmu = native_fmu(driven)
    x = begun(fmu, np.zeros(3), np.ones(3))
    before = x.save()
    assert x.set({"left.motion.y": 1e300}) == OK
    assert x.step(0.0, 1e9) != OK
    assert x.set({"left.motion.y": math.nan}) == OK
    assert x.step(0.0, 0.1) == ERROR
    assert "left.motion.y is nan" in x.log[-1].text
    assert x.set({"left.motion.y": 0.0}) == OK
    assert x.step(0.0, 0.1) == OK
    again = x.save()
    assert x.restore(before) == OK
    assert x.step(0.0, 0.1) == OK
    assert x.save() == again
    x.free()
