"""All elastic modes of a small pencil at once."""

import numpy as np
from scipy.linalg import qr

from .arrays import Floats
from .errors import EigenError
from .lanczos import check_memory
from .pencil import Pairs, Pencil, rayleigh_ritz

ARRAYS = 8  # of n × n doubles at the peak


def dense_modes(pencil: Pencil) -> Pairs:
    """ZᵀKZ x = λ ZᵀMZ x, φ = Z x, with Z a basis of what is M-orthogonal to the rigid modes.

    Gives all n − k − b elastic pairs for k rigid modes and b DOFs without mass.
    Raises EigenError: more memory than 8 GB, M not positive definite, DOFs without mass and stiffness.
    """
    n = pencil.K.shape[0]
    check_memory(8 * ARRAYS * n**2, n, n)
    T = _with_mass(pencil)
    rigid = T.T @ (pencil.M @ pencil.rigid)
    Z = T @ qr(rigid)[0][:, rigid.shape[1] :] if rigid.shape[1] else T
    return rayleigh_ritz(pencil, Z, "dense, LAPACK")


def _with_mass(pencil: Pencil) -> Floats:
    """T (n, n − b): DOFs without mass follow the others statically, u_b = −K_bb⁻¹ K_ba u_a, exactly."""
    massless = pencil.M.diagonal() == 0
    T = np.zeros((len(massless), int(np.sum(~massless))))
    T[~massless] = np.eye(T.shape[1])
    if massless.any():
        K_b = pencil.K[np.flatnonzero(massless)].toarray()
        try:
            T[massless] = -np.linalg.solve(K_b[:, massless], K_b[:, ~massless])
        except np.linalg.LinAlgError as error:
            raise EigenError(
                "K: got DOFs without mass that nothing holds; give them mass or stiffness"
            ) from error
    return T
