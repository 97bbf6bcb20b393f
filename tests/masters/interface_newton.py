"""Interface Newton: the inputs of a step by the exact sensitivity of its outputs."""

from collections.abc import Callable

import numpy as np
from coupled import Coupled, Law
from extrapolation import Kind, Point, polynomial
from fixed_point import iterated, own_law
from run import Step

from fmu_src.runtime.model import Floats


def interface_newton(kind: Kind, law_of: Callable[[Coupled, Point, float], Law] = own_law) -> Step:
    """û ← û − (g′S − I)⁻¹ (g(t+h, y) − û) with S = ∂y(t+h)/∂û, g′ = ∂g/∂y.

    The parts are linear: S depends on h only and is kept, and where g is linear too one correction is all.
    It needs no contraction, and has the order of `fixed_point`, to whose û it comes. Not converged means that
    TOLERANCE is less than what rounding leaves, times the gain of a loop that feeds through.
    """
    kept: dict[tuple[Coupled, float], Floats] = {}

    def correction(system: Coupled, point: Point, h: float, law: Law, y: Floats, left: Floats) -> Floats:
        if (system, h) not in kept:
            kept[system, h] = sensitivity(system, kind, point, h)
        S = kept[system, h]
        return np.linalg.solve(np.eye(S.shape[1]) - law.slope(point.t + h, y) @ S, left)

    return iterated(kind, correction, law_of)


def sensitivity(system: Coupled, kind: Kind, point: Point, h: float) -> Floats:
    """S = ∂y(t+h)/∂û (p, m), block diagonal: one step with û and, for each input, one with û + 1.

    The parts are where the last try has ended, which does not matter to what is linear; they are left there.
    """
    S = np.zeros((len(point.y), len(point.u)))
    for part, inputs, outputs in zip(system.parts, system.inputs, system.outputs, strict=True):
        state = part.save()

        def ended(u: Floats, part=part, inputs=inputs, state=state) -> Floats:
            part.set(polynomial(kind, point, h, u)[:, inputs])
            part.step(point.t + h, h)
            y = part.outputs()
            part.restore(state)
            return y

        y = ended(point.u)
        for j in range(inputs.start, inputs.stop):
            other = point.u.copy()
            other[j] += 1.0
            change = ended(other) - y
            S[outputs, j] = change.reshape(len(y), -1)[:, 0]  # several runs side by side have the same S
        part.free(state)
    return S
