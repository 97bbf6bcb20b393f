"""Vectors that are orthonormal in strain energy, each with the load that holds it: QᵀKQ = I, F = KQ."""

from dataclasses import dataclass

import numpy as np

from .arrays import Floats
from .statics import BALANCED, StaticSolver

DEPENDENT = 1e-7  # of a vector's energy norm: what is left of it after projection is rounding


@dataclass(frozen=True, eq=False)  # arrays have no one truth value
class Deflation:
    """P = I − MΦΦᵀ and the static response P'K⁺P of the body with the motions Φ taken out.

    Phi: (n, r) exact modes, M-orthonormal, all rigid ones among them; MPhi = MΦ.
    """

    solve: StaticSolver
    Phi: Floats
    MPhi: Floats

    def static(self, b: Floats) -> tuple[Floats, Floats]:
        """X = P'K⁺Pb and F = KX = Pb for loads b (n, p): (n, ≤ p) each.

        Loads that the modes Φ take up whole, such as gravity on a free body, are left out.
        """
        F = b - self.MPhi @ (self.Phi.T @ b)
        F[self.solve.held] = 0.0
        left = np.linalg.norm(F, axis=0) > BALANCED * np.linalg.norm(b, axis=0)
        F = F[:, left]
        X = self.solve(F)
        return X - self.Phi @ (self.MPhi.T @ X), F


@dataclass(frozen=True, eq=False)
class EnergyBasis:
    """Q (n, q) in m/√J with QᵀKQ = I and F = KQ (n, q).

    F is kept since it is known from the loads; K times Q would lose the energy of soft parts to rounding.
    """

    Q: Floats
    F: Floats

    @classmethod
    def empty(cls, n: int) -> "EnergyBasis":
        """No vector yet, of n DOFs."""
        return cls(np.zeros((n, 0)), np.zeros((n, 0)))

    def extended(self, loads: Floats, deflation: Deflation) -> "EnergyBasis":
        """With what is new in the static response to loads (n, p): Gram–Schmidt by blocks, twice.

        X is solved for anew in between: what projection leaves of X and of F has lost digits, each its own,
        and would no longer be F = KX, the more so from block to block.
        """
        F = loads
        for _ in range(2):
            X, F = deflation.static(F)
            size = np.sqrt(np.maximum(np.sum(X * F, axis=0), 0.0))
            X, F = X[:, size > 0] / size[size > 0], F[:, size > 0] / size[size > 0]
            overlap = self.F.T @ X
            X, F = X - self.Q @ overlap, F - self.F @ overlap
            G = X.T @ F  # eigenvectors of XᵀKX within
            energy, U = np.linalg.eigh((G + G.T) / 2)
            new = energy > DEPENDENT**2
            U = U[:, new] / np.sqrt(energy[new])
            X, F = X @ U, F @ U
        return EnergyBasis(np.column_stack([self.Q, X]), np.column_stack([self.F, F]))
