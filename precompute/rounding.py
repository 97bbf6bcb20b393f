"""What rounding leaves of K: when a strain energy is zero, and how small an eigenvalue can be."""

import numpy as np
from scipy.sparse import csr_array

from .arrays import Bools, Floats
from .errors import EigenError

EPS = float(np.finfo(float).eps)
COARSEST = 1e-8  # more than this of |φ|ᵀ|K||φ| is no rounding but an indefinite K
ZERO = 2.0  # · ε |φ|ᵀ|K||φ|: mechanisms show up to 0.3, the first mode of a 1000:1 beam 20 and more


def energies(K: csr_array, Phi: Floats, precision: float = EPS) -> tuple[Floats, Floats]:
    """φᵢᵀ K φᵢ and what the rounding of K makes of it, ε |φᵢ|ᵀ |K| |φᵢ|, for the columns φᵢ of Phi (n, r).

    precision: ε, relative, of the entries of K: that of double precision, or of the digits a file prints.
    The second is local: a soft region is measured by its own stiffness, a stiff one by its own, and
    neither units nor the size of the part matter.
    """
    size = np.abs(Phi)
    return np.sum(Phi * (K @ Phi), axis=0), precision * np.sum(size * (abs(K) @ size), axis=0)


def without_energy(K: csr_array, Phi: Floats, precision: float = EPS) -> Bools:
    """Which columns of Phi have no strain energy: φᵀKφ is not more than its rounding."""
    energy, rounding = energies(K, Phi, precision)
    return np.asarray(energy <= ZERO * rounding)


def rounding_shown(K: csr_array, R: Floats) -> float:
    """−min λ of S RᵀKR S, S = 1/√(|R|ᵀ|K||R|): the relative rounding of K that its rigid motions R show.

    The K of a part has no motion of negative energy; what rigid ones, which have none at all, seem to have
    of it is rounding. 0 where they have none, or more than rounding can be.
    """
    size = np.abs(R)
    scale = np.sqrt(np.sum(size * (abs(K) @ size), axis=0))
    S = np.divide(1.0, scale, out=np.zeros_like(scale), where=scale > 0)
    lowest = float(np.linalg.eigvalsh(S[:, None] * (R.T @ (K @ R)) * S)[0])
    return -lowest if -COARSEST < lowest < 0 else 0.0


def eigenvalue_noise(K: csr_array, M: csr_array, translations: Floats, precision: float = EPS) -> float:
    """λ_ε = ε tᵀ|K|t / tᵀMt in 1/s² with t the sum of the translations: what rounding makes of λ = 0.

    translations: (n, 3); precision: ε, of the entries of K. It is ε times a mean of the largest eigenvalues
    of the cells, needs no mesh and survives DOFs without mass. Raises EigenError: no mass.
    """
    t = np.abs(translations).sum(axis=1)
    if not t.any():
        t = np.ones(len(t))
    mass = float(t @ (M @ t))
    if not mass > 0:
        raise EigenError(f"M: got a total mass of {mass:g} on the free DOFs; expected a positive one")
    return precision * float(t @ (abs(K) @ t)) / mass
