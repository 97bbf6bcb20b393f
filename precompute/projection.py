"""The full model in fewer coordinates û, u = T û, some of which move a piece of it as one rigid body."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.sparse import csr_array

from .arrays import Floats, Ints
from .rigid import rigid_modes
from .system import System


def nearest(T: csr_array, U: Floats) -> Floats:
    """û = (TᵀT)⁻¹ Tᵀ u, whose T û is nearest to u; T (n, n̂) with orthogonal columns, U (n, k)."""
    lengths = np.asarray(T.multiply(T).sum(axis=0)).ravel()
    return np.asarray((T.T @ U) / lengths[:, None])


def projected(system: System, T: csr_array, bodies: Sequence[Ints]) -> System:
    """TᵀMT, TᵀDT, TᵀKT [2.21]; bodies: the columns of T that move one rigid body each."""
    M = _symmetric(T.T @ system.M @ T)
    K = _projected(system.K, system, T, bodies)
    D = None if system.D is None else _projected(system.D, system, T, bodies)
    return replace(system, M=M, K=K, D=D, rigid=nearest(T, system.rigid))


def _projected(A: csr_array, system: System, T: csr_array, bodies: Sequence[Ints]) -> csr_array:
    """Â = TᵀAT with R̂ᵀÂR̂ = 0 where A R = 0 for rigid motions R of the part, A = K or D.

    The forces inside a body cancel in Â, and what rounding leaves of them can exceed all of a softer part
    around it: −R̂_P⁺ᵀ (R̂ᵀÂR̂) R̂_P⁺ at its own coordinates P takes it out.
    """
    whole = _symmetric(T.T @ A @ T)
    R = nearest(T, rigid_modes(replace(system, K=A), np.zeros(0, dtype=np.int64)))
    for P in bodies:
        inverse = np.linalg.pinv(R[P])
        change = -inverse.T @ (R.T @ (whole @ R)) @ inverse
        rows, columns = np.meshgrid(P.astype(np.int32), P.astype(np.int32), indexing="ij")
        whole = _symmetric(whole + csr_array((change.ravel(), (rows.ravel(), columns.ravel())), whole.shape))
    return whole


def _symmetric(A: csr_array) -> csr_array:
    """(A + Aᵀ)/2: without the rounding of the products."""
    half = csr_array((A + A.T) / 2)
    half.sort_indices()
    return half
