"""The exact step of modal oscillators [2.33, 2.34]: over-, critically, under-damped and rigid.

With r₁, r₂ the roots of r² + d r + λ = 0 and x₁ = r₁h, x₂ = r₂h, every coefficient of the step is a
divided difference of exp, whatever the damping:

    E₁₂ = h exp[x₁, x₂],  G₀ = h² exp[x₁, x₂, 0],  G₁ = h³ exp[x₁, x₂, 0, 0],  G₂ = h⁴ exp[x₁, x₂, 0, 0, 0],
    G₃ = h⁵ exp[x₁, x₂, 0, 0, 0, 0].

Three evaluations, each free of cancellation where it is used:
small |x| a series, real roots differences of φ-functions, complex roots e^{-ah} cos, sin.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .model import Floats

SMALL = 1.5  # |x₂| below which the series is used; beyond it the closed forms lose at most a digit
LARGE = 1e300  # λh² from which on it or its inverse would not be a full number: no coefficients
TERMS = 30  # 1.5ᵏ (k+1)/(k+2)! falls below 1e-17 of the leading term before k = 25


@dataclass(frozen=True)
class Propagator:
    """[q, v](t+τ) at τ = h under the force f + ḟ τ + f̈ τ²/2 + f⃛ τ³/6:

    [q, v](t+h) = E(h) [q, v](t) + G₀(h) f + G₁(h) ḟ + G₂(h) f̈ + G₃(h) f⃛.

    E = [[E11, E12], [E21, E22]]; the velocity rows of G₀ … G₃ are their derivatives by h: E12, G₀, G₁, G₂.
    All arrays (r,), one entry per mode; h in s, E11, E22 in 1, E12 in s, E21 in 1/s, Gₖ in s^(k+2).
    """

    h: float
    E11: Floats
    E12: Floats
    E21: Floats
    E22: Floats
    G0: Floats
    G1: Floats
    G2: Floats
    G3: Floats


def propagator(lam: Floats, d: Floats, h: float) -> Propagator:
    """Coefficients of q̈ + d q̇ + λ q = f + ḟ τ + f̈ τ²/2 + f⃛ τ³/6 over a step h [2.32–2.34].

    lam: (r,) λ = ω² ≥ 0 in 1/s²; d: (r,) = α + βλ + … ≥ 0 in 1/s; h > 0 in s.
    Each coefficient is within 3e-15·(1 + ωh) of its largest absolute value over [h/2, 2h].
    Source: closed forms of Hauser et al. 2003 [2.33, 2.34], written as divided differences of exp
    (Higham, Functions of Matrices, 2008, B.16) so that no case and no limit between cases cancels.
    """
    disc = (
        0.5 * d
    ) ** 2 - lam  # its rounding is one of λ: the coefficients are smooth in λ, 0 = critical too
    s = np.sqrt(np.abs(disc))
    largest = np.where(disc > 0, 0.5 * d + s, np.sqrt(lam)) * h  # |x₂|
    within = lam * h * h < LARGE
    branches: tuple[tuple[NDArray[np.bool_], Callable[[Floats, Floats, Floats, float], Floats]], ...] = (
        (within & (largest < SMALL), _small),
        (within & (largest >= SMALL) & (disc >= 0), _real_roots),
        (within & (largest >= SMALL) & (disc < 0), _complex_roots),
    )
    e = np.full((7, len(lam)), np.nan)  # what no branch takes is beyond the numbers
    for mask, branch in branches:
        if mask.any():
            e[:, mask] = branch(lam[mask], d[mask], s[mask], h)
    E11, E12, E22 = e[0], e[1] * h, e[2]
    G0, G1, G2 = e[3] * h * h, e[4] * h * h * h, e[5] * h * h * h * h
    return Propagator(h, E11, E12, -lam * E12, E22, G0, G1, G2, e[6] * h * h * h * h * h)


def _small(lam: Floats, d: Floats, s: Floats, h: float) -> Floats:
    """exp[x₁, x₂, 0ⁿ] = Σₖ hₖ(x₁, x₂)/(k+1+n)!, hₖ the complete homogeneous symmetric polynomials.

    With δ = dh = −(x₁+x₂), Λ = λh² = x₁x₂: hₖ = −δ hₖ₋₁ − Λ hₖ₋₂, real for complex roots too.
    Then E₁₁ = 1 − Λ exp[x₁,x₂,0] and E₂₂ = E₁₁ − δ exp[x₁,x₂], since E₁₁ is the free motion from q = 1
    and also 1 minus the response to the constant force λ.
    """
    delta, Lam = d * h, lam * h * h
    before, sym = np.zeros_like(lam), np.ones_like(lam)
    e, g0, g1, g2, g3 = (np.zeros_like(lam) for _ in range(5))
    factorial = 1.0  # (k+1)!
    for k in range(TERMS):
        term = sym / factorial
        e += term
        g0 += term / (k + 2)
        g1 += term / ((k + 2) * (k + 3))
        g2 += term / ((k + 2) * (k + 3) * (k + 4))
        g3 += term / ((k + 2) * (k + 3) * (k + 4) * (k + 5))
        before, sym = sym, -delta * sym - Lam * before
        factorial *= k + 2
    E11 = 1.0 - Lam * g0
    return np.array([E11, e, E11 - delta * e, g0, g1, g2, g3])


def _real_roots(lam: Floats, d: Floats, s: Floats, h: float) -> Floats:
    """Over- and critically damped and rigid: x₂ ≤ x₁ ≤ 0, x₁ = −λh/(d/2 + s) without subtraction.

    exp[x₁, x₂]     = e^{x₁} exp[−z, 0],  z = x₁ − x₂ = 2sh
    exp[x₁, x₂, 0ⁿ] = (exp[x₁, 0ⁿ] − exp[x₁, x₂, 0ⁿ⁻¹])/(−x₂)
    With −x₂ ≥ 1.5 each difference is at least a fifth of its first term.
    """
    x2 = -(0.5 * d + s) * h
    x1 = lam * h * h / x2
    slow, phi_1, phi_2, phi_3, phi_4 = _phis(x1)
    spread = slow * _phis(-2.0 * s * h)[1]
    g0 = (phi_1 - spread) / -x2
    g1 = (phi_2 - g0) / -x2
    g2 = (phi_3 - g1) / -x2
    g3 = (phi_4 - g2) / -x2
    return np.array([slow - x1 * spread, spread, np.exp(x2) + x1 * spread, g0, g1, g2, g3])


def _complex_roots(lam: Floats, d: Floats, s: Floats, h: float) -> Floats:
    """Under-damped, a = d/2, w = √(λ − a²) = s: E₁₂ = e^{−ah} sin(wh)/w.

    λ G₀ = 1 − E₁₁, λ G₁ = h − E₁₂ − d G₀, λ G₂ = h²/2 − G₀ − d G₁ and λ G₃ = h³/6 − G₁ − d G₂ (the equation
    of motion integrated); with ωh ≥ 1.5 and d < 2ω no difference loses more than a digit.
    """
    ah, wh = 0.5 * d * h, s * h
    decay = np.exp(-ah)
    sine = decay * np.sin(wh) / wh
    cosine = decay * np.cos(wh)
    E11 = cosine + ah * sine
    Lam = lam * h * h
    g0 = (1.0 - E11) / Lam
    g1 = (1.0 - sine - d * h * g0) / Lam
    g2 = (0.5 - g0 - d * h * g1) / Lam
    g3 = (1 / 6 - g1 - d * h * g2) / Lam
    return np.array([E11, sine, cosine - ah * sine, g0, g1, g2, g3])


def _phis(x: Floats) -> tuple[Floats, Floats, Floats, Floats, Floats]:
    """φₙ(x) = exp[x, 0ⁿ] = Σ xᵏ/(k+n)! for x ≤ 0, n = 0 … 4; far from 0 by φₙ = (φₙ₋₁ − 1/(n−1)!)/x."""
    near = np.maximum(x, -1.0)
    series = np.zeros_like(x)
    for k in range(20, 0, -1):  # Horner: Σ xᵏ/(k+4)! = (1 + x/5 (1 + x/6 (1 + …)))/24
        series = 1.0 + near / (k + 4) * series
    near_3 = (1.0 + near / 4 * series) / 6.0
    near_2 = 0.5 + near * near_3
    far = np.minimum(x, -1.0)
    far_1 = np.expm1(far) / far
    far_2 = (far_1 - 1.0) / far
    far_3 = (far_2 - 0.5) / far
    at = x > -1.0
    return (
        np.exp(x),
        np.where(at, 1.0 + near * near_2, far_1),
        np.where(at, near_2, far_2),
        np.where(at, near_3, far_3),
        np.where(at, series / 24.0, (far_3 - 1 / 6) / far),
    )
