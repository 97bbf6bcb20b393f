"""Sparse symmetric factors A = L D Lᵀ, by PARDISO or by SuperLU in its symmetric mode."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, Literal, Protocol, TypeAlias

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.linalg import splu
from threadpoolctl import ThreadpoolController

from .arrays import Floats
from .errors import EigenError
from .pardiso import Pardiso, library

Solver: TypeAlias = Literal["auto", "superlu", "pardiso"]

COPY_BYTES = 8e9  # SuperLU shows its pivots only by copying L and U; beyond this they stay unknown
BACKWARD_ERROR = 1e-8  # without pivoting the signs of D are those of a matrix this near, or are not trusted


class Factor(Protocol):
    """A = L D Lᵀ."""

    @property
    def name(self) -> str:
        """What computed it, in human words."""

    def solve(self, b: Floats) -> Floats:
        """x = A⁻¹ b for b (n,) or (n, m)."""

    def negative_pivots(self) -> int | None:
        """How many eigenvalues of A are negative (Sylvester's law of inertia); none if not known."""


@dataclass(frozen=True)
class SuperLU:
    """P A Pᵀ = L U with U = D Lᵀ: SuperLU held to diagonal pivots."""

    A: csr_array
    lu: Any
    name: str = "SuperLU"

    def solve(self, b: Floats) -> Floats:
        """x = A⁻¹ b for b (n,) or (n, m)."""
        x: Floats = self.lu.solve(b)
        return x

    def negative_pivots(self) -> int | None:
        """The negative entries of D = diag(U); none where a pivot left the diagonal or accuracy was lost."""
        if not np.array_equal(self.lu.perm_r, self.lu.perm_c) or 12 * self.lu.nnz > COPY_BYTES:
            return None
        x = np.ones(self.A.shape[0])
        b = self.A @ x
        y = self.lu.solve(b)
        if np.max(np.abs(self.A @ y - b)) > BACKWARD_ERROR * np.max(abs(self.A) @ np.abs(y) + np.abs(b)):
            return None
        return int(np.sum(self.lu.U.diagonal() < 0))


def _superlu(A: csr_array) -> SuperLU:
    try:
        lu = splu(
            A.tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
        )
    except RuntimeError as error:  # an exact zero pivot
        raise EigenError(f"SuperLU: {error}; expected a regular matrix") from error
    except MemoryError as error:
        raise EigenError(
            f"SuperLU: the factor of {A.shape[0]} DOFs does not fit into memory; "
            f"pip install modalfmu[fast] brings PARDISO, which needs less"
        ) from error
    return SuperLU(A, lu)


def choose(solver: Solver) -> Literal["superlu", "pardiso"]:
    """The solver that runs: "auto" is PARDISO where it is installed.

    Raises EigenError: "pardiso" is asked for and missing; a name that is none of the three.
    """
    if solver == "superlu":
        return solver
    if solver not in ("auto", "pardiso"):
        raise EigenError(f'solver: got "{solver}"; expected "auto", "superlu" or "pardiso"')
    try:
        library()
    except ImportError as error:
        if solver == "pardiso":
            raise EigenError(
                f'solver: got "pardiso", which is not installed ({error}); '
                f'pip install "modalfmu[fast]" brings it (x86-64 Linux and Windows)'
            ) from error
        return "superlu"
    return "pardiso"


@contextmanager
def factoriser(solver: Solver = "auto") -> Iterator[Callable[[csr_array], Factor]]:
    """A ↦ A = L D Lᵀ for symmetric sparse A (n, n).

        with factoriser() as factorise:
            x = factorise(K).solve(b)

    A factor lives until the next one or the end of the block; matrices of one sparsity pattern, such as
    K − σM for several σ, share one fill-reducing ordering (PARDISO).
    Raises EigenError: A is singular, memory is short, the solver asked for is not installed.
    """
    kind = choose(solver)
    # the threads of OpenBLAS would fight those of MKL for the cores, and cost more than they give here
    with ThreadpoolController().select(internal_api="openblas").limit(limits=1):
        if kind == "superlu":
            yield _superlu
            return
        pardiso = Pardiso()
        try:
            yield pardiso.factorise
        finally:
            pardiso.release()
