"""A controller at its own rate: it reads the outputs at its samples and holds what it asks for in between."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from coupled import Coupled
from extrapolation import Kind, observe
from monolith import Monolith, driven, output, polynomial, trajectory
from run import Step

from fmu_src.runtime.model import Floats

DUE = 1e-9  # of a period: a communication point as near as this to a sample is at it


@dataclass(frozen=True)
class Pid:
    """u = Kp e + Ki T Σ e − Kd (y − y₋)/T with e = target − y, the sum over the samples before.

    period: T in s. The derivative is that of the measured y, which a target that jumps does not kick.
    """

    Kp: float
    Ki: float
    Kd: float
    period: float
    target: float

    def __call__(self, memory: tuple[float, float], y: float) -> tuple[float, tuple[float, float]]:
        """u, and the memory: the sum of e, and y, for the next sample; (0, 0) for a start at rest."""
        total, before = memory
        e = self.target - y
        u = self.Kp * e + self.Ki * self.period * total - self.Kd * (y - before) / self.period
        return u, (total + e, y)


@dataclass
class Held:
    """What the controller asks for, from sample to sample."""

    u: float = 0.0


def run_sampled(
    system: Coupled, held: Held, pid: Pid, step: Step, kind: Kind, lengths: Iterable[float]
) -> tuple[Floats, Floats]:
    """t and y at the ends of steps of these lengths; `held` stands in the system's law, y[0] is measured.

    A sample at a communication point is exact. One within a step is what it is between two simulators that
    run side by side: the controller knows y of the step's beginning, the parts hear of it at the step's end.
    """
    memory, due, late = (0.0, 0.0), 0, None
    before, points = None, [observe(system, kind, 0.0)]
    for h in lengths:
        point = points[-1]
        if late is not None:
            held.u, late = late, None
        sample = due * pid.period
        if sample < point.t + h - DUE * pid.period:
            u, memory = pid(memory, point.y[0])
            due += 1
            if sample > point.t + DUE * pid.period:
                late = u
            else:
                held.u = u
        point = observe(system, kind, point.t, before)
        points.append(step(system, point, h))
        before = point
    return np.array([p.t for p in points]), np.array([p.y for p in points])


def dividing(period: float, parts: int, samples: int) -> list[float]:
    """Steps that divide the period."""
    return [period / parts] * (parts * samples)


def landing(period: float, h: float, samples: int) -> list[float]:
    """Steps of h, the last one before each sample as much shorter as it takes to land on it."""
    whole = int(period / h)
    return ([h] * whole + [period - whole * h]) * samples


def straying(period: float, parts: int, samples: int) -> list[float]:
    """Steps of 2/(2n + 1) periods: every second sample lies in the middle of a step."""
    return [2 * period / (2 * parts + 1)] * ((2 * parts + 1) * samples // 2)


def controlled(plant: Monolith, pid: Pid, measured: str, asked: str, parts: int, samples: int) -> Floats:
    """x of the plant at 0, T/parts, 2T/parts, … under the controller: exact, (parts · samples + 1, n)."""
    memory, x = (0.0, 0.0), plant.x0
    found = [x[None]]
    for _ in range(samples):
        u, memory = pid(memory, output(plant, x, measured))
        held = driven(Monolith(plant.A, x, plant.inputs, plant.outputs), {asked: polynomial(u)})
        passed = trajectory(held, pid.period / parts, parts)[1:, : len(x)]
        found.append(passed)
        x = passed[-1]
    return np.concatenate(found)
