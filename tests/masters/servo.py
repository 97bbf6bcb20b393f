"""A column on a slide, moved by a voice coil under a sampled PID controller.

Run `python tests/masters/servo.py [FOLDER]`: prints the tables of models/servo/README.md, draws its picture.
"""

import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from body import full_body, modal, reduced_body
from coupled import Coupled, Linear
from fmu import Fmu
from jacobi import jacobi
from linear_part import LinearPart, StateSpace, state_space
from markdown import markdown
from monolith import Monolith, beside, fed_back, monolith, output
from run import run
from sampled import Held, Pid, controlled, dividing, landing, run_sampled, straying
from step_map import largest_stable_step, spectral_radius, step_map
from table import Algorithm, Row, algorithms, cells, draw_errors, errors

from fmu_src.runtime.model import Floats, ReducedModel
from precompute.part import read_part
from precompute.pipeline import package, reduce_part

FOLDER = Path(__file__).parents[2] / "models" / "servo"
PERIOD, SAMPLES, TARGET = 1e-3, 50, 5e-3  # s, and how many of it; m
BY_FORCE = Pid(6300.0, 84e3, 158.0, PERIOD, TARGET)  # N/m, N/(m.s), N.s/m: (s + ω)³ with ω = 40/s and 1.3 kg
BY_VOLTAGE = Pid(700.0, 7000.0, 2.0, PERIOD, TARGET)  # V/m, V/(m.s), V.s/m
R, L, MOTOR = 2.0, 2e-3, 20.0  # Ω, H, N/A = V.s/m
FORCE, VOLTAGE = "slide.force.x", "coil.voltage"
SLIDE, SPEED, TOP = "slide.displacement.x", "slide.velocity.x", "top.displacement.x"
OUTPUTS = [SLIDE, SPEED, TOP, "energy.kinetic", "energy.strain"]
COUPLING = np.zeros((3, 6))  # of u = (F, U, v) by y = (the outputs of the column, i)
COUPLING[0, 5], COUPLING[2, 1] = MOTOR, 1.0  # F = k i
PARTS = (2, 4, 8, 16)  # steps in a period, of masters that couple column and coil
FINER = (1, 4, 16, 64, 128)  # of those that have the column alone
LIMIT = 2e-2  # s: the largest step that is looked at


def coil(resistance: float = R) -> StateSpace:
    """L di/dt + R i + k v = U: inputs U, v; output i."""
    A, B = np.array([[-resistance / L]]), np.array([[1 / L, -MOTOR / L]])
    return StateSpace(A, B, np.ones((1, 1)), np.zeros((1, 2)))


def with_coil(column: Monolith) -> Monolith:
    """The column, its slide moved by F = k i."""
    space = coil()
    inputs = {VOLTAGE: space.B[:, 0], "coil.speed": space.B[:, 1]}
    both = beside(column, Monolith(space.A, np.zeros(1), inputs, {"coil.current": space.C[0]}))
    both = fed_back(both, FORCE, MOTOR * both.outputs["coil.current"])
    return fed_back(both, "coil.speed", both.outputs[SPEED])


@dataclass(frozen=True, eq=False)
class Servo:
    """The column, reduced and as an FMU."""

    model: ReducedModel
    column: Fmu

    def by_force(self, lengths: list[float]) -> tuple[Floats, Floats]:
        """t and y under a controller whose force acts on the slide at once."""
        held = Held()
        law = Linear(np.zeros((1, 5)), lambda t, order: np.array([held.u * (order == 0)]))
        self.column.restart()
        return run_sampled(Coupled((self.column,), law), held, BY_FORCE, jacobi("hold"), "hold", lengths)

    def by_voltage(self, algorithm: Algorithm, lengths: list[float]) -> tuple[Floats, Floats]:
        """t and y under a controller of the coil's voltage."""
        held = Held()
        self.column.restart()
        system = self.system(coil(), held)
        return run_sampled(system, held, BY_VOLTAGE, algorithm.step(), algorithm.kind, lengths)

    def system(self, space: StateSpace, held: Held, current: float = 0.0) -> Coupled:
        """The column, as it is, and a coil."""
        law = Linear(COUPLING, lambda t, order: np.array([0.0, held.u * (order == 0), 0.0]))
        return Coupled((self.column, LinearPart(space, np.array([current]))), law)

    def energy(self, algorithm: Algorithm, h: float, count: int) -> Floats:
        """Of column and coil, of the ½Li² at t = 0 (i = 1 A): no damping, no resistance, no voltage."""
        self.column.restart({"damping.beta": 0.0})
        system = self.system(coil(0.0), Held(), current=1.0)
        _, y = run(system, algorithm.step(), algorithm.kind, h, count)
        found: Floats = (y[:, 3] + y[:, 4] + L * y[:, 5] ** 2 / 2) / (L / 2)
        return found

    def radius(self, algorithm: Algorithm, h: float) -> float:
        """The spectral radius of a step of column and coil, U = 0."""
        spaces = [state_space(self.model, [FORCE], [SPEED]), coil()]
        L = np.array([[0.0, MOTOR], [0.0, 0.0], [1.0, 0.0]])
        return spectral_radius(step_map(spaces, L, algorithm.step(), algorithm.kind, h))

    def stable(self, algorithm: Algorithm) -> float:
        """The largest stable step of column and coil in s."""
        return largest_stable_step(lambda h: self.radius(algorithm, h), 5e-4, LIMIT)


