"""Step-size control: one step beside two of half its size."""

from dataclasses import dataclass, replace

import numpy as np
from coupled import Coupled
from extrapolation import Kind, Point, observe
from run import Step

from fmu_src.runtime.model import Floats


@dataclass(frozen=True)
class Control:
    """order: p of the master; tolerance: of the error of y in a step, (p,) or one; smallest: step in s."""

    order: int
    tolerance: Floats | float
    smallest: float = 1e-12


def step_doubling(
    system: Coupled, step: Step, kind: Kind, control: Control, h: float, end: float
) -> list[Point]:
    """All points from t = 0 to `end`, beginning with the step h.

    A step is wrong by K hᵖ⁺¹, two of h/2 together by K hᵖ⁺¹/2ᵖ: they differ by 2ᵖ − 1 times the error of the
    two, which are kept. Steps are halved and doubled, nothing else, as a part keeps the coefficients of 16
    step sizes; doubled where twice the step, 2ᵖ⁺¹ times the error, would still do with a margin of two.
    Source: Hairer, Nørsett and Wanner, Solving Ordinary Differential Equations I, 1993, II.4.
    """
    p = control.order
    points = [observe(system, kind, 0.0)]
    while (left := end - points[-1].t) > control.smallest:
        h = min(h, left)
        with system.saved() as roll_back:
            whole = step(system, coarse(points), h)
            roll_back()
            middle = step(system, points[-1], h / 2)
            after = step(system, middle, h / 2)
            error = float(np.max(np.abs(whole.y - after.y) / control.tolerance)) / (2**p - 1)
            if error > 1 and h / 2 > control.smallest:
                roll_back()
                h /= 2
                continue
        points += [middle, after]
        if error < 2.0 ** -(p + 2):
            h *= 2
    return points


def coarse(points: list[Point]) -> Point:
    """The last point as whole steps see it: what was before it is where the last whole step began."""
    last = points[-1]
    return last if len(points) < 3 else replace(last, before=(points[-3].t, points[-3].y))
