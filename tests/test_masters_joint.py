"""Two beams joined rigidly: what fails at every step and why, orders, stable steps, gap, energy."""

from collections.abc import Iterator
from dataclasses import replace
from math import pi, sqrt

import numpy as np
import pytest
from fixed_point import NotConverged
from joint import DRIVEN, DRIVING, END, MODELS, Beams, Method, build, frequencies, full
from linear_part import state_space
from ready_parts import table
from run import points
from step_map import spectral_radius, step_map
from threadpoolctl import threadpool_limits

from fmu_src.runtime.model import Floats
from precompute.part import read_part
from precompute.pipeline import reduce_part

README = {row["master"]: row for row in table("joint", "master")}
PRESCRIBED = (
    ["tip.prescribed_displacement.z", "tip.prescribed_rotation.y"],
    ["tip.prescribed_velocity.z", "tip.prescribed_angular_velocity.y"],
)
WORKING = [name for name, row in README.items() if row["expected"] != "–"]


@pytest.fixture(scope="module")
def beams(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Beams]:
    with threadpool_limits(1):  # for matrices this small, threads take longer than the work
        yield build(tmp_path_factory.mktemp("joint"))


def named(beams: Beams, name: str) -> Method:
    return next(one for one in beams.methods() if one.name == name)


def test_both_beams_are_one_beam(beams: Beams) -> None:
    """All of K and M tied at the tips: a beam of 0.9 m clamped at both ends, β₁L = 4.730041.

    The clamps hold the section's shape and the mesh is coarse: 1.1 % above, as each beam by itself.
    """
    EI, mass = 210e9 * 0.03 * 0.02**3 / 12, 7850 * 0.03 * 0.02
    clamped = 4.730041**2 / (2 * pi * 0.9**2) * sqrt(EI / mass)
    lowest = [frequencies(body)[:3] for body in (full(), beams.motion.body, beams.forces.body)]
    printed = [[float(row[f"f{k} / Hz"]) for k in "₁₂₃"] for row in table("joint", "")]
    np.testing.assert_allclose(printed, lowest, atol=6e-3)  # two decimals
    found = lowest[0][0]
    assert 1.0 < found / clamped < 1.015
    for way, most in (
        (beams.motion, 0.04),
        (beams.forces, 0.07),
    ):  # what free modes make of a moment at the tip
        assert 0 < frequencies(way.body)[0] / found - 1 < most


def test_the_gain_of_the_joint(beams: Beams) -> None:
    """∂r/∂a ∂a/∂f of the FMUs' directional derivatives, at an instant: above 1."""
    D = []
    for fmu, (inputs, outputs) in zip(beams.motion.fmus, (DRIVING, DRIVEN), strict=True):
        fmu.restart()
        unknown = [fmu.reference[name] for name in outputs[4:]]
        D.append(
            [fmu.slave.getDirectionalDerivative(unknown, [fmu.reference[name]], [1.0]) for name in inputs]
        )
    gain = np.abs(np.linalg.eigvals(np.array(D[1]).T @ np.array(D[0]).T)).max()
    assert gain == pytest.approx(beams.gain, rel=1e-12)
    assert gain == pytest.approx(2.52, abs=0.005)  # the README's


@pytest.mark.parametrize("name", ["Jacobi, hold", "Gauss–Seidel, hold"])
def test_a_gain_above_one_is_unstable_at_any_step(beams: Beams, name: str) -> None:
    """A force comes back as gain times itself, in one step where its answer is used at once, in two else."""
    method = named(beams, name)
    growth = beams.gain if name.startswith("Gauss") else sqrt(beams.gain)
    h = 1e-7
    assert method.radius(h) == pytest.approx(growth, rel=1e-3)  # of ωh
    start = {f"modes.velocity[{i}]": 1.0 for i in range(1, 5)}
    forces = [np.abs(point.y[10]) for point in points(method.way.system(start), method.step(), "hold", h, 30)]
    assert (forces[30] / forces[10]) ** (1 / 20) == pytest.approx(growth, rel=1e-2)
    assert named(beams, name.replace("hold", "linear")).radius(h) > growth  # extrapolated it is worse
    # if the reaction came back by a third, all would be well: 1 is the double root of where both parts are
    weak = method.way.L * np.array([1 / 3, 1 / 3, 1, 1])[:, None]
    M = step_map(method.way.spaces, weak, method.step(), "hold", h)
    assert spectral_radius(M) == pytest.approx(1.0, abs=1e-3)
    assert {README[one]["largest stable h / ms"] for one in README if one not in WORKING} == {"none"}


def test_a_gain_above_one_is_no_contraction(beams: Beams) -> None:
    for kind in ("hold", "linear"):
        method = named(beams, f"fixed point, {kind}")
        with pytest.raises(NotConverged):
            method.run(1e-6, 3, {"modes.velocity[1]": 1.0})


def test_held_accelerations_are_unstable_at_any_step(beams: Beams) -> None:
    """ρ = 1 + 7 (h/ms)² as in the README: a lag by half a step, with which energy comes in."""
    method = named(beams, "interface Newton, hold")
    growth = np.array([method.radius(h) - 1 for h in (2e-6, 4e-6, 8e-6)])
    assert growth / np.array([2e-6, 4e-6, 8e-6]) ** 2 == pytest.approx(7e6, rel=0.05)


