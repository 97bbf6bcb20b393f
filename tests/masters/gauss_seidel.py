"""Gauss–Seidel: the parts step one after the other, each with what those before it have computed."""

from coupled import Coupled
from extrapolation import Kind, Point, observe, polynomial, predicted
from run import Step


def gauss_seidel(kind: Kind) -> Step:
    """As `jacobi`, with what parts have computed in place of what was predicted of them. Order 1, 2, 3."""

    def step(system: Coupled, point: Point, h: float) -> Point:
        y = predicted(kind, point, h)
        for part, inputs, outputs in zip(system.parts, system.inputs, system.outputs, strict=True):
            u = system.law(point.t + h, y)
            part.set(polynomial(kind, point, h, u)[:, inputs])
            part.step(point.t, h)
            y[outputs] = part.outputs()
        return observe(system, kind, point.t + h, point)

    return step
