"""Two beams whose tips are joined rigidly, in displacement and rotation: one beam, clamped at both ends.

Run `python tests/masters/joint.py [FOLDER]`: prints the table of models/joint/README.md, draws its picture.
"""

import sys
import tempfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from math import pi
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from body import Body, full_body, reduced_body, tied, together
from coupled import Coupled, Linear
from extrapolation import Kind
from fixed_point import fixed_point
from fmu import Fmu
from gauss_seidel import gauss_seidel
from interface_newton import interface_newton
from jacobi import jacobi
from linear_part import StateSpace, state_space
from markdown import largest, markdown
from monolith import Monolith, Signal, driven, monolith, output, trajectory
from rigid_bond import rigid_bond
from rigid_joint import Joint, rigid_joint
from run import Step, points, run
from scipy.linalg import block_diag, eigh
from step_map import largest_stable_step, spectral_radius, step_map

from fmu_src.runtime.model import Floats, ReducedModel
from precompute.part import read_part
from precompute.pipeline import package, reduce_part

MODELS = Path(__file__).resolve().parents[2] / "models"
X, V = ["tip.displacement.z", "tip.rotation.y"], ["tip.velocity.z", "tip.angular_velocity.y"]
A, R = ["tip.acceleration.z", "tip.angular_acceleration.y"], ["tip.reaction.z", "tip.reaction_moment.y"]
FORCES, MOTIONS = ["tip.force.z", "tip.moment.y"], ["tip.motion.z", "tip.angular_motion.y"]
DRIVING, DRIVEN = (FORCES, X + V + A), (MOTIONS, X + V + R)
JOINT = Joint(*(slice(k, k + 2) for k in (0, 2, 6, 8, 10)))
TIES = [("left.tip.z", "right.tip.z"), ("left.tip.ry", "right.tip.ry")]
FORCE, PULSE = 100.0, 0.01  # N, s: F(1 − cos 2πt/T) on the joint for one period
END, COUNTS = 0.02, (100, 200, 400, 800)  # s, numbers of steps
CONJUGATE = np.vstack([np.eye(2), -np.eye(2)])  # f on the left part, −f on the right one: u = e − W f
UNDAMPED: Mapping[str, float] = {"damping.alpha": 0.0, "damping.beta": 0.0}


def pulse(t: float) -> float:
    """The force on the joint in N."""
    return FORCE * (1 - np.cos(2 * pi * t / PULSE)) if t < PULSE else 0.0


