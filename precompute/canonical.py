"""One choice among equal eigenvectors: signs, and directions inside clusters of equal eigenvalues."""

import numpy as np

from .arrays import Floats
from .pencil import Pairs

EQUAL = 1e-8  # relative: eigenvalues nearer than this share a cluster
TIE = 1e-6  # relative: components nearer than this are as large; the first of them is the pivot


def clusters(lam: Floats) -> list[slice]:
    """Runs of eigenvalues each within 1e-8 of the one before; lam (r,) ascending."""
    starts = np.flatnonzero(np.diff(lam, prepend=-np.inf) > EQUAL * np.abs(lam))
    return [slice(int(a), int(b)) for a, b in zip(starts, [*starts[1:], len(lam)], strict=True)]


def canonical_vectors(Phi: Floats) -> Floats:
    """Φ Q with Q orthogonal: the same for any orthonormal basis of one eigenspace, Phi (n, m).

    The DOF that moves most (largest norm of its row, a number that no rotation changes) is the first pivot:
    the first vector moves it, positively, the others do not. The same again for the others. For m = 1 the
    largest component is positive.
    """
    Phi = Phi.copy()
    for first in range(Phi.shape[1]):
        rest = Phi[:, first:]
        moves = np.linalg.norm(rest, axis=1)
        pivot = int(np.argmax(moves >= (1 - TIE) * moves.max()))
        # Householder: Q e₁ ∥ the pivot's row
        row = rest[pivot] / moves[pivot]
        v = row.copy()
        v[0] += 1.0 if row[0] >= 0 else -1.0
        rest -= np.outer(rest @ v, 2 * v / (v @ v))
        rest[:, 0] *= np.sign(rest[pivot, 0])
    return Phi


def canonical(pairs: Pairs) -> Pairs:
    """The same eigenspaces, each with its canonical vectors; those of λ within 1e-8 are mixed."""
    Phi = np.column_stack([canonical_vectors(pairs.Phi[:, cluster]) for cluster in clusters(pairs.lam)])
    return Pairs(pairs.lam, Phi, pairs.solver)
