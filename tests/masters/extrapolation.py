"""What a master believes of the inputs over a step: held, linear, or quadratic by derivatives.

From t to t + h every input is a polynomial that ends at the value û at t + h:

    hold        u(s) = û
    linear      u(s) = u + (û − u) s/h
    derivative  u(s) = u + u̇ s + (û − u − u̇h) s²/h²        (Hermite)

û = g(t+h, ŷ) comes from outputs ŷ: what a part has already computed, or a prediction,

    hold        ŷ = y
    linear      ŷ = y + (y − y₋)/h₋ h        y₋ at the point before
    derivative  ŷ = y + ẏ h + ÿ h²/2         which makes u(s) Taylor's polynomial, if g is linear

Between the points the inputs are wrong by O(h), O(h²), O(h³), and the parts step exactly under them, so a
master has order 1, 2, 3. Source: Kübler and Schiehlen, Two methods of simulator coupling, Math. Comput.
Model. Dyn. Syst. 6 (2000) 93–113; Busch, Zur effizienten Kopplung von Simulationsprogrammen, Kassel 2012.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from coupled import Coupled

from fmu_src.runtime.model import Floats

Kind = Literal["hold", "linear", "derivative"]
ORDER = {"hold": 1, "linear": 2, "derivative": 3}


@dataclass(frozen=True, eq=False)
class Point:
    """What a master knows at a communication point.

    t in s; Y: y, or y, ẏ, ÿ, (1 or 3, p); U: u, or u, u̇, (1 or 2, m): with rates where the master asks for
    them; before: t, y at the point before, none at the start, where linear extrapolation begins with a hold.
    """

    t: float
    Y: Floats
    U: Floats
    before: tuple[float, Floats] | None = None

    @property
    def y(self) -> Floats:
        """The outputs (p,)."""
        return self.Y[0]

    @property
    def u(self) -> Floats:
        """The inputs (m,) that the outputs here ask for."""
        return self.U[0]


def observe(system: Coupled, kind: Kind, t: float, before: Point | None = None) -> Point:
    """The system at t. Rates follow from each other: u gives ẏ, that gives u̇, and that gives ÿ."""
    Y = system.y()[None]
    U = system.law(t, Y[0])[None]
    if kind == "derivative":
        system.set(U)
        Y = np.stack([*Y, system.rates(1)])
        U = np.stack([*U, system.law.rate(1, t, Y)])
        system.set(U)
        Y = np.stack([*Y, system.rates(2)])
    return Point(t, Y, U, None if before is None else (before.t, before.y))


def predicted(kind: Kind, point: Point, h: float) -> Floats:
    """ŷ (p,) at t + h."""
    if kind == "derivative":
        y, y_dot, y_ddot = point.Y
        return y + h * y_dot + h**2 / 2 * y_ddot
    if kind == "linear" and point.before is not None:
        t, y = point.before
        return point.y + h * (point.y - y) / (point.t - t)
    return point.y.copy()


def polynomial(kind: Kind, point: Point, h: float, u_end: Floats) -> Floats:
    """u, u̇, ü at t (1 … 3, m) of the polynomial that ends at û."""
    match kind:
        case "hold":
            return u_end[None]
        case "linear":
            return np.stack([point.u, (u_end - point.u) / h])
        case "derivative":
            u, u_dot = point.U
            return np.stack([u, u_dot, 2 * (u_end - u - h * u_dot) / h**2])
