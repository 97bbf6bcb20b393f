"""Endurance and load of the native FMU, in short; `python tests/endurance/run.py` is the long form."""

import sys

import numpy as np
import pytest
from endurance.energy import PLANS, THETA, endure, free_modes, growths
from endurance.kills import killed, uninterrupted
from endurance.programs import program, run, sanitized
from endurance.rotation import coefficients, growth
from examples import everything
from native_fmu import native_fmu

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="/proc, barriers of threads, SIGKILL")

STEPS = 300_000
WALK = 8  # standard deviations of independent roundings; those of a turning mode are a little alike
TURNS = [1, 4]  # π/50 and π/2 of the modes: fractions of a turn, whose roundings repeat


def everything_run(name: str, *arguments: object) -> dict[str, list[str]]:
    fmu = native_fmu(everything)
    return {line[0]: line[1:] for line in run(program(name), fmu, len(fmu.inputs), fmu.size, *arguments)}


# undamped modes
@pytest.mark.parametrize("plan", PLANS)
def test_energy_and_phase_are_those_of_the_rounded_rotation(plan: str) -> None:
    """Bounds that hold for any mode; where roundings do not repeat, expected to a random walk of theirs."""
    endured = endure(plan, STEPS)
    assert sum(endured.sizes.values()) == STEPS
    found = growths(endured)
    assert all(g.within_bounds for g in found)
    for k in set(range(len(THETA))) - set(TURNS):
        assert max(found[k].energy_walk, found[k].phase_walk) < WALK
    # the walk is seen only where what the coefficients do is larger by far
    assert max(abs(g.energy_expected) / g.steps**0.5 for g in found) > 10 * WALK * 2.0**-53


def test_a_coefficient_that_is_one_bit_off_is_noticed() -> None:
    """The control."""
    fmu = native_fmu(free_modes)
    endured = endure("1 ms", STEPS)
    ((h, E),) = coefficients(fmu, endured.sizes).items()
    (q, v), lam = endured.motion[STEPS], free_modes().lam
    for i in (0, 3, 5):
        off = E[:, :, i].copy()
        off[0, 0] = np.nextafter(off[0, 0], 2.0)
        found = growth(lam[i], {h: off}, endured.sizes, q[i], v[i])
        assert max(found.energy_walk, found.phase_walk) > 10 * WALK


def test_jitter_is_there() -> None:
    """Steps from one communication point to the next have many sizes, though all are 1 ms."""
    sizes = np.array([*endure("t(k+1) - t(k), 1 ms", STEPS).sizes])
    assert len(sizes) > 10
    np.testing.assert_allclose(sizes, 1e-3, rtol=1e-9)  # ε t/h


@pytest.mark.parametrize("plan", ["1 ms", "40 sizes, not all kept"])
def test_saves_and_restores_change_no_bit_and_hold_no_memory(plan: str) -> None:
    plain, saved = endure(plan, STEPS // 10), endure(plan, STEPS // 10, saves=200)
    assert plain.motion.keys() == saved.motion.keys()
    for k, motion in plain.motion.items():
        np.testing.assert_array_equal(saved.motion[k], motion)
    assert (plain.allocations, plain.bytes, plain.left) == (0, 0, 0)
    assert (saved.bytes, saved.left) == (0, 0)
    assert saved.allocations >= 2 * 180  # nine tenths of the saves, two or three states each
    assert max(plain.resident, saved.resident) <= 64  # kB: a first use of something costs a few pages


def test_a_state_that_is_not_restored_is_noticed() -> None:
    with pytest.raises(RuntimeError, match="where the last step ended"):
        endure("1 ms", 1000, saves=1, restore=False)


# many
def test_a_thousand_instances_are_each_as_if_alone() -> None:
    together, alone = (everything_run("crowd", 1000, 20, 1, how) for how in ("turns", "alone"))
    assert len(set(alone["seen"])) == 1000
    assert together["seen"] == alone["seen"]
    blocks = int(together["blocks"][0])
    assert blocks >= 1000
    assert blocks % 1000 == 0  # none is shared
    assert together["left"] == alone["left"] == ["0"]


def test_sixteen_threads() -> None:
    """Each steps instances of its own: no race, and they see what one thread sees."""
    path, fmu = sanitized("crowd", "ThreadSanitizer"), native_fmu(everything)
    if path is None:
        pytest.skip("no compiler with this sanitizer on this system")
    sizes = (len(fmu.inputs), fmu.size, 32, 60)
    assert run(path, fmu, *sizes, 16, "turns")[0] == run(path, fmu, *sizes, 1, "alone")[0]


def test_threads_in_one_instance_are_reported() -> None:
    """The control: what FMI forbids is a race inside the FMU, and ThreadSanitizer tells it."""
    path, fmu = sanitized("crowd", "ThreadSanitizer"), native_fmu(everything)
    if path is None:
        pytest.skip("no compiler with this sanitizer on this system")
    with pytest.raises(RuntimeError, match=r"data race(.|\n)*fmi2SetReal"):
        run(path, fmu, len(fmu.inputs), fmu.size, 16, 100, 16, "shared")


def test_memory_is_flat_over_lives_of_instances() -> None:
    told = {key: int(value) for key, (value,) in everything_run("memory", 200, 100).items()}
    assert (told["inside"], told["left"]) == (0, 0)
    assert told["states"] == 200 * 10
    one = int(everything_run("crowd", 1, 1, 1, "turns")["bytes"][0])
    assert told["largest"] < 1.05 * one  # an instance, and a state of less than a twentieth of it
    assert told["resident"] <= 64  # kB; one leaked instance would be as much


# the end of a process
def test_a_killed_process_is_resumed_by_another() -> None:
    steps = 60_000
    survived = killed(steps, kills=8)
    assert survived.last == uninterrupted(steps)
    assert survived.kills >= 4  # 8 where the machine is quick to kill
    assert survived.begun == sorted(survived.begun)
    assert survived.begun[-1] > 0  # not from the start, which would give the same
