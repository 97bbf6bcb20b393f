"""A rigid joint as a power bond: over a step it holds the forces that bring both ports to one place.

Both parts have forces as inputs, −f and f, held over the step; with the gap δ = x₁ − x₂ these do the work
−f Δδ, which is nothing where δ = 0 at both ends: the joint makes no energy at any step size, so no step is
unstable. f is the mean of the joint's force over the step; the velocities of the ports agree to O(h) only.
Source: as `power_bond`, with the constraint in place of the spring.
"""

import numpy as np
from coupled import Coupled
from extrapolation import Point, observe
from interface_newton import sensitivity
from run import Step

from fmu_src.runtime.model import Floats


def rigid_bond(G: Floats, W: Floats) -> Step:
    """G y₊ = 0 by u = e − W f, e of the middle of the step: G (b, p), W (m, b), conjugate as of `Bonds`.

    One step without f, one with it: δ₊ is linear in f, and the sensitivity is kept. Order 2.
    """
    kept: dict[tuple[Coupled, float], Floats] = {}

    def step(system: Coupled, point: Point, h: float) -> Point:
        u = system.law(point.t + h / 2, 0 * point.y)
        with system.saved() as roll_back:
            gap = G @ system.stepped(point.t, h, u[None])
            if (system, h) not in kept:
                kept[system, h] = G @ sensitivity(system, "hold", point, h) @ W
            f = np.linalg.solve(kept[system, h], gap)
            roll_back()
            system.stepped(point.t, h, (u - W @ f)[None])
        return observe(system, "hold", point.t + h, point)

    return step
