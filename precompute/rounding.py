"""What rounding leaves of K: when a strain energy is zero, and how small an eigenvalue can be."""

import numpy as np
from scipy.sparse import csr_array

from .arrays import Bools, Floats
from .errors import EigenError

EPS = float(np.finfo(float).eps)
ZERO = 2.0  # · ε |φ|ᵀ|K||φ|: mechanisms show up to 0.3, the first mode of a 1000:1 beam 20 and more


def energies(K: csr_array, Phi: Floats) -> tuple[Floats, Floats]:
    """φᵢᵀ K φᵢ and the rounding of its own evaluation, ε |φᵢ|ᵀ |K| |φᵢ|, for the columns φᵢ of Phi (n, r).

    The second is local: a soft region is measured by its own stiffness, a stiff one by its own, and
    neither units nor the size of the part matter.
    """
    size = np.abs(Phi)
    return np.sum(Phi * (K @ Phi), axis=0), EPS * np.sum(size * (abs(K) @ size), axis=0)


def without_energy(K: csr_array, Phi: Floats) -> Bools:
    """Which columns of Phi have no strain energy: φᵀKφ is not more than its rounding."""
    energy, rounding = energies(K, Phi)
    return np.asarray(energy <= ZERO * rounding)


def eigenvalue_noise(K: csr_array, M: csr_array, translations: Floats) -> float:
    """λ_ε = ε tᵀ|K|t / tᵀMt in 1/s² with t the sum of the translations: what rounding makes of λ = 0.

    translations: (n, 3). It is ε times a mean of the largest eigenvalues of the cells, needs no mesh and
    survives DOFs without mass. Raises EigenError: no mass.
    """
    t = np.abs(translations).sum(axis=1)
    if not t.any():
        t = np.ones(len(t))
    mass = float(t @ (M @ t))
    if not mass > 0:
        raise EigenError(f"M: got a total mass of {mass:g} on the free DOFs; expected a positive one")
    return EPS * float(t @ (abs(K) @ t)) / mass
