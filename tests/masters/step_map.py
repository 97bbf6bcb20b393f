"""One step of a master on linear parts is a matrix: its spectral radius says whether the step is stable."""

from collections.abc import Callable, Sequence

import numpy as np
from coupled import Coupled, Linear
from extrapolation import Kind, Point, observe
from fixed_point import NotConverged
from linear_part import LinearPart, StateSpace
from run import Step
from scipy.optimize import bisect
from threadpoolctl import threadpool_limits

from fmu_src.runtime.model import Floats

MARGIN = 1e-9  # by which a stable map's spectral radius may be above 1: rounding of a mode without damping


def step_map(spaces: Sequence[StateSpace], L: Floats, step: Step, kind: Kind, h: float) -> Floats:
    """z(t+h) = M z(t), z = x of all parts, their inputs u as the last step ended, y at the point before.

    Every column is a run of its own, from a unit vector, without external forces; all side by side.
    """
    n, (p, m) = [len(space.A) for space in spaces], (len(L[0]), len(L))
    size = sum(n) + m + p
    x, u, y_before = np.split(np.eye(size), [sum(n), sum(n) + m])
    parts = [LinearPart(s, x0) for s, x0 in zip(spaces, np.split(x, np.cumsum(n)[:-1]), strict=True)]
    system = Coupled(tuple(parts), Linear(L))
    system.set(u[None])
    before = Point(-h, y_before[None], u[None])
    point = observe(system, kind, 0.0, before)
    step(system, point, h)
    return np.concatenate([*(part.x for part in parts), *(part.U[0] for part in parts), point.y])


def spectral_radius(M: Floats) -> float:
    """max |eigenvalue|."""
    return float(np.abs(np.linalg.eigvals(M)).max())


def largest_stable_step(
    radius: Callable[[float], float],
    lowest: float,
    highest: float,
    ratio: float = 1.002,
    margin: float = MARGIN,
) -> float:
    """The h at which the spectral radius first rises above 1 between `lowest` and `highest`, else ∞; in s.

    0 where the lowest is not stable. A search in steps of `ratio`, then bisection: where coupling and
    a mode of a part are in tune, a step may be unstable while others above it are not.
    """

    def excess(h: float) -> float:
        try:
            return min(radius(h) - 1 - margin, 1.0)
        except NotConverged:
            return 1.0

    with threadpool_limits(1):  # for matrices this small, threads take longer than the work
        if excess(lowest) > 0:
            return 0.0
        h = lowest
        while h < highest:
            if excess(ratio * h) > 0:
                return float(bisect(excess, h, ratio * h, xtol=1e-9 * h))
            h *= ratio
    return np.inf
