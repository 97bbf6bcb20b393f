"""Laws that hold in turn, and a master that steps to the very instant at which one gives way to the next."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from coupled import Coupled
from extrapolation import Kind, Point, observe
from run import Step
from scipy.optimize import brentq

from fmu_src.runtime.model import Floats

INSTANT = 1e-15  # s: what is left of the interval that holds an event


@dataclass(frozen=True, eq=False)
class Regime:
    """The parts under one law and an algorithm for it, until `event` (y) comes to 0 from below."""

    system: Coupled
    step: Step
    event: Callable[[Floats], float]


def to_event(regime: Regime, point: Point, h: float) -> tuple[Point, bool]:
    """A step of h, or the shorter one that ends with the event; and whether it is that.

    The step is made again from the saved state, each time as long as Brent's method asks: what a part answers
    is exact for any length, so that the event is where the algorithm's own solution has it, to rounding.
    """
    with regime.system.saved() as roll_back:
        end = regime.step(regime.system, point, h)
        if regime.event(end.y) < 0:
            return end, False

        def event(s: float) -> float:
            if s == 0.0:
                return regime.event(point.y)
            roll_back()
            return regime.event(regime.step(regime.system, point, s).y)

        s = brentq(event, 0.0, h, xtol=INSTANT)
        roll_back()
        return regime.step(regime.system, point, s), True


def run_to_events(
    regimes: Sequence[Regime], kind: Kind, h: float, count: int
) -> tuple[Floats, Floats, Floats]:
    """t (count + 1,) and y (count + 1, p) at multiples of h, and the times of the events; regimes take turns.

    A step that an event has cut is followed by one to the next multiple of h. Raises ValueError where two
    events lie in one step.
    """
    turn, events = 0, []
    point = observe(regimes[0].system, kind, 0.0)
    points = [point]
    for k in range(1, count + 1):
        left, due = h, True
        while due:
            before = point
            point, due = to_event(regimes[turn], point, left)
            if due:
                turn = (turn + 1) % len(regimes)
                point = observe(regimes[turn].system, kind, point.t, before)
                events.append(point.t)
                left = k * h - point.t
        points.append(point)
    return np.array([p.t for p in points]), np.array([p.y for p in points]), np.array(events)
