"""Two beams whose tips a spring and a damper join, a force on one of them from t = 0.

Run `python tests/masters/pair.py [FOLDER]`: prints the table of models/pair/README.md, draws its picture.
"""

import sys
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from body import full_body, joined, modal, reduced_body, together
from coupled import Coupled, Linear
from extrapolation import ORDER
from fmu import Fmu
from jacobi import jacobi
from linear_part import StateSpace, state_space
from markdown import markdown
from monolith import Monolith, after, driven, monolith, output, polynomial, trajectory
from power_bond import Bonds, power_bond, stored
from run import points, run
from step_doubling import Control, step_doubling
from step_map import largest_stable_step, spectral_radius, step_map
from table import Algorithm, Row, algorithms, cells, draw_errors, errors

from fmu_src.runtime.model import Floats, ReducedModel
from precompute.part import read_part
from precompute.pipeline import package, reduce_part

MODELS = Path(__file__).resolve().parents[2] / "models"
NAMES = ("left", "right")
INPUTS, OUTPUTS = ["tip.force.z"], ["tip.displacement.z", "tip.velocity.z"]
STIFFNESS, DAMPING = 5e4, 20.0  # N/m, N·s/m
FORCE = 100.0  # N, on the left tip from t = 0
END, COUNTS = 0.02, (50, 100, 200, 400, 800)  # s: 1.4 periods of the left beam; numbers of steps
MODES = 40  # of the full system, which has 936 degrees of freedom
SHOWN = ("Jacobi, linear", "Gauss–Seidel, linear", "fixed point, linear", "power bond")
TOLERANCES = (1e-4, 1e-6, 1e-8)
UNDAMPED = {"damping.alpha": 0.0, "damping.beta": 0.0}


@dataclass(frozen=True, eq=False)
class Pair:
    """The reduced models and the FMUs of both parts, joined by k in N/m and c in N·s/m.

    u = (F, F), y = (x, v, x, v), left before right.
    """

    models: Mapping[str, ReducedModel]
    fmus: tuple[Fmu, Fmu]
    k: float = STIFFNESS
    c: float = DAMPING

    @property
    def L(self) -> Floats:
        """u = L y: −k δ − c δ̇ on the left tip, the opposite on the right one; δ = x_left − x_right."""
        row = np.array([-self.k, -self.c, self.k, self.c])
        return np.stack([row, -row])

    @property
    def bonds(self) -> Bonds:
        """The same as a bond."""
        G, W = np.array([[1.0, 0.0, -1.0, 0.0]]), np.array([[1.0], [-1.0]])
        return Bonds(G, W, np.array([self.k]), np.array([self.c]))

    @cached_property
    def spaces(self) -> list[StateSpace]:
        """Both parts by matrices."""
        return [state_space(self.models[name], INPUTS, OUTPUTS) for name in NAMES]

    def system(self, force: float = FORCE, start: Mapping[str, float] | None = None) -> Coupled:
        """Both FMUs at t = 0, under a constant force on the left tip."""
        for fmu in self.fmus:
            fmu.restart(start)
        return Coupled(self.fmus, Linear(self.L, lambda t, order: np.array([force * (order == 0), 0.0])))

    @cached_property
    def free(self) -> Monolith:
        """Both models as one, no force."""
        ports = {n: tuple(p for p in m.ports if p.name == "tip") for n, m in self.models.items()}
        bodies = {n: reduced_body(replace(m, ports=ports[n])) for n, m in self.models.items()}
        joint = joined(together(bodies), "left.tip.z", "right.tip.z", self.k, self.c)
        return monolith(joint)

    @cached_property
    def whole(self) -> Monolith:
        """The same under the force."""
        return driven(self.free, {"left.tip.force.z": polynomial(FORCE)})

    def masters(self) -> list[Algorithm]:
        """All of them."""
        return [*algorithms(), Algorithm("power bond", "hold", 2, lambda: power_bond(self.bonds))]

    def error(self, algorithm: Algorithm, h: float, count: int) -> float:
        """The largest error of the left tip's displacement over `count` steps, of its peak."""
        _, y = run(self.system(), algorithm.step(), algorithm.kind, h, count)
        exact = output(self.whole, trajectory(self.whole, h, count), "left.tip.displacement.z")
        return float(np.abs(y[:, 0] - exact).max() / np.abs(exact).max())

    def radius(self, algorithm: Algorithm, h: float) -> float:
        """The spectral radius of a step h."""
        return spectral_radius(step_map(self.spaces, self.L, algorithm.step(), algorithm.kind, h))

    def stable(self, algorithm: Algorithm, lowest: float = 2e-4, highest: float = 0.01) -> float:
        """The largest stable step in s."""
        return largest_stable_step(lambda h: self.radius(algorithm, h), lowest, highest)

    def inside(self) -> float:
        """T + V of both parts as they are, J."""
        return float(sum(fmu.get("energy.kinetic", "energy.strain").sum() for fmu in self.fmus))

    def energy(self, algorithm: Algorithm, h: float, count: int) -> Floats:
        """T + V of both parts and ½kδ² less the work of the force, of the largest T + V, (count + 1,).

        The parts are without damping: it is 0 where c = 0, if the coupling makes no energy.
        """
        system = self.system(start=UNDAMPED)
        inside, y = [], []
        for point in points(system, algorithm.step(), algorithm.kind, h, count):
            inside.append(self.inside())
            y.append(point.y)
        found: Floats = inside + stored(self.bonds, np.array(y)) - FORCE * np.array(y)[:, 0]
        return found / max(inside)


