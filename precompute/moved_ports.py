"""Ports whose motion is prescribed: u = T û + P s with W u = s, whatever û is."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.linalg import qr
from scipy.sparse import csr_array, identity

from .arrays import Floats, Ints
from .constrained import Constrained
from .errors import PartError
from .notice import warning
from .port_elements import MANY
from .projection import rows_over, symmetric

NEW = 1e-6  # of a motion must be its own, beside those before it and what supports hold; less is rounding


def hold_motions(free: Constrained, W: csr_array, names: Sequence[tuple[str, str]]) -> Constrained:
    """The part with the motions W u of its ports held, and P, which moves them: W T = 0, W P = I.

    W: (k, n) over the DOFs of the full model; names: port and input of each row. As many û as there are
    motions follow from the others: the pivots p of Ŵ = [Ŵ_p Ŵ_o], û_p = Ŵ_p⁻¹ (s − Ŵ_o û_o). Nodes of a port
    that averages are coupled to each other by that; a rigid port only loses coordinates.
    Source: Cook, Malkus, Plesha & Witt, Concepts and Applications of Finite Element Analysis, 4th ed., 13.2
    (transformation equations).
    Raises PartError: a motion that supports hold, or that others give already.
    """
    if W.shape[0] == 0:
        return free
    k, n = W.shape[0], free.T.shape[1]
    W_hat = rows_over(W, free.T)
    scale = np.sqrt(np.asarray(W_hat.multiply(W_hat).sum(axis=1)).ravel())
    moving = np.setdiff1d(W_hat.indices, free.fixed)
    A = W_hat[:, moving].toarray() / scale[:, None]
    _check_own(A, names)
    order = qr(A, mode="r", pivoting=True)[1]
    pivot, rest = np.sort(order[:k]), np.sort(order[k:])
    follow = np.linalg.solve(A[:, pivot], np.column_stack([-A[:, rest], np.diag(1 / scale)]))
    own = np.setdiff1d(np.arange(n), moving[pivot])
    others = _placed(follow[:, : len(rest)], moving[pivot], moving[rest], (n, n))
    T = csr_array((identity(n, format="csr") + others)[:, own])
    P = _placed(follow[:, len(rest) :], moving[pivot], np.arange(k), (n, k))
    _doubt_many(others)
    system = free.system
    return Constrained(
        replace(
            system,
            M=symmetric(T.T @ system.M @ T),
            K=symmetric(T.T @ system.K @ T),
            D=None if system.D is None else symmetric(T.T @ system.D @ T),
            rigid=_held(system.rigid, A, moving)[own],
        ),
        np.searchsorted(own, free.fixed),
        csr_array(free.T @ T),
        csr_array(free.L[own]),
        free.origin[own],
        W,
        csr_array(free.T @ P),
    )


def _check_own(A: Floats, names: Sequence[tuple[str, str]]) -> None:
    """Each row of A has a part of its own; A (k, m) at the DOFs that move, whole rows of length 1."""
    Q = np.zeros((A.shape[1], 0))
    for row, (port, key) in zip(A, names, strict=True):
        if np.linalg.norm(row) <= NEW:
            raise PartError(
                f"port {port}: got the input {key}, but supports hold the port so; remove it, or hold less"
            )
        for _ in range(2):
            row = row - Q @ (Q.T @ row)
        if np.linalg.norm(row) <= NEW:
            before = ", ".join(f"{other}.{its}" for other, its in names[: Q.shape[1]])
            raise PartError(
                f"port {port}: got the input {key}, which follows from {before} already, expected motions "
                "that are independent; remove it, or let the ports overlap less"
            )
        Q = np.column_stack([Q, row / np.linalg.norm(row)])


def _doubt_many(others: csr_array) -> None:
    most = 1 + int(np.max(np.diff(others.indptr), initial=0))
    if most > MANY:
        warning(
            f"a prescribed motion couples the {most} DOFs of its port with each other, which costs memory "
            'and time; a port with fewer nodes, or of kind = "rigid", is quicker'
        )


def _held(rigid: Floats, A: Floats, moving: Ints) -> Floats:
    """(I − A⁺A) R: rigid motions that leave the ports at rest as they are, of the others what does so."""
    held = rigid.copy()
    held[moving] -= np.linalg.pinv(A) @ (A @ rigid[moving])
    return held


def _placed(block: Floats, rows: Ints, columns: Ints, shape: tuple[int, int]) -> csr_array:
    """32-bit indices as those of K, which the solvers take."""
    i, j = np.nonzero(block)
    at = (rows[i].astype(np.int32), columns[j].astype(np.int32))
    return csr_array((block[i, j], at), shape=shape)
