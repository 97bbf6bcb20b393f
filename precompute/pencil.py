"""The pencil K − λM of the free DOFs, its rigid modes set apart."""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh
from scipy.sparse import csr_array

from .arrays import Floats
from .errors import EigenError
from .rounding import EPS

SHIFT = 1e4  # · λ_ε: K − σM stays positive definite whatever rounding does, and all modes stay apart
NEGATIVE = "K: got a motion of negative strain energy, expected none; check springs and where K comes from"


@dataclass(frozen=True)
class Pencil:
    """K φ = λ M φ on the M-orthogonal complement of the rigid modes.

    K, M: (n, n) in N/m and kg; rigid: (n, k), M-orthonormal; noise: λ_ε in 1/s², which is what rounding
    makes of λ = 0; precision: relative, of the entries of K.
    """

    K: csr_array
    M: csr_array
    rigid: Floats
    noise: float
    precision: float = EPS

    @property
    def sigma(self) -> float:
        """σ = −10⁴ λ_ε in 1/s².

        Negative, so that K − σM is positive definite with rigid motions left in K. So small that even the
        first mode of a 1000:1 beam lies above |σ|/1000 and Lanczos tells modes apart as it would
        with σ = 0; what a factor of K − σM then exaggerates, the rigid part, is projected out.
        """
        return -SHIFT * self.noise

    @property
    def elastic(self) -> int:
        """How many elastic modes there are: DOFs with mass, less the rigid modes."""
        return int(np.count_nonzero(self.M.diagonal())) - int(self.rigid.shape[1])

    def shifted(self, s: float) -> csr_array:
        """K − sM."""
        return csr_array(self.K - s * self.M)


@dataclass(frozen=True)
class Pairs:
    """Eigenvalues lam (k,) in 1/s², ascending, vectors Phi (n, k), ΦᵀMΦ = I, and what computed them."""

    lam: Floats
    Phi: Floats
    solver: str

    def first(self, k: int) -> "Pairs":
        """The k lowest."""
        return Pairs(self.lam[:k], self.Phi[:, :k], self.solver)


def nothing(pencil: Pencil) -> Pairs:
    """No pairs yet."""
    return Pairs(np.zeros(0), np.zeros((pencil.K.shape[0], 0)), "rigid motions only")


def rayleigh_ritz(pencil: Pencil, V: Floats, solver: str) -> Pairs:
    """VᵀKV x = λ VᵀMV x, φ = V x: the best pairs in span(V), V (n, k) of full rank.

    Raises EigenError: M is not positive definite.
    """
    V = V - pencil.rigid @ (pencil.rigid.T @ (pencil.M @ V))
    try:
        lam, X = eigh(V.T @ (pencil.K @ V), V.T @ (pencil.M @ V))
    except np.linalg.LinAlgError as error:
        raise EigenError(
            "M: got a negative kinetic energy, expected a positive definite mass matrix"
        ) from error
    return Pairs(lam, np.asfortranarray(V @ X), solver)
