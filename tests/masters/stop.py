"""A reed against its stop: a force bends it until its tip meets a spring that can only push.

Run `python tests/masters/stop.py [FOLDER]`: prints the table of models/stop/README.md and draws its picture.
"""

import sys
import tempfile
from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from body import full_body, modal, reduced_body
from bounces import PUSH, TIP, Bounces, Stop, bounces
from coupled import Coupled, Linear
from events import Regime, run_to_events
from fmu import Fmu
from jacobi import jacobi
from linear_part import state_space
from markdown import largest, markdown
from power_bond import Bonds, power_bond
from run import run
from step_map import largest_stable_step, spectral_radius, step_map
from table import Algorithm, algorithms

from fmu_src.runtime.model import Floats, ReducedModel
from precompute.part import read_part
from precompute.pipeline import package, reduce_part

FOLDER = Path(__file__).parents[2] / "models" / "stop"
FORCE, STIFFNESS, GAP = 2.0, 2e4, 5e-4  # N at the tip from t = 0; N/m of the stop; m to it
STOP = Stop(STIFFNESS, GAP, FORCE)
STEP, COUNT = 5e-5, 100  # s: the largest step of the study, and how many; two contacts in 5 ms
INPUTS, OUTPUTS = [PUSH], [TIP, "energy.kinetic", "energy.strain"]
FULL_MODES = 20  # of the reed in the full model, up to 100 kHz

BOND = Bonds(np.array([[1.0, 0.0, 0.0]]), np.ones((1, 1)), np.array([STIFFNESS]), np.zeros(1))
ALGORITHMS = [  # with one part Gauss–Seidel is Jacobi; Newton has what fixed points have
    *(a for a in algorithms() if a.name.startswith(("Jacobi", "interface Newton"))),
    Algorithm("power bond", "hold", 2, lambda: power_bond(BOND)),
]


Master = Callable[[Fmu, Algorithm, int], tuple[Floats, Floats, Floats]]
"""`bounced` or `blindly`."""


class OneSided:
    """u = F − k max(y − g, 0), for a master that knows nothing of events."""

    def __call__(self, t: float, y: Floats) -> Floats:
        return np.array([FORCE - STIFFNESS * max(y[0] - GAP, 0.0)])

    def rate(self, order: int, t: float, Y: Floats) -> Floats:
        return self.slope(t, Y[0]) @ Y[order]

    def slope(self, t: float, y: Floats) -> Floats:
        return np.array([[-STIFFNESS * float(y[0] > GAP), 0.0, 0.0]])


def regimes(reed: Fmu, algorithm: Algorithm) -> tuple[Regime, Regime]:
    """In flight, where nothing is coupled, and in contact."""

    def system(force: float, stiffness: float) -> Coupled:
        L = np.array([[-stiffness, 0.0, 0.0]])
        return Coupled((reed,), Linear(L, lambda t, order: np.array([force * (order == 0)])))

    flight, contact = system(FORCE, 0.0), system(FORCE + STIFFNESS * GAP, STIFFNESS)
    return (
        Regime(flight, jacobi(algorithm.kind), lambda y: y[0] - GAP),
        Regime(contact, algorithm.step(), lambda y: GAP - y[0]),
    )


def bounced(reed: Fmu, algorithm: Algorithm, finer: int) -> tuple[Floats, Floats, Floats]:
    """t, y (t, p) and the times of contacts and departures, with the step STEP/finer, from where it is."""
    return run_to_events(regimes(reed, algorithm), algorithm.kind, STEP / finer, COUNT * finer)


def blindly(reed: Fmu, algorithm: Algorithm, finer: int) -> tuple[Floats, Floats, Floats]:
    """The same, its steps not cut by any event."""
    system = Coupled((reed,), OneSided())
    t, y = run(system, algorithm.step(), algorithm.kind, STEP / finer, COUNT * finer)
    return t, y, np.zeros(0)


