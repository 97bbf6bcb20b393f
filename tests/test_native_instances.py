"""Many instances of native FMUs in one process: kept apart, each with its own log and resources."""

import ctypes
import itertools
import shutil
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any
from urllib.parse import quote

import numpy as np
import pytest
from examples import oscillator, two_ports
from native_fmu import (
    CO_SIMULATION,
    DISCARD,
    ERROR,
    MODEL_EXCHANGE,
    OK,
    Host,
    Instance,
    NativeFmu,
    alone,
    native_fmu,
)
from native_modes import MODES, Memory, instance_in

from fmu_src.runtime.model import Floats

STEPS = 60


def steps(x: Instance, seed: int, count: int = STEPS) -> Iterator[Floats]:
    """Make one random step after the other, and give what all Reals are then."""
    rng, t = np.random.default_rng(seed), 0.0
    sizes = rng.uniform(1e-3, 0.1, 3)
    x.initialise()
    for _ in range(count):
        h = rng.choice(sizes)
        assert x.set_real(x.fmu.inputs, rng.normal(size=len(x.fmu.inputs))) == OK
        if rng.random() < 0.1:
            assert x.set({"damping.alpha": rng.uniform()}) == OK
        assert x.step(t, h) == OK
        t += h
        yield x.reals()


def run(fmu: NativeFmu, seed: int, count: int = STEPS) -> Floats:
    x = fmu.instance()
    seen = np.array([*steps(x, seed, count)])
    x.free()
    return seen


# apart from each other
def test_instances_that_take_turns() -> None:
    """Of two parts, and of one part in two versions, which have the same names."""
    fmus = [native_fmu(two_ports), native_fmu(two_ports, alpha=0.7), native_fmu(oscillator)]
    chosen = [(fmu, seed) for seed in range(10) for fmu in fmus]
    expected = [run(fmu, seed) for fmu, seed in chosen]
    instances = [fmu.instance() for fmu, _ in chosen]
    turns = zip(*(steps(x, seed) for x, (_, seed) in zip(instances, chosen, strict=True)), strict=True)
    seen = [[*reals] for reals in turns]
    for k, one in enumerate(expected):
        np.testing.assert_array_equal([reals[k] for reals in seen], one)
    assert not np.array_equal(expected[0], expected[1])
    for x in instances:
        x.free()


def test_another_part_in_the_process_changes_nothing() -> None:
    for make in (two_ports, oscillator):
        np.testing.assert_array_equal(alone(_run_alone, make), run(native_fmu(make), 1))


def _run_alone(make: Any) -> Floats:
    return run(native_fmu(make), 1)


def test_threads() -> None:
    """Eight threads, each with instances of its own, some of the same FMU."""
    fmus = [native_fmu(two_ports), native_fmu(two_ports, alpha=0.7), native_fmu(oscillator)]
    chosen = [(fmus[k % 3], k) for k in range(24)]
    expected = [run(fmu, seed, 300) for fmu, seed in chosen]
    with ThreadPoolExecutor(8) as threads:
        seen = [*threads.map(lambda one: run(one[0], one[1], 300), chosen)]
    for one, alone_ in zip(seen, expected, strict=True):
        np.testing.assert_array_equal(one, alone_)


def test_instances_end_in_any_order() -> None:
    memory = Memory()
    for order in itertools.permutations(range(3)):
        instances = [native_fmu(two_ports).instance(host=memory.host()).initialise() for _ in range(3)]
        for k in order:
            instances[k].free()
            assert all(x.step(0.0, 0.1) == OK and x.restore(x.save()) == OK for x in _left(instances))
            for x in _left(instances):
                x.must("Reset")
                x.initialise()
    assert memory.balanced


def _left(instances: list[Instance]) -> list[Instance]:
    return [x for x in instances if x.component]


@pytest.mark.parametrize(("kind", "mode"), [(kind, mode) for kind in MODES for mode in MODES[kind]])
def test_an_instance_ends_in_any_mode(kind: int, mode: str) -> None:
    memory = Memory()
    x = instance_in(kind, mode, memory.host())
    assert memory.live
    x.free()
    assert memory.balanced


def test_a_terminated_instance_runs_again_after_a_reset() -> None:
    x = native_fmu(two_ports).instance()
    first = np.array([*steps(x, 4)])
    x.must("Terminate")
    np.testing.assert_array_equal(x.reals(), first[-1])
    x.must("Reset")
    np.testing.assert_array_equal(np.array([*steps(x, 4)]), first)
    x.free()


# the log
def talk(x: Instance) -> set[str]:
    """The categories of what is said about a new step size, a step beyond the numbers, a wrong step."""
    x.log.clear()
    x.must("Reset")
    x.initialise()
    assert x.step(0.0, 0.1) == OK
    assert x.set({"left.force.x": 1e308}) == OK
    assert x.step(0.1, 1e6) == DISCARD
    assert x.step(0.1, -1.0) == ERROR
    return {message.category for message in x.log}


ALL = {"logStepSizes", "logStatusDiscard", "logStatusError"}


def names(*categories: str) -> tuple[int, Any]:
    return len(categories), (ctypes.c_char_p * len(categories))(*(name.encode() for name in categories))


