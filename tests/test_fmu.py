"""The Python twin as FMPy sees it, always in a process of its own."""

import json
import sys
import zipfile
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np
import pytest
from driven import driven
from examples import PRELUDE, oscillator, run_master, two_ports
from fmpy.validation import validate_fmu

from fmu_src.archive import write_archive
from fmu_src.python_fmu import build_python_fmu
from fmu_src.runtime.model import ReducedModel
from fmu_src.runtime.propagator import propagator
from fmu_src.runtime.step import State, acceleration, at_rest, static_solution, step

EPS = np.finfo(float).eps


@pytest.fixture(scope="module")
def fmu(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build_python_fmu(two_ports(), tmp_path_factory.mktemp("fmu") / "two_ports.fmu")


def static_model() -> ReducedModel:
    lam = np.array([3.0, 7.0, 30.0, 30.0, 400.0, 9000.0])
    return two_ports("settled", lam=lam, initial="static")


def test_fmpy_finds_nothing(fmu: Path, tmp_path: Path) -> None:
    assert validate_fmu(str(fmu)) == []
    settled = build_python_fmu(static_model(), tmp_path / "settled.fmu")
    assert validate_fmu(str(settled)) == []


def test_same_content_same_bytes(fmu: Path, tmp_path: Path) -> None:
    again = build_python_fmu(two_ports(), tmp_path / "again.fmu")
    assert again.read_bytes() == fmu.read_bytes()
    other = build_python_fmu(two_ports(alpha=0.31), tmp_path / "other.fmu")

    def identity(path: Path) -> tuple[str, str]:
        with zipfile.ZipFile(path) as archive:
            root = ET.fromstring(archive.read("modelDescription.xml"))
            return root.attrib["guid"], archive.read("resources/slavemodule.txt").decode()

    assert identity(other)[0] != identity(fmu)[0]
    assert identity(other)[1] != identity(fmu)[1]
    described = build_python_fmu(two_ports(description="another text"), tmp_path / "described.fmu")
    assert identity(described)[0] != identity(fmu)[0]


def test_building_leaves_the_interpreter_as_it_was(tmp_path: Path) -> None:
    build_python_fmu(two_ports(), tmp_path / "first.fmu")  # imports what every build needs
    path, modules, bytecode = list(sys.path), set(sys.modules), sys.dont_write_bytecode
    build_python_fmu(two_ports(alpha=0.7), tmp_path / "second.fmu")
    assert (sys.path, set(sys.modules), sys.dont_write_bytecode) == (path, modules, bytecode)


def test_declared_capabilities(fmu: Path) -> None:
    with zipfile.ZipFile(fmu) as archive:
        root = ET.fromstring(archive.read("modelDescription.xml"))
    assert root.find("CoSimulation").attrib == {  # type: ignore[union-attr]  # there is one
        "modelIdentifier": "two_ports",
        "needsExecutionTool": "true",
        "canHandleVariableCommunicationStepSize": "true",
        "canNotUseMemoryManagementFunctions": "true",
        "canGetAndSetFMUstate": "true",
        "canSerializeFMUstate": "true",
    }


def test_no_half_written_file(tmp_path: Path) -> None:
    target = tmp_path / "missing" / "part.fmu"
    with pytest.raises(OSError, match="missing"):
        build_python_fmu(two_ports(), target)
    kept = tmp_path / "kept.fmu"
    kept.write_bytes(b"old")
    with pytest.raises(TypeError):
        write_archive(kept, {"a": b"1", "b": None})  # type: ignore[dict-item]  # a failure halfway
    assert kept.read_bytes() == b"old"
    assert [p.name for p in tmp_path.iterdir()] == ["kept.fmu"]


def test_the_archive_explains_itself(fmu: Path) -> None:
    with zipfile.ZipFile(fmu) as archive:
        names = archive.namelist()
        assert names == sorted(names)
        assert "numpy" in archive.read("documentation/externalDependencies.txt").decode()
        licence = archive.read("documentation/licenses/license.txt").decode()
        assert "modalfmu" in licence
        assert "PythonFMU" in licence or "pythonfmu" in licence
    assert not [name for name in names if "__pycache__" in name or name.startswith("/") or ".." in name]


RUN = """
path, steps = sys.argv[1], json.loads(sys.argv[2])
part = Part(path).initialise()
t, rows = 0.0, []
for h, u in steps:
    part.fmu.setReal(list(range(len(u))), u)
    part.step(t, h)
    t += h
    rows.append(part.everything().tolist())
print(json.dumps(rows))
"""


def test_agrees_with_the_maths_at_any_step_size(fmu: Path, tmp_path: Path) -> None:
    """Variable steps through FMPy against the step of the maths: the same numbers to the last bits."""
    model = two_ports()
    rng = np.random.default_rng(3)
    steps = [(float(h), rng.standard_normal(3).tolist()) for h in 10.0 ** rng.uniform(-4, 0, 30)]
    rows = json.loads(run_master(PRELUDE + RUN, fmu, json.dumps(steps), cwd=tmp_path))
    state, t, d = at_rest(6), 0.0, model.damping(model.alpha, model.beta)
    for (h, u), row in zip(steps, rows, strict=True):
        f = model.B @ u
        state, t = step(propagator(model.lam, d, h), state, f), t + h
        a = acceleration(model.lam, d, None, state, f)
        outputs = [
            model.C[0] @ state.q,
            model.C[1] @ state.v,
            model.C[2] @ a,
            model.C[3] @ a,
            model.C[4] @ state.q,
        ]
        expected = [
            *u,
            *outputs,
            model.alpha,
            model.beta,
            *model.frequency,
            *model.damping_ratio(model.alpha, model.beta),
            *state.q,
            *state.v,
            *state.v,
            *a,
        ]
        # products may be summed in another order: a few roundings of the largest term
        np.testing.assert_allclose(row, expected, rtol=0, atol=64 * EPS * max(1.0, np.abs(expected).max()))


REPLAY = """
part = Part(sys.argv[1]).initialise()
rng = np.random.default_rng(0)
def run(t, count, rng):
    rows = []
    for _ in range(count):
        part.fmu.setReal([0, 1, 2], rng.standard_normal(3).tolist())
        h = float(rng.uniform(1e-3, 0.1))
        part.step(t, h); t += h
        rows.append(part.everything().tolist())
    return t, rows
t, _ = run(0.0, 5, rng)
part.set("damping.alpha", 0.9)
part.set("damping.beta", 0.002)
part.fmu.setInteger([0], [4])
here = part.everything()
state = part.fmu.getFMUState()
data = part.fmu.serializeFMUState(state)
_, first = run(t, 7, np.random.default_rng(1))
part.set("damping.alpha", 5.0)
part.set("damping.beta", 0.1)
part.fmu.setInteger([0], [6])
part.fmu.setFMUState(state)
assert part.fmu.getInteger([0]) == [4]
assert (part.everything() == here).all()
_, second = run(t, 7, np.random.default_rng(1))
part.fmu.setFMUState(part.fmu.deSerializeFMUstate(data))
_, third = run(t, 7, np.random.default_rng(1))
assert first == second == third, "replay differs"
other = Part(sys.argv[1], "two").initialise()
other.fmu.setFMUState(other.fmu.deSerializeFMUstate(data))
part = other
_, fourth = run(t, 7, np.random.default_rng(1))
assert first == fourth, "another instance differs"
part.fmu.setFMUState(part.fmu.deSerializeFMUstate(b"not a state"))
assert "fmi2SetFMUstate" in LOG[-1][1] and LOG[-1][0] == 3, LOG
saved = json.loads(data)
for change in ({"active": 99}, {"active": -1}, {"active": 1e400}, {"alpha": -5.0}, {"beta": None},
               {"q": [1e999] * 6}, {"q": [0.0]}, {"model": "another"}, {"time": "now"}):
    here = part.everything()
    part.fmu.setFMUState(part.fmu.deSerializeFMUstate(json.dumps({**saved, **change}).encode()))
    assert "fmi2SetFMUstate" in LOG[-1][1] and (part.everything() == here).all(), change
    LOG.append((0, ""))
young = Part(sys.argv[1], "young")
young.fmu.enterInitializationMode()
kept = young.fmu.getFMUState()
young.fmu.exitInitializationMode()
young.step(0.0, 0.1)
young.fmu.setFMUState(kept)
assert young.status(0.0, 0.1) == 2, "initialising again"
young.fmu.exitInitializationMode()
young.step(0.0, 0.1)
part.fmu.freeFMUState(state)
print("ok")
"""


def test_state_replays_to_the_bit(fmu: Path, tmp_path: Path) -> None:
    assert "ok" in run_master(PRELUDE + REPLAY, fmu, cwd=tmp_path)


RESET = """
part = Part(sys.argv[1]).initialise()
other = Part(sys.argv[1], "two").initialise()
fresh = part.everything()
part.set("left.force.x", 3.0)
part.step(0.0, 0.1)
assert (other.everything() == fresh).all(), "instances share their state"
moved = part.everything()
assert (moved != fresh).any()
part.fmu.reset()
part.fmu.setupExperiment(startTime=0.0)
part.initialise()
assert (part.everything() == fresh).all()
part.set("left.force.x", 3.0)
part.step(0.0, 0.1)
assert (part.everything() == moved).all()
part.fmu.terminate()
part.fmu.freeInstance()
other.step(0.0, 0.1)
many = [Part(sys.argv[1], f"i{k}", other.folder).initialise(left__force__x=float(k)) for k in range(20)]
for part in many:
    part.step(0.0, 0.1)
x = [part.get("left.displacement.x")[0] for part in many]
np.testing.assert_allclose(x, x[1] * np.arange(20), rtol=1e-12)  # a linear model
print("ok")
"""


def test_reset_terminate_and_instances(fmu: Path, tmp_path: Path) -> None:
    assert "ok" in run_master(PRELUDE + RESET, fmu, cwd=tmp_path)


SWITCH = """
part = Part(sys.argv[1]).initialise()
r, t = 6, 0.0
q = [f"modes.amplitude[{i}]" for i in range(1, r + 1)]
part.set("left.force.x", 1.0)
part.step(t, 0.1); t += 0.1
full = part.get(*q)
part.fmu.setInteger([0], [3])
assert (part.get(*q)[:3] == full[:3]).all() and (part.get(*q)[3:] == 0).all()
part.step(t, 0.1); t += 0.1
assert (part.get(*q)[3:] == 0).all()
part.fmu.setInteger([0], [6])
assert (part.get(*q)[3:] == 0).all()
part.step(t, 0.1); t += 0.1
assert (part.get(*q)[3:] != 0).all()
part.fmu.setInteger([0], [7])
assert part.fmu.getInteger([0]) == [6] and "0 … 6" in LOG[-1][1], LOG
before = part.get("modes.damping_ratio[3]")[0]
part.set("damping.alpha", 0.3 + 2 * 30**0.5)
assert abs(part.get("modes.damping_ratio[3]")[0] - before - 1.0) < 1e-12
assert part.get("modes.damping_ratio[1]")[0] == 0
part.set("damping.beta", -1.0)
assert part.get("damping.beta")[0] == 1e-3 and LOG[-1][0] == 3, LOG
print("ok")
"""


def test_level_of_detail_and_damping_change_at_run_time(fmu: Path, tmp_path: Path) -> None:
    assert "ok" in run_master(PRELUDE + SWITCH, fmu, cwd=tmp_path)


REFUSALS = """
part = Part(sys.argv[1])
assert part.status(0.0, 0.1) == 2, "a step before initialisation"
part.initialise()
part.set("left.force.x", 1.0)
part.step(0.0, 0.1)
for u, t, h, word in [
    (float("nan"), 0.1, 0.1, "left.force.x is nan"),
    (float("inf"), 0.1, 0.1, "left.force.x is inf"),
    (1.0, 0.1, -0.1, "communicationStepSize is -0.1"),
    (1.0, 0.1, 0.0, "communicationStepSize is 0.0"),
    (1.0, 0.1, float("inf"), "communicationStepSize is inf"),
    (1.0, 0.1, 1e300, "beyond the range of numbers"),
    (1.7e308, 0.1, 0.1, "beyond the range of numbers"),
    (1.0, 0.1, float("nan"), "communicationStepSize is nan"),
    (1.0, 0.7, 0.1, "currentCommunicationPoint is 0.7"),
]:
    before = part.get("modes.amplitude[1]", "modes.velocity[6]", "left.displacement.x")
    part.set("left.force.x", u)
    LOG.clear()
    assert part.status(t, h) == 2, "fmi2Discard expected"
    assert [s for s, m in LOG if word in m] == [3], LOG
    assert (part.get("modes.amplitude[1]", "modes.velocity[6]", "left.displacement.x") == before).all()
part.set("left.force.x", 1.0)
part.step(0.1 + 1e-12, 0.1)  # the same point to rounding
LOG.clear()
for name in ("left.displacement.x", "modes.frequency[1]", "modes.amplitude[1]", "der(modes.velocity[2])"):
    part.set(name, 5.0)
part.fmu.setReal([999], [1.0])
assert len(LOG) == 5 and all(s == 3 for s, _ in LOG), LOG
assert np.isnan(part.fmu.getReal([999])).all()
assert np.isnan(part.fmu.getReal([2**31, 2**32 - 1])).all()
before = part.everything()
LOG.clear()
part.fmu.setReal([2**32 - 1], [5.0])
part.fmu.setReal([0, 999], [5.0, 1.0])
part.fmu.setReal([0, part.vr["damping.alpha"]], [5.0, float("inf")])
part.fmu.setInteger([5], [1])
part.fmu.setInteger([0], [-1])
assert part.fmu.getInteger([0]) == [6] and part.fmu.getInteger([3]) == [6]
assert part.fmu.getBoolean([0]) == [0] and part.fmu.getString([0]) == [b""]
part.fmu.setBoolean([0], [1])
part.fmu.setString([0], ["x"])
part.fmu.setupExperiment(startTime=7.0)
assert (part.everything() == before).all()
assert len(LOG) == 11 and all(s == 3 for s, _ in LOG), LOG
part.fmu.setReal([0, part.vr["damping.alpha"], part.vr["damping.beta"]], [5.0, 0.25, 0.125])
assert part.get("left.force.x", "damping.alpha", "damping.beta").tolist() == [5.0, 0.25, 0.125]
late = Part(sys.argv[1], "late")
late.fmu.setupExperiment(startTime=float("nan"))
late.fmu.setupExperiment(startTime=3.0)
late.fmu.enterInitializationMode()
late.set("modes.amplitude[1]", float("nan"))
late.fmu.exitInitializationMode()
assert late.get("modes.amplitude[1]")[0] == 0.0
assert late.status(0.0, 0.1) == 2
late.step(3.0, 0.1)
print("ok")
"""


def test_illegal_calls_are_refused_with_a_reason(fmu: Path, tmp_path: Path) -> None:
    assert "ok" in run_master(PRELUDE + REFUSALS, fmu, cwd=tmp_path)


STATIC = """
part = Part(sys.argv[1])
part.fmu.enterInitializationMode()
part.fmu.setReal([0, 1, 2], [1.0, -2.0, 0.5])
q = [f"modes.amplitude[{i}]" for i in range(1, 7)]
inside = part.get(*q, "left.displacement.x")
part.fmu.exitInitializationMode()
start = part.get(*q, "left.displacement.x")
assert (inside == start).all()
state, before = part.fmu.getFMUState(), part.everything()
part.fmu.setFMUState(state)
assert (part.everything() == before).all()
part.step(0.0, 0.37)
later = part.get(*q, "left.displacement.x")
part = Part(sys.argv[1], "unread")
part.fmu.enterInitializationMode()
part.fmu.setReal([0, 1, 2], [1.0, -2.0, 0.5])
part.set("modes.amplitude[1]", 3.0)
part.fmu.exitInitializationMode()
part.fmu.setReal([0, 1, 2], [0.0, 0.0, 0.0])
print(json.dumps([x.tolist() for x in (start, later, part.get(*q, "left.displacement.x"))]))
"""


def test_static_start_is_equilibrium(tmp_path: Path) -> None:
    model = static_model()
    path = build_python_fmu(model, tmp_path / "settled.fmu")
    start, later, unread = json.loads(run_master(PRELUDE + STATIC, path, cwd=tmp_path))
    q = static_solution(model.lam, model.B @ [1.0, -2.0, 0.5]).q
    np.testing.assert_allclose(start, [*q, model.C[0] @ q], rtol=1e-14)  # one product of six terms
    np.testing.assert_allclose(later, start, rtol=1e-12)  # stays there to rounding
    assert unread == start
    moving = step(propagator(model.lam, 0 * model.lam, 0.37), at_rest(6), model.B @ [1.0, -2.0, 0.5])
    assert np.abs(moving.q - q).max() > 1e-3  # from rest it would not


TWO = """
values = {}
for path in sys.argv[1:]:
    part = Part(path).initialise(tip__force__x=1.0)
    part.step(0.0, 0.1)
    values[part.description.modelName] = part.get("tip.displacement.x")[0]
print(json.dumps(values))
"""


DRIVEN = """
part = Part(sys.argv[1])
names = [v.name for v in part.description.modelVariables if v.variability == "fixed"]
part.fmu.enterInitializationMode()
part.fmu.setReal([part.vr[name] for name in names], [1.0, 2.0, 3.0, 4.0])
states = [name.replace("start", "prescribed") for name in names]
assert part.get(*states).tolist() == [1.0, 2.0, 3.0, 4.0]
for name, value, word in [
    (names[0], float("nan"), "got a start of a prescribed motion of nan"),
    (states[1], 7.0, "is calculated"),
    (states[3], 7.0, "is calculated"),
]:
    LOG.clear()
    part.set(name, value)
    assert len(LOG) == 1 and LOG[0][0] == 3 and word in LOG[0][1], LOG
part.fmu.exitInitializationMode()
LOG.clear()
part.set(names[0], 7.0)
assert "before fmi2ExitInitializationMode" in LOG[0][1], LOG
part.set("left.motion.y", 6.0)
state = part.fmu.getFMUState()
part.step(0.0, 1.0)
assert np.allclose(part.get(*states), [1 + 3 + 3, 2 + 4, 3 + 6, 4], rtol=1e-15)
assert part.get(*names).tolist() == [1.0, 2.0, 3.0, 4.0]
after = part.everything()
part.fmu.setFMUState(state)
part.step(0.0, 1.0)
assert (part.everything() == after).all()
part.fmu.setInteger([0], [7])
assert part.fmu.getInteger([0]) == [6] and "0 … 6" in LOG[-1][1], LOG
print("ok")
"""


def test_a_driven_part(tmp_path: Path) -> None:
    """Starts are parameters, their states follow; the level of detail counts modes."""
    fmu = build_python_fmu(driven(k=2), tmp_path / "driven.fmu")
    assert "ok" in run_master(PRELUDE + DRIVEN, fmu, cwd=tmp_path)


def test_two_parts_in_one_process_in_both_orders(tmp_path: Path) -> None:
    soft, stiff = oscillator("soft", 1.0), oscillator("stiff", 400.0)
    paths = [build_python_fmu(model, tmp_path / f"{model.name}.fmu") for model in (soft, stiff)]
    expected = {}
    for model in (soft, stiff):
        f = model.B @ [1.0]
        after = step(propagator(model.lam, model.damping(model.alpha, 0.0), 0.1), at_rest(1), f)
        expected[model.name] = pytest.approx(float(model.C[0] @ after.q), rel=1e-14)
    assert abs(expected["soft"].expected / expected["stiff"].expected - 1) > 0.1
    for order in (paths, paths[::-1]):
        assert json.loads(run_master(PRELUDE + TWO, *order, cwd=tmp_path)) == expected


def test_initial_state_can_be_given(fmu: Path, tmp_path: Path) -> None:
    script = """
part = Part(sys.argv[1]).initialise(**{"modes.amplitude[3]": 0.25, "modes.velocity[6]": -2.0})
print(json.dumps(part.get("modes.amplitude[3]", "modes.velocity[6]", "left.displacement.x").tolist()))
"""
    C = two_ports().C
    got = json.loads(run_master(PRELUDE + script, fmu, cwd=tmp_path))
    assert got == [0.25, -2.0, pytest.approx(0.25 * C[0, 2], rel=1e-15)]


def test_energy_of_a_free_mode_is_kept(tmp_path: Path) -> None:
    """Undamped, 2000 steps far longer than a period: only rounding changes the energy."""
    model = oscillator(damping=0.0)
    path = build_python_fmu(model, tmp_path / "ideal.fmu")
    script = """
part = Part(sys.argv[1]).initialise(**{"modes.amplitude[1]": 1.0})
t, h = 0.0, 0.7
for _ in range(2000):
    part.step(t, h); t += h
print(json.dumps(part.get("modes.amplitude[1]", "modes.velocity[1]").tolist()))
"""
    q, v = json.loads(run_master(PRELUDE + script, path, cwd=tmp_path))
    # each step rotates with an error of a few ε(1 + ωh), which may add up
    assert abs(400.0 * q**2 + v**2 - 400.0) < 400 * 2000 * 4 * EPS * (1 + 20 * 0.7)
    exact = State(np.cos(20 * np.array([1400.0])), -20 * np.sin(20 * np.array([1400.0])))
    assert q == pytest.approx(float(exact.q[0]), abs=1e-9)  # 28 000 rad of phase in 2000 rounded steps