def build(folder: Path) -> Pair:
    """Both parts reduced and packaged."""
    reductions = {name: reduce_part(read_part(MODELS / "pair" / f"{name}.toml")) for name in NAMES}
    paths = {name: package(reductions[name], folder / f"{name}.fmu") for name in NAMES}
    left, right = (Fmu(paths[name], INPUTS, OUTPUTS) for name in NAMES)
    return Pair({name: reductions[name].model for name in NAMES}, (left, right))


def reduction_error(pair: Pair) -> float:
    """The largest difference that the reduction of the parts makes to the left tip, of its peak."""
    bodies = {name: full_body(read_part(MODELS / "pair" / f"{name}.toml")) for name in NAMES}
    joint = joined(together(bodies), "left.tip.z", "right.tip.z", pair.k, pair.c)
    full = driven(monolith(modal(joint, MODES)), {"left.tip.force.z": polynomial(FORCE)})
    count = COUNTS[-1]
    tips = [
        output(m, trajectory(m, END / count, count), "left.tip.displacement.z") for m in (full, pair.whole)
    ]
    return float(np.abs(tips[0] - tips[1]).max() / np.abs(tips[0]).max())


def rows(pair: Pair) -> list[Row]:
    """Everything measured, every master."""
    conserving, h = replace(pair, c=0.0), [END / count for count in COUNTS]
    found = []
    for algorithm, undamped in zip(pair.masters(), conserving.masters(), strict=True):
        wrong = errors(lambda h, count, a=algorithm: pair.error(a, h, count), END, COUNTS)
        drift = np.abs(conserving.energy(undamped, h[-1], COUNTS[-1])).max()
        found.append(Row(algorithm, h, wrong, pair.stable(algorithm), float(drift)))
    return found


def controlled(pair: Pair, tolerance: float) -> dict[str, str]:
    """Jacobi with derivatives under step doubling; tolerance: of an output's error in a step, of its peak."""
    names = [f"{side}.{output}" for side in NAMES for output in OUTPUTS]
    states = trajectory(pair.whole, END / COUNTS[-1], COUNTS[-1])
    peaks = np.array([np.abs(output(pair.whole, states, name)).max() for name in names])
    control = Control(ORDER["derivative"], tolerance * peaks)
    made = step_doubling(pair.system(), jacobi("derivative"), "derivative", control, 1e-5, END)
    h = np.diff([point.t for point in made])
    exact = [output(pair.whole, after(pair.whole, point.t), names[0]) for point in made]
    wrong = np.abs([point.y[0] for point in made] - np.array(exact)).max() / peaks[0]
    return {
        "tolerance": f"{tolerance:.0e}",
        "steps": f"{len(h)}",
        "h / µs": f"{1e6 * h.min():.3g} … {1e6 * h.max():.3g}",
        "error": f"{wrong:.1e}",
    }


def draw(pair: Pair, found: list[Row], path: Path) -> None:
    """Errors over step sizes; energy over time with nothing damped."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4.8), layout="constrained")
    draw_errors(left, [row for row in found if not row.algorithm.name.startswith("interface Newton")])
    left.set_title("fixed point and interface Newton are one line", fontsize="medium")
    left.legend(fontsize="x-small", ncols=2, loc="upper center", bbox_to_anchor=(0.5, -0.15), frameon=False)
    conserving, h, count = replace(pair, c=0.0), END / COUNTS[0], 2 * COUNTS[0]
    for algorithm in conserving.masters():
        if algorithm.name in SHOWN:
            energy = conserving.energy(algorithm, h, count)
            right.plot(1e3 * h * np.arange(count + 1), energy, label=algorithm.name, linewidth=1.2)
    right.set(xlabel="t / ms", ylabel="energy that the coupling made / largest")
    right.set_title(f"nothing damped, h = {1e3 * h:g} ms", fontsize="medium")
    right.grid(alpha=0.3)
    right.legend(fontsize="x-small")
    figure.savefig(path, dpi=80)


def main(folder: Path) -> None:
    """Build, couple, compare."""
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as fmus:
        pair = build(Path(fmus))
        found = rows(pair)
        print(markdown([cells(row) for row in found]))
        print(f"\n{markdown([controlled(pair, tolerance) for tolerance in TOLERANCES])}")
        print(f"\nThe reduction of both parts alone makes {reduction_error(pair):.1e} of the peak.")
        draw(pair, found, folder / "pair.png")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path("out"))