def test_a_rigid_joint_without_damping_is_unstable_if_slowly(beams: Beams) -> None:
    """ρ = 1 + 23 (h/ms)⁴ as in the README: what it is stable by is the damping of the beams."""
    models = [reduce_part(read_part(MODELS / "joint" / f"{name}.toml")).model for name in ("left", "right")]
    bare = [
        state_space(replace(model, alpha=0.0, beta=0.0), *names)
        for model, names in zip(models, (DRIVING, DRIVEN), strict=True)
    ]
    way, h = replace(beams.motion, spaces=bare), np.array([1.25e-5, 2.5e-5, 5e-5])
    method = replace(named(beams, "rigid joint"), way=way)
    growth = np.array([method.radius(one) - 1 for one in h])
    assert growth / h**4 == pytest.approx(23.3e12, rel=0.03)
    assert named(beams, "rigid joint").radius(h[-1]) < 1


@pytest.mark.parametrize("name", WORKING)
def test_order(beams: Beams, name: str) -> None:
    """Against the exponential of both models tied at their ports."""
    method = named(beams, name)
    assert method.order == int(README[name]["expected"]) == 2
    errors = [method.error(END / count, count) for count in (400, 800, 1600)]
    assert errors[1] == pytest.approx(float(README[name]["error, h = 25 µs"]), rel=0.06)  # two digits
    assert np.log2(errors[0] / errors[1]) == pytest.approx(float(README[name]["order"]), abs=0.006)
    assert np.log2(errors[1] / errors[2]) == pytest.approx(2.0, abs=0.1)  # ωh = 0.4 of the fastest mode


def states(method: Method, h: float, count: int) -> Iterator[Floats]:
    """z = x of both FMUs, their inputs, y at the point before."""
    before, x = None, []
    for fmu in method.way.fmus:
        r = sum(name.startswith("modes.amplitude[") for name in fmu.reference)
        modes = [[f"modes.{what}[{i + 1}]" for i in range(r)] for what in ("amplitude", "velocity")]
        moved = PRESCRIBED if PRESCRIBED[0][0] in fmu.reference else ([], [])
        x.append([*moved[0], *modes[0], *moved[1], *modes[1]])
    rng = np.random.default_rng(5)
    start = {f"modes.velocity[{i}]": rng.standard_normal() for i in range(1, 5)}
    system = method.way.system(start, lambda t: 0.0)
    for point in points(system, method.step(), method.kind, h, count):
        inputs = [fmu.slave.getReal(fmu.inputs) for fmu in method.way.fmus]
        found = [fmu.get(*names) for fmu, names in zip(method.way.fmus, x, strict=True)]
        yield np.concatenate([*found, *inputs, point.y if before is None else before])
        before = point.y


@pytest.mark.parametrize("name", ["interface Newton, linear", "rigid joint"])
def test_the_fmus_are_stable_up_to_the_predicted_step(beams: Beams, name: str) -> None:
    """The critical motion decays 0.5 % below the README's step, grows 0.5 % above it."""
    method, limit = named(beams, name), 1e-3 * float(README[name]["largest stable h / ms"])
    for h, grows in ((0.995 * limit, False), (1.005 * limit, True)):
        M = step_map(method.way.spaces, method.way.L, method.step(), method.kind, h)
        lam, W = np.linalg.eig(M.T)
        # beside the drift of the ports, a double root 1 of masters that ask for accelerations only
        critical = np.argmax(np.where(np.abs(lam - 1) < 1e-5, 0.0, np.abs(lam)))
        z = np.array([*states(method, h, 60)]) @ W[:, critical]
        found = np.abs(z[-1] / z[20]) ** (1 / 40)
        assert found == pytest.approx(np.abs(lam[critical]), rel=1e-7)
        assert (found > 1) == grows


def test_the_ports_stay_together(beams: Beams) -> None:
    """Displacements and velocities of a rigid joint, to rounding; accelerations alone let the ports part."""
    for name in ("rigid joint", "power bond"):
        assert named(beams, name).gap(END / 400, 400) < 1e-14
    joint = named(beams, "rigid joint").run(END / 400, 400)
    np.testing.assert_allclose(joint[:, 8:10], joint[:, 2:4], atol=1e-13 * np.abs(joint[:, 2:4]).max())
    apart = named(beams, "interface Newton, linear").gap(END / 800, 800)
    assert apart == pytest.approx(float(README["interface Newton, linear"]["gap"]), rel=0.06)
    assert apart > 1e-4


def test_a_rigid_bond_makes_no_energy(beams: Beams) -> None:
    """To rounding, at steps of an eightieth and of three times the first period; others do."""
    bond = named(beams, "power bond")
    for h, count in ((1e-4, 200), (2.5e-2, 40)):
        assert bond.drift(h, count, {"modes.velocity[1]": 1.0}) < 1e-12
    for h in np.geomspace(1e-6, 10.0, 30):
        assert bond.radius(h) <= 1 + 1e-9
    assert README["power bond"]["largest stable h / ms"] == "any"
    for name in ("rigid joint", "interface Newton, linear"):
        drift = named(beams, name).drift(END / 800, 800)
        assert drift == pytest.approx(float(README[name]["energy drift"]), rel=0.06)
        assert drift > 1e-7
