"""Rayleigh damping recognised in a damping matrix."""

from dataclasses import replace

import numpy as np
from scipy.sparse import csr_array

from .arrays import Floats
from .coupled_damping import DIGITS
from .notice import notice
from .system import System


def split_rayleigh(system: System) -> tuple[System, tuple[float, float]]:
    """The system without D, and (α, β), where D = αM + βK with α, β ≥ 0; else the same and (0, 0).

    α in 1/s, β in s by least squares over the entries. Such a D leaves the modes uncoupled, exactly, and its
    α, β can be tuned at run time: a notice says so.
    """
    D = system.D
    if D is None or D.nnz == 0:
        return replace(system, D=None), (0.0, 0.0)
    terms = (system.M, system.K)
    sizes = np.array([abs(A).max() for A in terms])
    share = _least_squares([A / size for A, size in zip(terms, sizes, strict=True)], D)
    share[np.abs(share) <= DIGITS * abs(D).max()] = 0.0
    alpha, beta = (float(x) for x in share / sizes)
    rest = D - alpha * system.M - beta * system.K
    if share.min() < 0 or abs(rest).max() > DIGITS * abs(D).max():
        return system, (0.0, 0.0)
    notice(f"damping matrix D: it is alpha M + beta K with alpha = {alpha:.4g} 1/s, beta = {beta:.4g} s")
    return replace(system, D=None), (alpha, beta)


def _least_squares(terms: list[csr_array], D: csr_array) -> Floats:
    """x (2,) that minimises the sum of the squares of the entries of D − x₀ terms₀ − x₁ terms₁."""
    G = np.array([[_inner(A, B) for B in terms] for A in terms])
    return np.asarray(np.linalg.lstsq(G, np.array([_inner(A, D) for A in terms]), rcond=None)[0])


def _inner(A: csr_array, B: csr_array) -> float:
    """Σ A_ij B_ij."""
    return float(A.multiply(B).sum())
