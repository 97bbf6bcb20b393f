"""The exact step of modes that damping couples: q̈ + D̃ q̇ + Λ q = f with a full D̃ ≥ 0 [2.22, 2.32].

In the coordinates [w q, v], w = max(ω, 1/h), whose squares are energies where ωᵢh ≥ 1, the elastic part of
A = [[0, W], [−Λ W⁻¹, −D̃]] is skew but for −D̃, so ‖A‖ says how far a series reaches. Nothing is diagonalised:
a rigid mode and a critical pair have no full set of eigenvectors.
"""

import math
from dataclasses import dataclass

import numpy as np

from .model import Floats

SERIES = 1.5  # ‖A‖h up to which the series is used
TERMS = 26  # 1.5²⁶/26! < 1e-21
LARGE = 1e15  # ‖A‖h: no digit would be left


@dataclass(frozen=True)
class CoupledPropagator:
    """[q, v](t+h) = E [q, v](t) + G₀ f + G₁ ḟ + G₂ f̈ + G₃ f⃛ for g modes, E = [[E11, E12], [E21, E22]].

    All (g, g), units as in `Propagator`; the velocity rows of G₀ … G₃ are E12, G₀, G₁, G₂.
    """

    E11: Floats
    E12: Floats
    E21: Floats
    E22: Floats
    G0: Floats
    G1: Floats
    G2: Floats
    G3: Floats


def coupled_propagator(lam: Floats, D: Floats, h: float) -> CoupledPropagator:
    """Series over h/2ˢ and s doublings of P = E12, N = E22 − I, G₀ … G₃, all symmetric.

    lam: (g,) ascending, 1/s²; D: (g, g) D̃ symmetric ≥ 0 in 1/s; h > 0 in s. E11 = I − G₀Λ and E21 = −PΛ.
    Two steps of h are one of 2h, for the motion and for a force f + ḟ τ + … alike; with Y = −G₀Λ:

        P ← 2P + P N + Y P,  N ← 2N + N N − P Λ P,  G₀ ← 2G₀ + P P + Y G₀,
        G₁ ← 2G₁ + h G₀ + P G₀ + Y G₁,  G₂ ← 2G₂ + h G₁ + h²/2 G₀ + P G₁ + Y G₂,
        G₃ ← 2G₃ + h G₂ + h²/2 G₁ + h³/6 G₀ + P G₂ + Y G₃.

    What is doubled are the deviations from standing still, so that slow modes keep their digits beside fast
    ones; and of every matrix only the half where the row is the faster mode: products in the other half have
    the rounding errors of the slower mode, too large by the ratio of the two.
    The error is a few ε (1 + ‖A‖h), and ε (1 + ωh) where D̃ is graded as Λ is; NaN where ‖A‖h > 1e15.
    Source: scaling and squaring, Higham, Functions of Matrices, 2008, chapter 10.
    """
    g = len(lam)
    x = np.sqrt(lam) * h
    size = float(np.max([x, x * np.minimum(x, 1.0) + np.abs(D).sum(axis=1) * h], initial=1.0))
    if not size < LARGE:
        return CoupledPropagator(*np.full((8, g, g), np.nan))
    halvings = max(0, math.ceil(math.log2(size / SERIES)))
    h = h / 2**halvings
    P, N, G0, G1, G2, G3 = map(_lower_half, _series(lam, D, h))
    for _ in range(halvings):
        Y, E21 = -G0 * lam, -P * lam
        P, N, G0, G1, G2, G3 = map(
            _lower_half,
            (
                2 * P + (P @ N + Y @ P),
                2 * N + (N @ N + E21 @ P),
                2 * G0 + (P @ P + Y @ G0),
                2 * G1 + h * G0 + (P @ G0 + Y @ G1),
                2 * G2 + h * G1 + h**2 / 2 * G0 + (P @ G1 + Y @ G2),
                2 * G3 + h * G2 + h**2 / 2 * G1 + h**3 / 6 * G0 + (P @ G2 + Y @ G3),
            ),
        )
        h = 2 * h
    one = np.eye(g)
    return CoupledPropagator(one - G0 * lam, P, -P * lam, one + N, G0, G1, G2, G3)


def _lower_half(A: Floats) -> Floats:
    """The symmetric matrix with this half below the diagonal."""
    half: Floats = np.tril(A) + np.tril(A, -1).T
    return half


def _series(lam: Floats, D: Floats, h: float) -> tuple[Floats, ...]:
    """P₀ = 0, P₁ = I, Pₖ₊₁ = −Dh Pₖ − Λh² Pₖ₋₁: P = h Σ Pₖ/k!, N = Σ Pₖ₊₁/k!, Gₙ = hⁿ⁺² Σ Pₖ/(k+1+n)!."""
    before, now = np.zeros_like(D), np.eye(len(lam))
    P, N, G0, G1, G2, G3 = np.zeros((6, *D.shape))
    for k in range(TERMS):
        term = now / math.factorial(k + 1)
        P = P + h * term
        N = N + (k + 1) * term if k else N  # but for I
        G0 = G0 + h**2 / (k + 2) * term
        G1 = G1 + h**3 / ((k + 2) * (k + 3)) * term
        G2 = G2 + h**4 / ((k + 2) * (k + 3) * (k + 4)) * term
        G3 = G3 + h**5 / ((k + 2) * (k + 3) * (k + 4) * (k + 5)) * term
        before, now = now, _lower_half(-h * D @ now - h**2 * lam[:, None] * before)
    return P, N, G0, G1, G2, G3
