"""A rigid joint: force on the one part, motion of the other, so that both move as one.

The driving part has a force f as input, the driven one the acceleration a of its port; the reaction r that
moves it comes back as f = −r. Both feed through: f makes an acceleration at once, and that a reaction. Where
equal accelerations are all that is asked for, the displacements drift apart. Here a(s) = a₀ + ȧ s is the one
that brings displacement and velocity of the driven port to those of the driving one, x₊, v₊ at the end,

    a₀ = 6 (x₊ − x − v h)/h² − 2 (v₊ − v)/h,  ȧ = 2 (v₊ − v)/h² − 2 a₀/h

the second derivative of Hermite's cubic, and f₊ = −r(f₊) is solved for, f being linear in between.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from coupled import Coupled
from extrapolation import Point, observe
from run import Step

from fmu_src.runtime.model import Floats


@dataclass(frozen=True, eq=False)
class Joint:
    """Places in y (b,) each: x, v of the driving part, the first; s, s_dot, reaction of the driven one."""

    x: slice
    v: slice
    s: slice
    s_dot: slice
    reaction: slice


def rigid_joint(joint: Joint) -> Step:
    """One step of the driving part, one of the driven one, and again with f₊ by their sensitivity. Order 2.

    The parts are linear: b probing steps for each step size, and one correction.
    """
    kept: dict[tuple[Coupled, float], Floats] = {}

    def step(system: Coupled, point: Point, h: float) -> Point:
        driving, driven = system.parts
        forced = system.inputs[0]
        given = [system.law(t, 0 * point.y)[forced] for t in (point.t, point.t + h)]
        begun, s, s_dot = (point.y[place] for place in (joint.reaction, joint.s, joint.s_dot))

        def left(f: Floats) -> Floats:
            """−r − f₊ of a step with f₊."""
            u, u_end = given[0] - begun, given[1] + f
            driving.set(np.stack([u, (u_end - u) / h]))
            driving.step(point.t, h)
            y = np.concatenate([driving.outputs(), point.y[system.outputs[1]]])
            driven.set(hermite(s, s_dot, y[joint.x], y[joint.v], h))
            driven.step(point.t, h)
            y[system.outputs[1]] = driven.outputs()
            return -y[joint.reaction] - f

        with system.saved() as roll_back:
            f = -begun
            found = left(f)
            if (system, h) not in kept:
                kept[system, h] = _slopes(left, f, found, roll_back)
            f = f - np.linalg.solve(kept[system, h], found)
            roll_back()
            left(f)
        return observe(system, "hold", point.t + h, point)

    return step


def hermite(s: Floats, s_dot: Floats, x: Floats, v: Floats, h: float) -> Floats:
    """a₀, ȧ (2, b) that bring s, ṡ to x, v in h."""
    a = 6 * (x - s - s_dot * h) / h**2 - 2 * (v - s_dot) / h
    return np.stack([a, 2 * (v - s_dot) / h**2 - 2 * a / h])


def _slopes(
    left: Callable[[Floats], Floats], f: Floats, found: Floats, roll_back: Callable[[], None]
) -> Floats:
    """∂left/∂f (b, b), by a step more for each of f."""
    columns = []
    for j in range(len(f)):
        other = f.copy()
        other[j] += 1.0
        roll_back()
        columns.append((left(other) - found).reshape(len(f), -1)[:, 0])
    return np.array(columns).T
