"""Damping that couples modes: ΦᵀDΦ of a matrix D, and dashpots, free of couplings that are rounding only."""

from collections.abc import Sequence

import numpy as np
from scipy.sparse import csr_array

from .arrays import Bools, Floats
from .errors import ModalFmuError
from .rounding import EPS, ZERO

COUPLING = 1e-13  # of √(D_ii D_jj), or of a mode's largest amplitude: what is less is rounding
DIGITS = 1e-12  # of |φ|ᵀ|D||φ|: what the last digits of a matrix written as text leave of a zero


def projected_damping(
    lam: Floats, Phi: Floats, D: csr_array | None, dashpots: Sequence[tuple[csr_array, float]]
) -> Floats:
    """ΦᵀDΦ + Σ c (wΦ)ᵀ(wΦ) in 1/s: (r, r), exactly symmetric, ≥ 0.

    lam (r,) 1/s², Phi (n, r) mass-normalised, D (n, n) in N·s/m; dashpots: w (1, n) and c in N·s/m (or
    N·m·s/rad), whose force is c times the velocity w u̇. Modes that move without resistance of D or a dashpot,
    such as rigid motions across an inner dashpot, have rows that are exactly 0.
    Raises ModalFmuError: D is not symmetric or not ≥ 0, c is no finite number ≥ 0.
    """
    r = len(lam)
    total = np.zeros((r, r)) if D is None else _projection(D, Phi, lam == 0)
    for w, c in dashpots:
        if not 0 <= c < np.inf:
            raise ModalFmuError(f"dashpot: got damping = {c}, expected a finite number ≥ 0 in N.s/m")
        v = _relative_motion(w, Phi)
        total += c * np.outer(v, v)
    s = np.sqrt(np.diag(total))
    total[np.abs(total) <= COUPLING * np.outer(s, s)] = 0.0
    return total


def _relative_motion(w: csr_array, Phi: Floats) -> Floats:
    """wΦ (r,), exactly 0 where it is rounding: of the sum, or of a mode that is at rest there."""
    v = (w @ Phi)[0]
    return np.where(np.abs(v) > COUPLING * abs(w).sum() * np.abs(Phi).max(axis=0), v, 0.0)


def _projection(D: csr_array, Phi: Floats, rigid: Bools) -> Floats:
    """ΦᵀDΦ with rows of zeros where φᵀDφ is rounding: D ≥ 0, so that Dφ is 0 there."""
    _check_symmetry(D)
    P = Phi.T @ (D @ Phi)
    size = np.abs(Phi).T @ (abs(D) @ np.abs(Phi))  # of the terms that P sums
    zero = np.diag(P) <= np.where(rigid, DIGITS, ZERO * EPS) * np.diag(size)
    _check_definiteness(P, size)
    P[zero], P[:, zero] = 0.0, 0.0
    return np.asarray((P + P.T) / 2)


def _check_symmetry(D: csr_array) -> None:
    largest, difference = abs(D).max(), abs(D - D.T).max()
    if not difference <= DIGITS * largest:  # not a number either
        raise ModalFmuError(
            f"damping matrix D: got D - D' up to {difference:.3g} beside entries up to {largest:.3g}, "
            "expected a symmetric matrix; leave gyroscopic and circulatory terms out"
        )


def _check_definiteness(P: Floats, size: Floats) -> None:
    """Raise where xᵀPx < 0 beyond rounding, each mode measured by the terms that its entry sums."""
    s = np.sqrt(np.diag(size))
    s[s == 0] = 1.0  # a mode that D does not touch
    smallest = float(np.linalg.eigvalsh((P + P.T) / 2 / np.outer(s, s)).min(initial=0.0))
    if smallest < -DIGITS * len(s):
        raise ModalFmuError(
            f"damping matrix D: got a motion that gains energy (x'Dx = {smallest:.3g} |x|'|D||x|), expected "
            "D ≥ 0; check its signs and units, and write it with all digits"
        )
