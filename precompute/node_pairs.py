"""Sparse symmetric matrices from blocks per pair of nodes: A = U + Uᵀ.

Only pairs i ≤ j of nodes that share a cell are summed; U holds their blocks, those on the diagonal halved.
A is then symmetric to the last bit, for half of the work.
"""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import bsr_array, csc_array, csr_array

from .arrays import Bools, Floats, Ints


def is_upper(nodes: Ints) -> Bools:
    """Which pairs (a, b) of local nodes have i ≤ j in the mesh: (c, k, k) from cells (c, k)."""
    upper: Bools = nodes[:, :, None] <= nodes[:, None, :]
    return upper


def pair_keys(nodes: Ints, n: int) -> Ints:
    """i·n + j of those pairs, cell by cell: (c·k(k+1)/2,)."""
    keys: Ints = (nodes[:, :, None] * n + nodes[:, None, :])[is_upper(nodes)]
    return keys


@dataclass(frozen=True)
class BlockSums:
    """The blocks of U, one for each distinct pair of nodes, to be filled by `add`.

    pairs: (p,) sorted keys i·n + j; n: number of nodes; blocks: (p, d²), d the directions per node.
    """

    pairs: Ints
    n: int
    blocks: Floats

    def add(self, slots: Ints, values: Floats) -> None:
        """blocks[slots_m] += values_m: slots (m,) may repeat; values (m, d²)."""
        distinct, place = np.unique(slots, return_inverse=True)
        m = len(slots)
        gather = csc_array((np.ones(m), place, np.arange(m + 1)), shape=(len(distinct), m))
        self.blocks[distinct] += gather @ values

    def symmetric(self) -> csr_array:
        """A = U + Uᵀ, (n·d, n·d) with sorted indices."""
        d = round(self.blocks.shape[1] ** 0.5)
        i, j = self.pairs // self.n, self.pairs % self.n
        halved = np.where(i == j, 0.5, 1.0)[:, None] * self.blocks
        rows = np.concatenate([[0], np.cumsum(np.bincount(i, minlength=self.n))])
        U = bsr_array(
            (halved.reshape(-1, d, d), j.astype(np.int32), rows.astype(np.int32)),
            shape=(self.n * d, self.n * d),
        )
        A = (U + U.T).tocsr()
        A.sort_indices()
        return A


def kron_identity(m: csr_array) -> csr_array:
    """m ⊗ I₃: the same matrix for each direction, (3n, 3n) with sorted indices."""
    n = m.shape[0]
    thrice = m[np.repeat(np.arange(n), 3)]
    direction = np.repeat(np.tile(np.arange(3, dtype=np.int32), n), np.diff(thrice.indptr))
    return csr_array((thrice.data, 3 * thrice.indices + direction, thrice.indptr), shape=(3 * n, 3 * n))
