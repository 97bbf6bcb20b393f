"""Jacobi: all parts step at once, each with what it believes of the others."""

from coupled import Coupled
from extrapolation import Kind, Point, observe, polynomial, predicted
from run import Step


def jacobi(kind: Kind) -> Step:
    """û = g(t+h, ŷ) of predicted outputs, then every part by itself. Order 1, 2, 3 by `kind`."""

    def step(system: Coupled, point: Point, h: float) -> Point:
        u = system.law(point.t + h, predicted(kind, point, h))
        system.stepped(point.t, h, polynomial(kind, point, h, u))
        return observe(system, kind, point.t + h, point)

    return step