def test_what_is_told_without_debug_logging() -> None:
    """Errors only: a discarded step is told in debug mode (FMI 2.0.4, section 2.1.3)."""
    x = native_fmu(two_ports).instance(logging=False)
    assert x.log == []
    assert talk(x) == {"logStatusError"}
    x.must("SetDebugLogging", 1, 0, None)
    assert talk(x) == ALL
    x.must("SetDebugLogging", 0, 0, None)
    assert talk(x) == {"logStatusError"}
    x.free()


@pytest.mark.parametrize("category", sorted(ALL))
def test_one_category(category: str) -> None:
    x = native_fmu(two_ports).instance(logging=False)
    x.must("SetDebugLogging", 1, *names(category))
    assert talk(x) == {category, "logStatusError"}
    x.must("SetDebugLogging", 1, *names("logAll"))
    x.must("SetDebugLogging", 0, *names(category))
    assert talk(x) == ALL - {category} | {"logStatusError"}
    x.free()


def test_categories_add_up() -> None:
    x = native_fmu(two_ports).instance(logging=False)
    x.must("SetDebugLogging", 1, *names("logStepSizes"))
    x.must("SetDebugLogging", 1, *names("logStatusDiscard"))
    assert talk(x) == ALL
    x.free()


def test_the_categories_are_those_of_the_description() -> None:
    declared = {category.name for category in native_fmu(two_ports).description.logCategories}
    x = native_fmu(two_ports).instance()
    assert {message.category for message in x.log} == {"logModel"}
    assert ALL | {"logModel", "logAll"} == declared
    x.must("SetDebugLogging", 1, *names(*declared))
    x.free()


@pytest.mark.parametrize("wrong", ["logEvents", "", "logstatuserror", "%s"])
def test_a_category_that_is_not_there(wrong: str) -> None:
    x = native_fmu(two_ports).instance(logging=False)
    assert x.call("SetDebugLogging", 1, *names("logStepSizes", wrong)) == ERROR
    assert wrong in x.log[0].text
    x.log.clear()
    assert talk(x) == {"logStatusError"}  # the first one was not switched on
    assert x.call("SetDebugLogging", 1, 1, (ctypes.c_char_p * 1)(None)) == ERROR
    x.free()


def test_a_step_size_is_told_once() -> None:
    x = native_fmu(two_ports).instance().initialise()
    x.log.clear()
    for k in range(4):
        assert x.step(0.25 * k, 0.25) == OK
    assert [message.text for message in x.log if "0.25" in message.text] == [x.log[0].text]
    assert len(x.log) == 1
    x.free()


def test_each_instance_has_its_own_log() -> None:
    hosts = [Host(), Host()]
    one, two = (
        native_fmu(two_ports).instance(name=n, host=h) for n, h in zip((b"one", b"two"), hosts, strict=True)
    )
    one.must("SetDebugLogging", 0, 0, None)
    for x in (one, two):
        x.initialise()
        assert x.step(0.0, 0.1) == OK
    assert [m.instance for m in hosts[0].log] == ["one"]
    assert [m.instance for m in hosts[1].log] == ["two", "two"]
    one.free()
    two.free()


# the resources
FOLDERS = ["with space", "per%20cent %", "größe ∞ 模型", "a#b?c=d&e", "semi;colon,[x]{y}~@!$'()+", "a" * 200]


@pytest.mark.parametrize("name", FOLDERS)
def test_folders_of_any_name(name: str, tmp_path: Path) -> None:
    folder = tmp_path / name / "fmu"
    shutil.copytree(native_fmu(two_ports).folder, folder)
    fmu = NativeFmu(folder)
    path = quote(str(folder / "resources"))
    expected = run(native_fmu(two_ports), 2, 5)
    for uri in (fmu.resources, f"file://{path}/", f"file:{path}", f"file:{path}/", f"file://localhost{path}"):
        x = fmu.instance(resources=uri.encode())
        np.testing.assert_array_equal(np.array([*steps(x, 2, 5)]), expected)
        x.free()


@pytest.mark.parametrize(
    "file", ["guid.txt", *(f"model/{name}" for name in ("model.json", "model.sha256", "lam.npy", "C.npy"))]
)
@pytest.mark.parametrize("fault", ["missing", "empty", "cut off", "too long", "flipped", "folder"])
def test_resources_that_are_not_whole(file: str, fault: str, tmp_path: Path) -> None:
    resources = tmp_path / "resources"
    shutil.copytree(native_fmu(two_ports).folder / "resources", resources)
    place = resources / file
    content = place.read_bytes()
    place.unlink()
    if fault == "folder":
        place.mkdir()
    elif fault != "missing":
        changed = {"empty": b"", "cut off": content[:-9], "too long": content + 9 * b"x"}
        changed["flipped"] = content[:30] + bytes([content[30] ^ 1]) + content[31:]
        place.write_bytes(changed[fault])
    memory = Memory()
    host = memory.host()
    assert native_fmu(two_ports).instantiate(host=host, resources=resources.as_uri().encode()) is None
    (message,) = host.log
    assert message.status == ERROR
    assert "GUID" in message.text or Path(file).name in message.text
    assert memory.balanced


@pytest.mark.parametrize("kind", [MODEL_EXCHANGE, CO_SIMULATION])
def test_the_resources_of_another_fmu(kind: int) -> None:
    """The GUID tells them apart, though both have the same variables."""
    one, other = native_fmu(two_ports), native_fmu(two_ports, alpha=0.7)
    host = Host()
    assert one.instantiate(kind, resources=other.resources.encode(), host=host) is None
    assert other.guid in host.log[0].text
    assert one.guid in host.log[0].text
