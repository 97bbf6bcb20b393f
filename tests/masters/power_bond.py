"""Energy-conserving coupling: over a step a bond holds the force whose work is what its spring takes up.

Two ports with forces F₁ = −f, F₂ = f and the elongation δ = x₁ − x₂ between them: forces that are held do the
work ∫F₁ẋ₁ + F₂ẋ₂ = −f Δδ over a step, exactly, whatever the parts do in between. The spring takes up
Δ(½kδ²) = k δ̄ Δδ with δ̄ the mean of δ at both ends. So with the held force

    f = k (δ + δ₊)/2 + c (δ₊ − δ)/h

the bond makes no energy: parts and spring together lose c Δδ²/h ≥ 0 by it, whatever h is, and what the parts
lose in themselves; so no step is unstable. f depends on δ₊: interface Newton finds it, in one correction.
Order 2: the mean of f over the step is right to O(h²).
Source: the discrete gradient of Gonzalez, Time integration and discrete Hamiltonian systems, J. Nonlinear
Sci. 6 (1996) 449–467, on power bonds as in Sadjina, Kyllingstad, Skjong and Pedersen, Energy conservation and
power bonds in co-simulations, Engineering with Computers 33 (2017) 607–620.
"""

from dataclasses import dataclass

import numpy as np
from coupled import Coupled, Linear
from extrapolation import Point
from interface_newton import interface_newton
from run import Step

from fmu_src.runtime.model import Floats


@dataclass(frozen=True, eq=False)
class Bonds:
    """Springs and dampers: elongations δ = G y (b, p), inputs u = −W (k δ + c δ̇) + e(t), W (m, b).

    k (b,) in N/m, c (b,) in N·s/m. Power-conjugate: the row of W of an input is the column of G of the
    displacement that it does its work on.
    """

    G: Floats
    W: Floats
    k: Floats
    c: Floats


def power_bond(bonds: Bonds) -> Step:
    """A step with the force above in every bond; external forces as in the middle of the step, held."""

    def over_the_step(system: Coupled, point: Point, h: float) -> Linear:
        assert isinstance(system.law, Linear)  # for its external forces
        half, viscous = bonds.k / 2, bonds.c / h
        L = -bonds.W @ np.diag(half + viscous) @ bonds.G
        given = -bonds.W @ np.diag(half - viscous) @ bonds.G @ point.y + system.law.e(point.t + h / 2, 0)
        return Linear(L, lambda t, order: given)

    return interface_newton("hold", over_the_step)


def stored(bonds: Bonds, y: Floats) -> Floats:
    """½ Σ k δ² in J of outputs y (…, p)."""
    energy: Floats = 0.5 * np.einsum("b,...b->...", bonds.k, (y @ bonds.G.T) ** 2)
    return energy
