"""A run: one communication step after the other."""

from collections.abc import Callable, Iterator

import numpy as np
from coupled import Coupled
from extrapolation import Kind, Point, observe

from fmu_src.runtime.model import Floats

Step = Callable[[Coupled, Point, float], Point]
"""An algorithm: moves the system from a point over a step h, gives the next point."""


def points(system: Coupled, step: Step, kind: Kind, h: float, count: int) -> Iterator[Point]:
    """The start at t = 0, as the parts are, then the ends of `count` equal steps as they are made."""
    point = observe(system, kind, 0.0)
    yield point
    for _ in range(count):
        point = step(system, point, h)
        yield point


def run(system: Coupled, step: Step, kind: Kind, h: float, count: int) -> tuple[Floats, Floats]:
    """t (count + 1,) and y (count + 1, p) of them."""
    t, y = zip(*((point.t, point.y) for point in points(system, step, kind, h, count)), strict=True)
    return np.array(t), np.array(y)
