"""Damping beyond Rayleigh's and the modal forms, as it acts on vectors."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from scipy.sparse import csr_array

from .arrays import Floats

Dashpots: TypeAlias = Sequence[tuple[csr_array, float]]  # w (1, n) and c: the force c wᵀ(w u̇)


@dataclass(frozen=True, eq=False)  # arrays have no one truth value
class ExtraDamping:
    """D V of the damping that is neither Rayleigh's nor modal: a matrix (n, n), and dashpots c wᵀw."""

    n: int
    D: csr_array | None
    dashpots: Dashpots

    def __call__(self, V: Floats) -> Floats:
        DV = np.zeros_like(V) if self.D is None else self.D @ V
        for w, c in self.dashpots:
            DV += w.T @ (c * (w @ V))
        return np.asarray(DV)

    @property
    def loads(self) -> Floats:
        """wᵀ of each dashpot, (n, d): the nodal forces of its unit force."""
        none = np.zeros((self.n, 0))
        return np.column_stack([none, *(w.T.toarray() for w, _ in self.dashpots)])

    def new(self, V: Floats) -> Floats:
        """The columns of D V that may lead out of span(V) and the dashpots' own columns."""
        return V[:, :0] if self.D is None else np.asarray(self.D @ V)
