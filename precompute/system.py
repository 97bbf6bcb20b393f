"""The full model M ü + D u̇ + K u = F [2.16]."""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array

from .arrays import Floats
from .errors import ModalFmuError
from .rounding import EPS


@dataclass(frozen=True)
class System:
    """M ü + D u̇ + K u = F [2.16] before supports.

    M, K: (n, n) sparse symmetric, kg and N/m, sorted indices; DOF 3·node + direction of a mesh.
    D: (n, n) N·s/m, symmetric ≥ 0, the damping that is neither α M + β K nor modal; none where there is none.
    rigid: (n, 6), the translations x, y, z and the rotations about x, y, z of the undeformed body
    about its centre of gravity (or any one point), in the same DOFs.
    precision: relative, of the entries of K; that of double precision unless a file prints fewer digits.
    """

    M: csr_array
    K: csr_array
    rigid: Floats
    D: csr_array | None = None
    precision: float = EPS

    def __post_init__(self) -> None:
        n = self.K.shape[0]
        square = all(A.shape == (n, n) for A in (self.K, self.M, self.D) if A is not None)
        if not square or self.rigid.shape != (n, 6):
            raise ModalFmuError(
                f"System: got K {self.K.shape}, M {self.M.shape}, rigid {self.rigid.shape}"
                f"{'' if self.D is None else f', D {self.D.shape}'}; "
                f"expected (n, n), (n, n), (n, 6) with one n"
            )


def rigid_motions(points: Floats) -> Floats:
    """u(p) = e_k and u(p) = e_k × (p − p̄): the six rigid motions as columns (3n, 6).

    points: (n, 3) in m, p̄ their mean. Translations are unit (m), rotations per rad.
    """
    n = len(points)
    x, y, z = (points - points.mean(axis=0)).T
    R = np.zeros((n, 3, 6))
    R[:, [0, 1, 2], [0, 1, 2]] = 1.0
    R[:, 1, 3], R[:, 2, 3] = -z, y
    R[:, 0, 4], R[:, 2, 4] = z, -x
    R[:, 0, 5], R[:, 1, 5] = -y, x
    return R.reshape(3 * n, 6)
