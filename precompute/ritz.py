"""The modes of the full model as a subspace knows them: any basis ends as modal oscillators."""

import numpy as np
from scipy.linalg import qr
from scipy.sparse import csr_array

from .arrays import Floats
from .canonical import canonical, canonical_vectors
from .eigen import Modes, check_orthonormal
from .errors import EigenError
from .notice import notice, warning
from .orthonormal import orthonormal
from .pencil import Pencil, nothing, rayleigh_ritz
from .rounding import eigenvalue_noise
from .system import System
from .zero_energy import Where, refuse_mechanisms

FASTEST = 1e4  # · max K_ii/M_ii: far beyond the largest λ, which is a few times that
CONTAINED = 1e-6  # of a rigid mode may lie outside span(V), as in matrices written with seven digits


def reduced_modes(
    V: Floats, system: System, rigid: Floats, solver: str, where: Where = "DOF {}".format
) -> Modes:
    """VᵀKV x = λ VᵀMV x, φ = V x [2.21, 2.23]: the stationary motions within span(V).

    V: (n, k), 0 at the fixed DOFs, any scale; rigid: (n, j) M-orthonormal, those that the supports leave.
    Rigid modes within span(V) are kept as they are, with λ = 0; the others are M-orthogonal to them. No λ is
    below that of the full model (Rayleigh, Ritz), nor does it rise with a larger span(V). Motions in span(V)
    that move no mass, as those of rotations without inertia may, are no modes: they follow statically.
    Raises EigenError: V is empty or not finite; ZeroEnergyError: an elastic motion without strain energy.
    """
    if not np.isfinite(V).all():
        raise EigenError("basis: got a vector that is not finite, expected finite numbers")
    M = system.M
    Q = _with_mass(V, system)
    if Q.shape[1] == 0:
        raise EigenError(f"basis: got {V.shape[1]} vectors and no motion that has mass; expected one")
    if Q.shape[1] < V.shape[1]:
        dropped = V.shape[1] - Q.shape[1]
        notice(f"basis: {dropped} of {V.shape[1]} vectors depend on the others or move no mass: left out")
    kept = _contained(rigid, Q, M)
    if kept.shape[1] < rigid.shape[1]:
        warning(
            f"basis: it lacks {rigid.shape[1] - kept.shape[1]} of the {rigid.shape[1]} rigid motions that "
            "the supports leave, so the part cannot move so; add them to the basis, or support the part"
        )
    elastic = Q @ qr(Q.T @ (M @ kept))[0][:, kept.shape[1] :] if kept.shape[1] else Q
    noise = eigenvalue_noise(system.K, M, system.rigid[:, :3], system.precision)
    pencil = Pencil(system.K, M, kept, noise, system.precision)
    pairs = canonical(rayleigh_ritz(pencil, elastic, solver)) if elastic.shape[1] else nothing(pencil)
    refuse_mechanisms(pencil, pairs, np.arange(len(V)), where)
    Phi = np.column_stack([kept, pairs.Phi])
    check_orthonormal(system, Phi)
    return Modes(np.concatenate([np.zeros(kept.shape[1]), pairs.lam]), Phi, kept.shape[1], solver)


def _with_mass(V: Floats, system: System) -> Floats:
    """Q with QᵀMQ = I: span(V) but for its motions N without mass, and QᵀKN = 0.

    Mass is a motion's share in its norm by A = M + K/λ_∞ with λ_∞ beyond all modes: 1 to rounding or 0. The
    eigenvectors of M against A are orthogonal by M and by A, so by K too.
    """
    M, K = system.M, system.K
    massive = M.diagonal() > 0
    beyond = FASTEST * float(np.max(K.diagonal()[massive] / M.diagonal()[massive], initial=0.0)) or 1.0
    W = orthonormal(V, csr_array(M + K / beyond))
    share, X = np.linalg.eigh(W.T @ (M @ W))
    return orthonormal(W @ X[:, share > 0.5], M)


def _contained(rigid: Floats, Q: Floats, M: csr_array) -> Floats:
    """Those combinations of the rigid modes that lie in span(Q), M-orthonormal: (n, ≤ j)."""
    outside = rigid - Q @ (Q.T @ (M @ rigid))
    squares, Y = np.linalg.eigh(outside.T @ (M @ outside))
    inside = squares <= CONTAINED**2
    return rigid if inside.all() else canonical_vectors(rigid @ Y[:, inside])