def error(y: Floats, reference: Floats) -> float:
    """Of the tip's displacement at multiples of STEP, of its largest value."""
    tip = y[:: (len(y) - 1) // COUNT, 0]
    return float(np.abs(tip - reference).max() / np.abs(reference).max())


def energy(y: Floats) -> Floats:
    """Of reed, stop and force, J: constant without damping, and 0 at the start."""
    pressed = np.maximum(y[:, 0] - GAP, 0.0)
    return y[:, 1] + y[:, 2] + STIFFNESS * pressed**2 / 2 - FORCE * y[:, 0]


def drift(reed: Fmu, algorithm: Algorithm, finer: int, master: Master = bounced) -> float:
    """The largest energy that comes or goes when the reed has no damping, of F·g."""
    reed.restart({"damping.beta": 0.0})
    _, y, _ = master(reed, algorithm, finer)
    return float(np.abs(energy(y)).max() / (FORCE * GAP))


def radius(model: ReducedModel, algorithm: Algorithm, h: float) -> float:
    """The spectral radius of a step in contact."""
    space = state_space(model, INPUTS, 3 * OUTPUTS[:1])  # three for y, of which the first one counts
    stop = np.array([[-STIFFNESS, 0.0, 0.0]])
    step = algorithm.step()
    return spectral_radius(step_map([space], stop, step, algorithm.kind, h))


@cache
def limit(model: ReducedModel, algorithm: Algorithm) -> float:
    """The largest stable step in contact, s; ∞ where there is none below 1 ms."""
    return largest_stable_step(lambda h: radius(model, algorithm, h), 1e-6, 1e-3)


def order(errors: Mapping[int, float]) -> float:
    """The slope of log error over log step: least squares over all steps that were run."""
    steps, found = np.log([1 / finer for finer in errors]), np.log([*errors.values()])
    return float(np.polyfit(steps, found, 1)[0])


def row(
    model: ReducedModel, reed: Fmu, reference: Bounces, algorithm: Algorithm, master: Master
) -> dict[str, str]:
    """Steps of 25 to 3.125 µs; the events at 6.25 µs."""
    expected = reference.tip(STEP * np.arange(COUNT + 1))
    errors, times = {}, {}
    for finer in (2, 4, 8, 16):
        reed.restart()
        _, y, events = master(reed, algorithm, finer)
        errors[finer], times[finer] = error(y, expected), events
    late = [f"{abs(found - true):.0e}" for found, true in zip(times[8], reference.events, strict=False)]
    return {
        "master": algorithm.name,
        "contacts": "located" if late else "passed over",
        "error, h = 25 µs": f"{errors[2]:.1e}",
        "error, h = 6.25 µs": f"{errors[8]:.1e}",
        "order": f"{order(errors):.2f}",
        "first contact / s": late[0] if late else "–",
        "second departure / s": late[3] if late else "–",
        "energy drift": f"{drift(reed, algorithm, 8, master):.0e}",
        "largest stable h / µs": largest(limit(model, algorithm), 1e-6),
    }


def plot(reed: Fmu, reference: Bounces, full: Bounces, path: Path) -> None:
    """The tip over time, and what the algorithms make of it."""
    t = STEP / 2 * np.arange(2 * COUNT + 1)
    figure, (upper, lower) = plt.subplots(2, 1, figsize=(8, 6), sharex=True, layout="constrained")
    upper.axhspan(1e3 * GAP, 1.0, color="0.9", label="the stop")
    upper.plot(1e3 * t, 1e3 * reference.tip(t), label="monolithic, reduced")
    upper.plot(1e3 * t, 1e3 * full.tip(t), "k:", label="monolithic, full")
    by_name = {algorithm.name: algorithm for algorithm in ALGORITHMS}
    for name, master, words in (
        ("Jacobi, hold", bounced, "located"),
        ("power bond", bounced, "located"),
        ("interface Newton, derivative", blindly, "passed over"),
        ("interface Newton, derivative", bounced, "located"),
    ):
        reed.restart()
        t, y, _ = master(reed, by_name[name], 8)
        off = np.abs(y[:, 0] - reference.tip(t)) + 1e-17
        lower.semilogy(1e3 * t, off, linewidth=0.9, label=f"{name}, contacts {words}")
    reed.restart()
    t, y, _ = bounced(reed, by_name["Jacobi, hold"], 2)
    upper.plot(1e3 * t, 1e3 * y[:, 0], linewidth=0.9, label="Jacobi, hold, h = 25 µs")
    for t_event in reference.events:
        lower.axvline(1e3 * t_event, color="0.8", zorder=0)
    upper.set(ylabel="tip / mm", ylim=(-0.1, 0.95), title="A reed and its stop")
    lower.set(xlabel="t / ms", ylabel="error at h = 6.25 µs / m", xlim=(0.0, 1e3 * t[-1]), ylim=(1e-17, 1e-3))
    upper.legend(fontsize="small", ncols=2)
    lower.legend(fontsize="small")
    figure.savefig(path, dpi=90)


def main(folder: Path) -> None:
    """Build, run, compare, draw."""
    folder.mkdir(parents=True, exist_ok=True)
    part = read_part(FOLDER)
    reduction = reduce_part(part)
    with tempfile.TemporaryDirectory() as scratch:
        reed = Fmu(package(reduction, Path(scratch) / "reed.fmu"), INPUTS, OUTPUTS)
        reference = bounces(reduced_body(reduction.model), STOP, STEP * COUNT)
        full = bounces(modal(full_body(part), FULL_MODES), STOP, STEP * COUNT)
        rows = [
            row(reduction.model, reed, reference, algorithm, master)
            for master in (bounced, blindly)
            for algorithm in ALGORITHMS
            if master is bounced
            or algorithm.name != "power bond"  # its force is that of a contact that lasts
        ]
        print(markdown(rows))
        print(
            f"\ncontacts and departures / ms: {1e3 * reference.events}, of the full model {1e3 * full.events}"
        )
        plot(reed, reference, full, folder / "bounces.png")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path("out"))
