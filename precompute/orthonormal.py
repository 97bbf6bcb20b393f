"""M-orthonormal bases, dependent vectors left out."""

import numpy as np
from scipy.sparse import csr_array

from .arrays import Floats

DEPENDENT = 1e-13  # of VᵀMV scaled to a unit diagonal: a part of 3e-7 of a vector counts as its own


def orthonormal(V: Floats, M: csr_array) -> Floats:
    """Q with QᵀMQ = I and span(Q) = span(V): V (n, k) gives Q (n, r), r ≤ k.

    Left out are combinations that vanish to rounding and vectors without mass. Twice, since the first pass
    leaves QᵀMQ − I as large as rounding over DEPENDENT.
    Source: Stathopoulos & Wu, SIAM J. Sci. Comput. 23 (2002), algorithm SVQB.
    """
    for _ in range(2):
        gram = V.T @ (M @ V)
        diagonal = np.diag(gram)
        V, gram = V[:, diagonal > 0], gram[np.ix_(diagonal > 0, diagonal > 0)]
        scale = 1 / np.sqrt(np.diag(gram))
        mu, X = np.linalg.eigh(scale[:, None] * gram * scale)
        kept = mu > DEPENDENT * mu.max(initial=0.0)
        V = V @ (scale[:, None] * X[:, kept] / np.sqrt(mu[kept]))
    return V


def extended(V: Floats, X: Floats, M: csr_array, new: float) -> Floats:
    """V (n, k), M-orthonormal, with the columns of X (n, m) made so one after the other: (n, ≤ k + m).

    new: what must be left of a vector, in the norm of M; those with less, or without mass, are left out.
    Gram–Schmidt, twice for rounding.
    """
    for x in X.T:
        whole = np.sqrt(x @ (M @ x))
        for _ in range(2):
            x = x - V @ (V.T @ (M @ x))
        norm = np.sqrt(x @ (M @ x))
        if norm > new * whole:
            V = np.column_stack([V, x / norm])
    return V
