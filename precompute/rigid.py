"""The rigid motions of the body that its supports leave."""

import numpy as np
from scipy.sparse import csr_array

from .arrays import Floats, Ints
from .orthonormal import extended
from .rounding import without_energy
from .system import System

HELD = 1e-6  # of the body's size: motions smaller than this at the supports are roundings of the mesh file
PIVOT = 1e-3  # of a unit vector: nothing smaller is divided by


def rigid_modes(system: System, fixed: Ints) -> Floats:
    """φ with K φ = 0, φ = 0 at the fixed DOFs, ΦᵀMΦ = I: the combinations of system.rigid that are left.

    fixed: DOFs. Gives Phi (n, k), 0 ≤ k ≤ 6. Translations come first where they are free, so that a
    free body has x, y, z, then rotations about its centre of gravity.
    Springs to ground inside K hold the body as supports do; fixed DOFs that no free one is coupled to do not.
    """
    size = np.max(np.abs(system.rigid), axis=0)
    R = system.rigid[:, size > 0] / size[size > 0]
    Phi = R @ _preferring_first(vanishing_at(R[holding(system.K, fixed)]))
    Phi[fixed] = 0.0
    none = Phi[:, :0]
    Phi = extended(none, Phi, system.M, HELD)
    _, X = np.linalg.eigh(Phi.T @ (system.K @ Phi))
    left = without_energy(system.K, Phi @ X, system.precision)
    if left.all():
        return Phi
    return extended(none, Phi @ _preferring_first(X[:, left]), system.M, HELD)


def holding(K: csr_array, fixed: Ints) -> Ints:
    """Those fixed DOFs that a free one is coupled to."""
    free = np.ones(K.shape[0])
    free[fixed] = 0.0
    return np.asarray(fixed[(abs(K) @ free)[fixed] > 0])


def vanishing_at(S: Floats) -> Floats:
    """An orthonormal basis (c, k) of the combinations x with S x = 0, S (s, c) of entries up to 1."""
    c = S.shape[1]
    if len(S) == 0 or c == 0:
        return np.eye(c)
    _, _, V = np.linalg.svd(np.linalg.qr(S, mode="r"), full_matrices=True)
    left = np.max(np.abs(S @ V.T), axis=0) <= HELD
    return np.asarray(V[left].T)


def _preferring_first(N: Floats) -> Floats:
    """The reduced echelon basis of span(N), N (c, k) orthonormal: the same whatever basis was given."""
    rows = N.T.copy()
    done = 0
    for column in range(rows.shape[1]):
        if done == len(rows):
            break
        pivot = done + int(np.argmax(np.abs(rows[done:, column])))
        if abs(rows[pivot, column]) <= PIVOT:
            continue
        rows[[done, pivot]] = rows[[pivot, done]]
        rows[done] /= rows[done, column]
        others = np.arange(len(rows)) != done
        rows[others] -= np.outer(rows[others, column], rows[done])
        done += 1
    return np.asarray(rows[:done].T)
