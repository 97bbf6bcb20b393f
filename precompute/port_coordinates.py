"""The full model in the coordinates of its exact modes and of a growing energy basis."""

from dataclasses import replace

import numpy as np
from scipy.sparse import csc_array, csr_array, diags

from .arrays import Floats
from .damping import Damping
from .extra_damping import ExtraDamping
from .full_model import FullModel
from .interface import Interface
from .known_modes import KnownModes
from .statics import StaticSolver


def bending_part(b: csc_array, solve: StaticSolver) -> csc_array:
    """b with 0 in place of loads that inertia takes up whole, such as gravity on a free body."""
    return csc_array(b @ diags(solve.deforms(b.toarray()).astype(float)))


def distinct_columns(A: csc_array) -> Floats:
    """The columns of A that are not multiples of an earlier one, nor 0: (n, p)."""
    first: dict[tuple[bytes, bytes], int] = {}
    for j in range(A.shape[1]):
        span = slice(A.indptr[j], A.indptr[j + 1])
        rows, values = A.indices[span], A.data[span]
        rows, values = rows[values != 0], values[values != 0]
        if len(values):
            order = np.argsort(rows)
            shape = np.round(values[order] / values[order][np.argmax(np.abs(values[order]))], 12) + 0.0
            first.setdefault((rows[order].tobytes(), shape.tobytes()), j)
    return np.asarray(A[:, np.array([*first.values()], dtype=np.int64)].toarray())


def known_part(
    known: KnownModes, damping: Damping, interface: Interface, bending: csc_array, coupling: ExtraDamping
) -> FullModel:
    """The full model on its known modes alone."""
    r, m, s = len(known.lam), interface.b.shape[1], interface.c.shape[0]
    D = known.D_rest + np.diag(damping.alpha + damping.beta * known.lam)
    B = np.where(known.lam > 0, bending.T @ known.Phi, interface.b.T @ known.Phi).T
    C, none = interface.c @ known.Phi, np.zeros((0, 0))
    return FullModel(
        interface.ports, known.lam, D, B, C, damping.alpha, damping.beta, damping.ratio,
        M=none, D_phi=known.Phi.T @ coupling(known.Phi), D_mix=np.zeros((0, r)), D_y=none,
        B_y=np.zeros((0, m)), C_y=np.zeros((s, 0)),
        W=known.Phi.T @ coupling.loads, W_y=np.zeros((0, len(coupling.dashpots))),
        direct=interface.direct, trial=none,
    )  # fmt: skip  # one line would hold one argument each


def enlarged(
    full: FullModel, Q: Floats, Phi: Floats, M: csr_array, coupling: ExtraDamping, c: csr_array, b: csc_array
) -> FullModel:
    """The full model in the coordinates of all of Q, whose first columns it has already."""
    P = Q[:, len(full.M) :]
    DP = coupling(P)
    return replace(
        full,
        M=_bordered(full.M, Q.T @ (M @ P)),
        D_mix=np.concatenate([full.D_mix, DP.T @ Phi]),
        D_y=_bordered(full.D_y, Q.T @ DP),
        B_y=np.concatenate([full.B_y, (b.T @ P).T]),
        C_y=np.column_stack([full.C_y, c @ P]),
        W_y=np.concatenate([full.W_y, P.T @ coupling.loads]),
        trial=np.concatenate([full.trial, np.zeros((P.shape[1], full.trial.shape[1]))]),
    )


def _bordered(A: Floats, columns: Floats) -> Floats:
    """The symmetric matrix that A (k, k) and its further columns (k + p, p) make."""
    k = len(A)
    corner = (columns[k:] + columns[k:].T) / 2
    return np.block([[A, columns[:k]], [columns[:k].T, corner]])