def build(folder: Path) -> Servo:
    """The column reduced and packaged."""
    reduction = reduce_part(read_part(FOLDER))
    return Servo(reduction.model, Fmu(package(reduction, folder / "column.fmu"), [FORCE], OUTPUTS))


@dataclass(frozen=True, eq=False)
class Exact:
    """The monolithic solutions of a column: slide and top at 0, T/parts, 2T/parts, …, m, (…, 2)."""

    column: Monolith

    def by_force(self, parts: int = 1) -> Floats:
        """The controller's force on the slide."""
        return self._moved(self.column, BY_FORCE, FORCE, parts)

    def by_voltage(self, parts: int = 1) -> Floats:
        """With the coil."""
        return self._moved(with_coil(self.column), BY_VOLTAGE, VOLTAGE, parts)

    def _moved(self, plant: Monolith, pid: Pid, asked: str, parts: int) -> Floats:
        x = controlled(plant, pid, SLIDE, asked, parts, SAMPLES)
        return np.column_stack([output(plant, x, SLIDE), output(plant, x, TOP)])


def error(t: Floats, y: Floats, exact: Floats) -> float:
    """The largest of slide and top at every second sample, of their peak; `exact` at every one."""
    moved = y[:, [0, 2]]
    at = [int(np.argmin(np.abs(t - 2 * k * PERIOD))) for k in range(len(exact) // 2 + 1)]
    return float(np.abs(moved[at] - exact[::2]).max() / np.abs(exact).max())


def by_samples(servo: Servo, exact: Exact) -> list[dict[str, str]]:
    """How a master treats the samples, and what comes of it."""
    found, expected = [], exact.by_force()
    ways = {
        "divide the period": lambda n: dividing(PERIOD, n, SAMPLES),
        "cut to land on the samples": lambda n: landing(PERIOD, 0.7 * PERIOD / n, SAMPLES),
        "pass over the samples": lambda n: straying(PERIOD, n, SAMPLES),
    }
    for name, lengths in ways.items():
        wrong = [error(*servo.by_force(lengths(n)), expected) for n in FINER]
        order = "–" if max(wrong) < 1e-10 else f"{np.log2(wrong[-2] / wrong[-1]):.2f}"
        row = {f"error, n = {n}": f"{e:.1e}" for n, e in zip(FINER, wrong, strict=True)}
        found.append({"steps": name, **row, "order": order})
    return found


def by_algorithm(servo: Servo, exact: Exact) -> list[Row]:
    """Column and coil, every master."""
    end, expected = PERIOD * SAMPLES, exact.by_voltage()
    counts = [n * SAMPLES for n in PARTS]
    found = []
    for algorithm in algorithms():

        def wrong(h: float, count: int, algorithm: Algorithm = algorithm) -> float:
            return error(*servo.by_voltage(algorithm, [h] * count), expected)

        drift = np.abs(servo.energy(algorithm, end / counts[-1], counts[-1]) - 1).max()
        h = [end / count for count in counts]
        found.append(Row(algorithm, h, errors(wrong, end, counts), servo.stable(algorithm), float(drift)))
    return found


def draw(servo: Servo, exact: Exact, found: list[Row], path: Path) -> None:
    """The motion under the voltage's controller, and the errors over the step size."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4.2), layout="constrained")
    moved = 1e3 * exact.by_voltage(16)
    t = 1e3 * PERIOD * np.arange(len(moved)) / 16
    left.plot(t, moved[:, 0], label="slide, monolithic")
    left.plot(t, moved[:, 1], label="top, monolithic")
    jacobi_hold = algorithms()[0]
    t, y = servo.by_voltage(jacobi_hold, dividing(PERIOD, 2, SAMPLES))
    left.plot(1e3 * t, 1e3 * y[:, 0], "k:", label=f"slide, {jacobi_hold.name}, h = T/2")
    left.axhline(1e3 * TARGET, color="0.7", zorder=0)
    left.set(xlabel="t / ms", ylabel="displacement / mm")
    left.legend(fontsize="small")
    draw_errors(right, found)
    right.legend(fontsize="x-small", ncols=2)
    figure.savefig(path, dpi=80)


def main(folder: Path) -> None:
    """Build, run, compare, draw."""
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as scratch:
        servo = build(Path(scratch))
        exact = Exact(monolith(reduced_body(servo.model)))
        full = Exact(monolith(modal(full_body(read_part(FOLDER)), 12)))
        print(markdown(by_samples(servo, exact)), "\n")
        found = by_algorithm(servo, exact)
        print(markdown([cells(row) for row in found]))
        for name in ("by_force", "by_voltage"):
            mine, whole = getattr(exact, name)(), getattr(full, name)()
            print(f"\nThe reduction alone makes {np.abs(mine - whole).max() / whole.max():.1e}, {name}.")
        draw(servo, exact, found, folder / "servo.png")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path("out"))
