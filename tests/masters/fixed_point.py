"""Fixed-point iteration: a step is made again until its inputs are those that its outputs ask for."""

from collections.abc import Callable

import numpy as np
from coupled import Coupled, Law
from extrapolation import Kind, Point, observe, polynomial, predicted
from run import Step

from fmu_src.runtime.model import Floats

TOLERANCE = 1e-11  # of the largest input: what is left of û = g(t+h, y)
DIVERGED = 1e6  # times what was left at first
MOST = 400  # iterations: a contraction by 0.94 takes as many

Correction = Callable[[Coupled, Point, float, Law, Floats, Floats], Floats]
"""What to add to û for what is left, g(t+h, y) − û: of system, point, h, g, y, and what is left."""


class NotConverged(Exception):
    """The iteration has not come to an end: take smaller steps, or Newton's method."""


def fixed_point(kind: Kind) -> Step:
    """û ← g(t+h, y(û)). It converges where |eigenvalues of ∂g/∂y ∂y/∂û| < 1, for masses and small h always.

    ∂y/∂û = C G₀(h) B for a hold, C G₁ B/h and 2 C G₂ B/h² for the polynomials. Order 1, 2, 3 by `kind`: û is
    now right, but between the points the inputs are still wrong by O(h), O(h²), O(h³).
    """
    return iterated(kind, lambda system, point, h, law, y, left: left)


def own_law(system: Coupled, point: Point, h: float) -> Law:
    """What the inputs must satisfy at the end of a step."""
    return system.law


def iterated(
    kind: Kind, correction: Correction, law_of: Callable[[Coupled, Point, float], Law] = own_law
) -> Step:
    """Steps from a saved state until |g(t+h, y) − û| ≤ TOLERANCE |û|, û corrected and the state rolled back.

    Raises NotConverged; the system is then where the step began.
    """

    def step(system: Coupled, point: Point, h: float) -> Point:
        law, end = law_of(system, point, h), point.t + h
        u = law(end, predicted(kind, point, h))
        with system.saved() as roll_back:
            first = 0.0
            for _ in range(MOST):
                y = system.stepped(point.t, h, polynomial(kind, point, h, u))
                left = law(end, y) - u
                size = np.abs(left).max()
                if size <= TOLERANCE * np.abs(u).max():
                    return observe(system, kind, end, point)
                first = first or size
                if not size <= DIVERGED * first:
                    break
                u = u + correction(system, point, h, law, y, left)
                roll_back()
            roll_back()
        raise NotConverged(f"t = {point.t:g}, h = {h:g}: {size:.2g} of û is left")

    return step
