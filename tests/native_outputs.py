"""What every law says of a motion, in arithmetic of 40 digits; its derivatives are differences there."""

from collections.abc import Callable
from typing import Any

import mpmath as mp
import numpy as np

from fmu_src.runtime.kinds import Law
from fmu_src.runtime.model import Floats, ReducedModel, row_starts

Vector = Any  # of mpmath numbers
Motion = Callable[[int], Vector]  # the derivative of this order of x or u


def derivatives_of(rows: Floats, t: mp.mpf) -> Motion:
    """Derivatives at t of the polynomial that has these at 0: (orders, n)."""

    def at(order: int) -> Vector:
        terms = ((t ** (k - order) / mp.factorial(k - order)) for k in range(order, len(rows)))
        zero = np.array([mp.mpf(0)] * rows.shape[1])
        return sum((c * row for c, row in zip(terms, exactly(rows[order:]), strict=False)), zero)

    return at


def exactly(array: Floats) -> Any:
    return np.array([mp.mpf(float(x)) for x in array.ravel()]).reshape(array.shape)


def value(model: ReducedModel, law: Law, first: int, q: Motion, u: Motion) -> mp.mpf:
    """One output from the displayed equations of the laws; its rows begin at `first`."""

    def row(k: int, motion: Vector, given: Vector | float = 0.0) -> mp.mpf:
        through = exactly(model.R[first + k]) @ given if isinstance(given, np.ndarray) else mp.mpf(0)
        return exactly(model.C[first + k]) @ motion + through

    match law:
        case "position":
            return row(0, q(0), u(0))
        case "velocity":
            return row(0, q(1), u(1))
        case "acceleration":
            return row(0, q(2), u(0))
        case "reaction":
            alpha, beta = mp.mpf(model.alpha), mp.mpf(model.beta)
            inertia = row(0, q(2) + alpha * q(1), u(0))
            return inertia + row(1, q(1)) + row(2, q(0) + beta * q(1))
        case "kinetic":
            P = -model.B[model.k :, model.motions]
            mass = np.block([[model.M_s, P.T], [P, np.eye(model.r)]])
            return q(1) @ exactly(mass) @ q(1) / 2
        case "strain":
            K = np.diag(model.lam)
            K[: model.k, : model.k] = model.K_s
            return (q(0) @ exactly(K) @ q(0) + u(0) @ exactly(model.R_in) @ u(0)) / 2
        case "mises":
            xx, yy, zz, xy, yz, zx = (row(k, q(0), u(0)) for k in range(6))
            mean = (xx + yy + zz) / 3
            deviator = [xx - mean, yy - mean, zz - mean, xy, yz, zx, xy, yz, zx]
            return mp.sqrt(mp.mpf(3) / 2 * sum(s * s for s in deviator))


def measured(model: ReducedModel, q: Floats, u: Floats) -> Floats:
    """y, ẏ, ÿ (3, p) of the motion with these derivatives: q (5, n), u (3, m), those of u beyond being 0."""
    starts = row_starts(model.laws)
    rows = []
    with mp.workdps(40):
        for law, first in zip(model.laws, starts, strict=False):

            def y(t: mp.mpf, law: Law = law, first: int = first) -> mp.mpf:
                return value(model, law, first, derivatives_of(q, t), derivatives_of(u, t))

            rows.append([float(mp.diff(y, 0, order)) if order else float(y(mp.mpf(0))) for order in range(3)])
    return np.array(rows).T
