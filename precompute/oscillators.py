"""Oscillators between ports in the frequency domain: (k − ω²m + iωD) q = B u, k and m diagonal."""

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from fmu_src.runtime.model import ReducedModel

from .arrays import Bools, Floats, Ints

Complexes: TypeAlias = NDArray[np.complex128]

MASSLESS = 1e-30  # s²: with m/k below it nothing swings
DRIFT = 1e-3  # of the lowest √(k/m): slower roots are those of rigid motions, 0 but for rounding


@dataclass(frozen=True, eq=False)  # arrays have no one truth value
class Oscillators:
    """m q̈ + D q̇ + k q = B u with the measured rows C q and R u.

    k, m: (r,) diagonals of stiffness and mass; D: (r, r) symmetric ≥ 0, all damping; B: (r, n_u);
    C: (s, r); R: (s, n_u); alpha: 1/s, the share of D that is α m, which reactions ask for.
    """

    k: Floats
    m: Floats
    D: Floats
    B: Floats
    C: Floats
    R: Floats
    alpha: float


def oscillators_of(model: ReducedModel) -> Oscillators:
    """q̈ + D̃ q̇ + Λ q = B u [2.32], all modes active: the motion relative to what is prescribed."""
    modes = slice(model.k, None)
    lam = model.lam[modes]
    D = model.D_rest[modes, modes] + np.diag(model.alpha + model.beta * lam)
    return Oscillators(lam, np.ones_like(lam), D, model.B[modes], model.C[:, modes], model.R, model.alpha)


def amplitudes(system: Oscillators, omega: Floats, load: Floats) -> Complexes:
    """q(ω) = (k − ω²m + iωD)⁻¹ load: (f, r, p) from omega (f,) in rad/s and load (r, p).

    One division per oscillator; those that D couples are solved for together.
    """
    w = omega[:, None]
    own = system.k - w**2 * system.m + 1j * w * np.diag(system.D)
    coupled, alone = _by_damping(system.D)
    q = np.zeros((len(omega), *load.shape), dtype=complex)
    q[:, alone] = load[alone] / own[:, alone, None]
    if len(coupled):
        A = 1j * omega[:, None, None] * system.D[np.ix_(coupled, coupled)]
        A[:, np.arange(len(coupled)), np.arange(len(coupled))] = own[:, coupled]
        q[:, coupled] = np.linalg.solve(
            A, np.broadcast_to(load[coupled], (len(omega), len(coupled), load.shape[1]))
        )
    return q


def resonances(system: Oscillators) -> tuple[Floats, Floats]:
    """Frequencies |s|/2π in Hz and damping ratios −Re s/|s| of what swings, s²m + sD + k = 0.

    Damping that couples oscillators can hold a body so fast that it swings as if it were supported there, far
    from every √(k/m): these are the roots of all the coupled ones together.
    """
    k, m, D = system.k, system.m, system.D
    elastic = (k > 0) & (m > MASSLESS * k)
    coupled, alone = _by_damping(D)
    alone = alone[elastic[alone]]
    zeta = np.diag(D)[alone] / (2 * np.sqrt(k[alone] * m[alone]))
    roots = np.zeros(0, dtype=complex)
    if elastic[coupled].any():
        roots = _roots(k[coupled], m[coupled], D[np.ix_(coupled, coupled)], elastic[coupled])
    frequency = np.concatenate([np.sqrt(k[alone] / m[alone]), np.abs(roots)]) / (2 * np.pi)
    return frequency, np.concatenate([zeta, -roots.real / np.abs(roots)])


def _roots(k: Floats, m: Floats, D: Floats, elastic: Bools) -> Complexes:
    """s with Im s > 0 of s²m + sD + k = 0, by ν = 1/(s/w − 1): no motion grows, so s = w > 0 is no root."""
    w = np.sqrt(np.min(k[elastic] / m[elastic]))
    size = 1 / np.sqrt(k + w**2 * m)
    k, m, D = k * size**2, w**2 * m * size**2, w * D * np.outer(size, size)
    one, none = np.eye(len(k)), np.zeros_like(D)
    shifted = np.block([[-one, one], [-np.diag(k), -D - np.diag(m)]])
    state = np.linalg.solve(shifted, np.block([[one, none], [none, np.diag(m)]]))
    nu = np.linalg.eigvals(state).astype(complex)
    s = 1 + 1 / nu[np.abs(nu) > MASSLESS]
    return np.asarray(w * s[(s.imag > 0) & (np.abs(s) > DRIFT)])


def _by_damping(D: Floats) -> tuple[Ints, Ints]:
    """The oscillators that D (r, r) couples to others, and those that it leaves alone."""
    off = (D - np.diag(np.diag(D))).any(axis=1)
    return np.flatnonzero(off), np.flatnonzero(~off)
