"""Shift-invert Lanczos on what is not known yet."""

from collections.abc import Callable

import numpy as np
from scipy.sparse.linalg import ArpackError, LinearOperator, eigsh

from .arrays import Floats
from .errors import EigenError
from .factor import Factor
from .pencil import NEGATIVE, Pairs, Pencil, rayleigh_ritz

MEMORY = 8e9  # bytes of vectors
TOLERANCE = 1e-9  # of ARPACK, relative in 1/(λ − σ); the vectors' error, so that of λ is its square
RESIDUAL = 1e-7  # a hundred times that
SPARE = 20  # Lanczos vectors beyond 2k: with them 20 to 30 modes converge without a restart


def extend(
    pencil: Pencil, factor: Factor, known: Pairs, k: int, say: Callable[[str], None] = lambda line: None
) -> Pairs:
    """The known pairs and k more, the lowest of what is M-orthogonal to the known and the rigid modes.

    factor: of K − σM. The operator P (K − σM)⁻¹ PᵀM, P = I − ΦΦᵀM over the known and rigid Φ, has the
    eigenvalues 1/(λ − σ) and 0. P acts on both sides: where symmetry exhausts a Krylov space, Lanczos goes on
    from rounding, whose rigid part would grow by λ/|σ| at every step. All pairs are then refined by
    Rayleigh–Ritz and their residual is verified.
    Raises EigenError: no convergence, residual too large, memory.
    Source: Ericsson & Ruhe, Math. Comp. 35 (1980); Lehoucq, Sorensen & Yang, ARPACK Users' Guide, mode 3.
    """
    n = pencil.K.shape[0]
    total = k + len(known.lam)
    vectors = min(n, 2 * k + SPARE)
    check_memory(8 * n * (vectors + 5 * total), total, n)
    Q = np.column_stack([pencil.rigid, known.Phi])
    MQ = pencil.M @ Q
    solves = 0

    def solve_and_project(b: Floats) -> Floats:
        nonlocal solves
        solves += 1
        if solves % 20 == 0:
            say(f"Lanczos: {solves} solves")
        x = factor.solve(b - MQ @ (Q.T @ b))
        projected: Floats = x - Q @ (MQ.T @ x)
        return projected

    start = np.random.default_rng(Q.shape[1]).standard_normal(n)  # fixed: the same part, the same bits
    try:
        _, V = eigsh(
            pencil.K,
            k,
            pencil.M,
            sigma=pencil.sigma,
            OPinv=LinearOperator((n, n), matvec=solve_and_project, dtype=np.float64),
            v0=start - Q @ (MQ.T @ start),
            ncv=vectors,
            tol=TOLERANCE,
        )
    except ArpackError as error:
        raise EigenError(
            f"Lanczos: {k} modes of {n} DOFs did not converge ({error}); ask for fewer"
        ) from error
    pairs = rayleigh_ritz(pencil, np.column_stack([known.Phi, V]), f"Lanczos, {factor.name}")
    _verify(pencil, factor, pairs)
    return pairs


def check_memory(needed: float, modes: int, n: int) -> None:
    """Raise EigenError where the eigensolve would need more than 8 GB."""
    if needed > MEMORY:
        raise EigenError(
            f"modes: {modes} of {n} free DOFs would need {needed / 1e9:.1f} GB, the limit is "
            f"{MEMORY / 1e9:.0f} GB; ask for fewer modes or a lower max_frequency"
        )


def residuals(pencil: Pencil, factor: Factor, pairs: Pairs) -> Floats:
    """ρᵢ = ‖(K − σM)⁻¹ (Kφᵢ − λᵢMφᵢ)‖_M, (k,), factor: of K − σM.

    An eigenvalue μ of the pencil lies within |μ − λᵢ| ≤ ρᵢ (μ − σ). A plain norm of Kφ − λMφ would measure
    the rounding in the stiffest cells, which grows as the mesh is refined, this one does not.
    Source: residual bound of the operator (K − σM)⁻¹M, Parlett, The Symmetric Eigenvalue Problem, 4.5.
    """
    R = pencil.K @ pairs.Phi - (pencil.M @ pairs.Phi) * pairs.lam
    Y = factor.solve(R)
    Y -= pencil.rigid @ (pencil.rigid.T @ (pencil.M @ Y))
    return np.asarray(np.sqrt(np.sum(Y * (pencil.M @ Y), axis=0)))


def _verify(pencil: Pencil, factor: Factor, pairs: Pairs) -> None:
    if pairs.lam[0] < pencil.sigma:
        raise EigenError(NEGATIVE)
    rho = residuals(pencil, factor, pairs)
    # the rounding of Kφ, λ_ε, turns into a part of the lowest mode, which (K − σM)⁻¹ enlarges most
    allowed = RESIDUAL + pencil.noise / max(pairs.lam[0] - pencil.sigma, -pencil.sigma)
    if not np.all(rho <= allowed):
        worst = int(np.argmax(rho))
        raise EigenError(
            f"modes: got a residual of {rho[worst]:.1e} at elastic mode {worst + 1}, expected at most "
            f"{allowed:.1e}; check K and M for extreme values (units, slivers, stiff springs)"
        )
