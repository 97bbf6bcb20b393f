"""A small bar with three kinds of supports, loads on two faces, and what dense algebra says of it."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from boxes import box
from scipy.linalg import eigh, null_space
from scipy.sparse import csc_array, csr_array
from systems import dofs_where, system_of

from fmu_src.runtime.model import Port
from precompute.arrays import Bools, Floats, Ints
from precompute.interface import Interface
from precompute.system import System

SIZE = (1.0, 0.2, 0.3)  # m, three different edges: no two frequencies are equal
MESH = box("hex20", (4, 1, 1), SIZE)
BAR = system_of(MESH)
P = MESH.points
N = len(BAR.rigid)
SUPPORTS = {
    "free": np.zeros(0, dtype=np.int64),
    "hinge": dofs_where(MESH, (P[:, 0] == 0) & (P[:, 2] == 0)),
    "clamped": dofs_where(MESH, P[:, 0] == 0),
}


def mean(nodes: Bools, direction: int, n: int = N) -> Floats:
    """w with wᵀu = the mean motion of the nodes in one direction: (n,)."""
    w = np.zeros(n)
    w[3 * np.flatnonzero(nodes) + direction] = 1 / np.sum(nodes)
    return w


TIP, MIDDLE = P[:, 0] == SIZE[0], P[:, 0] == SIZE[0] / 2
LOADS = np.column_stack([mean(TIP, 0), mean(TIP, 1), mean(TIP, 2), mean(MIDDLE, 2)])


def interface() -> Interface:
    """Forces at tip and middle; displacement and acceleration of the tip, velocity of the middle."""
    ports = (
        Port("tip", ("force.x", "force.y", "force.z"), ("displacement.z", "acceleration.z")),
        Port("middle", ("force.z",), ("velocity.z",)),
    )
    c = LOADS[:, [2, 2, 3]].T
    return Interface(ports, csc_array(LOADS), csr_array(c), np.zeros((3, 4)))


@dataclass(frozen=True)
class Dense:
    """K, M between the free DOFs, by LAPACK alone."""

    K: Floats
    M: Floats
    free: Ints

    @cached_property
    def R(self) -> Floats:
        """K R = 0, RᵀMR = I."""
        null = null_space(self.K, rcond=1e-12)
        if null.shape[1] == 0:
            return np.asarray(null)
        mu, X = np.linalg.eigh(null.T @ self.M @ null)
        return np.asarray(null @ (X / np.sqrt(mu)))

    def modes(self, W: Floats | None = None) -> tuple[Floats, Floats]:
        """(λ, Φ) of the motions with Wᵀφ = 0."""
        T = np.eye(len(self.K)) if W is None else null_space(W[self.free].T)
        lam, X = eigh(T.T @ self.K @ T, T.T @ self.M @ T)
        return lam, T @ X

    def static(self, b: Floats) -> Floats:
        """P K† Pᵀ b with P = I − R RᵀM and K† the Moore–Penrose inverse, over all DOFs."""
        project = np.eye(len(self.K)) - self.R @ self.R.T @ self.M
        x = np.zeros(b.shape)
        pinv = np.linalg.pinv(self.K, rcond=1e-12, hermitian=True)
        x[self.free] = project @ pinv @ project.T @ b[self.free]
        return x


def dense(system: System, fixed: Ints) -> Dense:
    """The system by dense algebra."""
    free = np.setdiff1d(np.arange(system.K.shape[0]), fixed)
    K, M = (A.toarray()[np.ix_(free, free)] for A in (system.K, system.M))
    return Dense(K, M, free)


def modal_flexibility(lam: Floats, Phi: Floats, rigid: int, b: Floats) -> Floats:
    """bᵀ Φ Λ⁻¹ Φᵀ b over the elastic modes."""
    B = Phi[:, rigid:].T @ b
    return np.asarray(B.T @ (B / lam[rigid:, None]))


def relative(got: Floats, expected: Floats) -> float:
    """The largest error of a symmetric flexibility, by the geometric mean of the two diagonal entries."""
    size = np.sqrt(np.diag(expected))
    return float(np.max(np.abs(got - expected) / np.outer(size, size)))
