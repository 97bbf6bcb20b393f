"""A run: one communication step after the other."""

from collections.abc import Callable

import numpy as np
from coupled import Coupled
from extrapolation import Kind, Point, observe

from fmu_src.runtime.model import Floats

Step = Callable[[Coupled, Point, float], Point]
"""An algorithm: moves the system from a point over a step h, gives the next point."""


def run(system: Coupled, step: Step, kind: Kind, h: float, count: int) -> tuple[Floats, Floats]:
    """t (count + 1,) and y (count + 1, p) of `count` equal steps from the state the parts are in at t = 0."""
    point = observe(system, kind, 0.0)
    points = [point]
    for _ in range(count):
        point = step(system, point, h)
        points.append(point)
    return np.array([p.t for p in points]), np.array([p.y for p in points])