@dataclass(frozen=True, eq=False)
class Way:
    """Two FMUs, what they are by matrices and as one body, and the law u = L y + e of their joint."""

    fmus: tuple[Fmu, Fmu]
    spaces: list[StateSpace]
    L: Floats
    body: Body

    def system(
        self, start: Mapping[str, float] | None = None, force: Callable[[float], float] = pulse
    ) -> Coupled:
        """Both FMUs at t = 0."""
        for fmu in self.fmus:
            fmu.restart(start)

        def pushed(t: float, order: int) -> Floats:
            if order > 0:
                raise ValueError(
                    "got inputs by derivatives, which the force has none of; hold them or take linear"
                )
            return np.array([force(t), 0.0, 0.0, 0.0])

        return Coupled(self.fmus, Linear(self.L, pushed))

    @cached_property
    def whole(self) -> Monolith:
        """The body under the pulse."""
        w = 2 * pi / PULSE
        turn = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, w], [0.0, -w, 0.0]])
        start, row = np.array([1.0, 1.0, 0.0]), FORCE * np.array([1.0, -1.0, 0.0])
        return driven(monolith(self.body), {"left.tip.force.z": Signal(turn, start, row)})

    def exact(self, h: float, count: int) -> Floats:
        """The joint's displacement after each of an even number of steps, the pulse in the first half."""
        first = trajectory(self.whole, h, count // 2)
        free = first[-1].copy()
        free[-3:] = 0.0  # no force any more
        rest = trajectory(replace(self.whole, x0=free), h, count // 2)
        return output(self.whole, np.concatenate([first, rest[1:]]), "left.tip.displacement.z")

    @property
    def gap(self) -> Floats:
        """x₁ − x₂ = G y (2, p)."""
        G = np.zeros((2, self.L.shape[1]))
        G[:, JOINT.x], G[:, JOINT.s] = np.eye(2), -np.eye(2)
        return G


@dataclass(frozen=True)
class Method:
    """A master on one of the ways to join; order: that it must have, none where it must fail."""

    name: str
    way: Way
    kind: Kind
    step: Callable[[], Step]
    order: int | None

    def run(self, h: float, count: int, start: Mapping[str, float] | None = None) -> Floats:
        """y at all points (count + 1, p)."""
        return run(self.way.system(start), self.step(), self.kind, h, count)[1]

    def error(self, h: float, count: int) -> float:
        """The largest error of the joint's displacement, of its peak."""
        exact = self.way.exact(h, count)
        return float(np.abs(self.run(h, count)[:, 0] - exact).max() / np.abs(exact).max())

    def gap(self, h: float, count: int) -> float:
        """How far the ports part in z, of the joint's peak."""
        y = self.run(h, count)
        return float(np.abs(y @ self.way.gap[0]).max() / np.abs(y[:, 0]).max())

    def drift(self, h: float, count: int, start: Mapping[str, float] | None = None) -> float:
        """By how much T + V of both parts changes in the second half, nothing damped, relatively."""
        energy = [
            sum(fmu.get("energy.kinetic", "energy.strain").sum() for fmu in self.way.fmus)
            for _ in points(self.way.system({**UNDAMPED, **(start or {})}), self.step(), self.kind, h, count)
        ]
        free = np.array(energy[count // 2 :])  # of the pulse
        return float(np.abs(free / free[0] - 1).max())

    def radius(self, h: float) -> float:
        """The spectral radius of a step."""
        return spectral_radius(step_map(self.way.spaces, self.way.L, self.step(), self.kind, h))

    def stable(self, lowest: float = 1e-5, highest: float = 4e-3) -> float:
        """The largest stable step in s; 1 is a double root where ports drift apart, which √ε splits."""
        return largest_stable_step(self.radius, lowest, highest, 1.005, margin=1e-6)


@dataclass(frozen=True, eq=False)
class Beams:
    """Both ways: the right part driven by motion, or by forces."""

    motion: Way
    forces: Way

    def methods(self) -> list[Method]:
        """All masters that a rigid joint can have."""
        on = {
            "Jacobi": jacobi,
            "Gauss–Seidel": gauss_seidel,
            "fixed point": fixed_point,
            "interface Newton": interface_newton,
        }
        found = [
            Method(
                f"{name}, {kind}",
                self.motion,
                kind,
                lambda make=make, kind=kind: make(kind),
                2 if (name, kind) == ("interface Newton", "linear") else None,
            )
            for name, make in on.items()
            for kind in ("hold", "linear")
        ]
        bond = Method("power bond", self.forces, "hold", lambda: rigid_bond(self.forces.gap, CONJUGATE), 2)
        return [*found, Method("rigid joint", self.motion, "linear", lambda: rigid_joint(JOINT), 2), bond]

    @property
    def gain(self) -> float:
        """The largest eigenvalue of ∂r/∂a ∂a/∂f at an instant: what comes back of a force at once."""
        first, second = (space.D for space in self.motion.spaces)
        return float(np.abs(np.linalg.eigvals(second[4:] @ first[4:])).max())


def build(folder: Path) -> Beams:
    """The three parts reduced and packaged, both ways put together."""
    models, paths = {}, {}
    for name in ("left", "right", "forced"):
        reduction = reduce_part(read_part(MODELS / "joint" / f"{name}.toml"))
        models[name], paths[name] = reduction.model, package(reduction, folder / f"{name}.fmu")

    def way(second: str, variables: tuple[list[str], list[str]], L: Floats, body: Body) -> Way:
        both = (("left", DRIVING), (second, variables))
        fmus = tuple(Fmu(paths[name], *names) for name, names in both)
        spaces = [state_space(models[name], *names) for name, names in both]
        return Way(fmus, spaces, L, tied(together({"left": _free(models["left"]), "right": body}), TIES))

    L = np.zeros((4, 12))  # f = −r, a = a of the left part
    L[:2, JOINT.reaction], L[2:, 4:6] = -np.eye(2), np.eye(2)
    motion = way("right", DRIVEN, L, driven_body(models["right"]))
    return Beams(motion, way("forced", DRIVING, np.zeros((4, 12)), _free(models["forced"])))


def _free(model: ReducedModel) -> Body:
    """Without its energies, which are no ports."""
    return reduced_body(replace(model, ports=tuple(port for port in model.ports if port.name == "tip")))


def driven_body(model: ReducedModel) -> Body:
    """The part behind the reactions: M = [M_s Pᵀ; P I], K = [K_s 0; 0 Λ], P = −B_a, its port free to move."""
    k, P = model.k, -model.B[model.k :, model.motions]
    M = np.block([[model.M_s, P.T], [P, np.eye(model.r)]])
    K = block_diag(model.K_s, np.diag(model.lam[k:]))
    ports = dict(zip(("tip.z", "tip.ry"), np.eye(len(M)), strict=False))
    return Body(M, model.alpha * M + model.beta * K + model.D_rest, K, ports)


def frequencies(body: Body) -> Floats:
    """Of the undamped body in Hz, ascending."""
    return np.sqrt(eigh(body.K, body.M, eigvals_only=True)) / (2 * pi)


def full() -> Body:
    """Both meshes as one, every degree of freedom."""
    parts = {
        n: full_body(read_part(MODELS / "joint" / f"{p}.toml"))
        for n, p in (("left", "left"), ("right", "forced"))
    }
    return tied(together(parts), TIES)


def row(method: Method, h: float, count: int) -> dict[str, str]:
    """A line of the README's table: of a master that must fail its largest stable step only."""
    stable, error = method.stable(), f"error, h = {1e6 * h:g} µs"
    found = {"master": method.name, error: "–", "order": "–", "expected": "–"}
    found["largest stable h / ms"] = largest(stable, 1e-3) if stable else "none"
    if method.order is None:
        return {**found, "gap": "–", "energy drift": "–"}
    wrong = [method.error(END / n, n) for n in (count // 2, count)]
    found |= {error: f"{wrong[1]:.1e}", "order": f"{np.log2(wrong[0] / wrong[1]):.2f}"}
    found["expected"] = f"{method.order}"
    return {**found, "gap": f"{method.gap(h, count):.1e}", "energy drift": f"{method.drift(h, count):.1e}"}


def draw(methods: list[Method], path: Path) -> None:
    """Errors over step sizes; how far the ports part over time."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4), layout="constrained")
    h = np.array([END / count for count in COUNTS])
    for method in methods:
        left.loglog(1e6 * h, [method.error(END / n, n) for n in COUNTS], label=method.name, linewidth=1.2)
        y = method.run(END / COUNTS[1], COUNTS[1])
        t = 1e3 * END / COUNTS[1] * np.arange(len(y))
        gap = np.abs(y @ method.way.gap[0])
        right.semilogy(t[1:], 1e6 * np.maximum(gap[1:], 1e-19), linewidth=1.2)
    left.set_xticks(1e6 * h, [f"{1e6 * one:g}" for one in h])
    left.minorticks_off()
    left.set(xlabel="h / µs", ylabel="largest error / peak")
    left.legend(fontsize="small")
    right.set(xlabel="t / ms", ylabel="gap between the ports / µm")
    right.set_title(f"h = {1e6 * h[1]:g} µs", fontsize="medium")
    for axes in (left, right):
        axes.grid(alpha=0.3)
    figure.savefig(path, dpi=80)


def main(folder: Path) -> None:
    """Build, couple, compare."""
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as fmus:
        beams = build(Path(fmus))
        print(markdown([row(method, END / COUNTS[-1], COUNTS[-1]) for method in beams.methods()]))
        print(f"\nWhat comes back of a force at once: {beams.gain:.3g} times itself.")
        for name, body in ("motion", beams.motion.body), ("forces", beams.forces.body), ("full", full()):
            print(f"{name}: {', '.join(f'{f:.2f}' for f in frequencies(body)[:3])} Hz")
        draw([method for method in beams.methods() if method.order is not None], folder / "joint.png")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path("out"))
