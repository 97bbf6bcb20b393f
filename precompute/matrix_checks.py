"""Whether imported K, M and D can be those of one part: what is impossible is an error."""

from collections.abc import Callable

import numpy as np
from scipy.sparse import csr_array

from .arrays import Bools, Floats
from .dofs import Dofs
from .errors import MatrixError
from .factor import factoriser
from .notice import notice, warning
from .pencil import Pencil
from .rounding import ZERO, eigenvalue_noise, energies
from .sturm import count_below
from .system import System

AXES = "xyz"
EQUAL = 1e-6  # of the mass: consistent and lumped matrices of one mesh agree far better in all directions
COHERENT = 1e-6  # tᵀMt of |t|ᵀ|M||t|: 0.2 and more for any mass matrix, rounding for the K of a free body
INDEFINITE = 1e-6  # beyond A_ij² = A_ii A_jj, which rods and point masses reach
FEW_DIGITS = 1e-7  # of |t|ᵀ|K||t|: less than this is rather lost digits than a spring to ground

Where = Callable[[int], str]


def check_semidefinite(name: str, A: csr_array, where: Where) -> None:
    """A_ii ≥ 0 and A_ij² ≤ A_ii A_jj, as any A ≥ 0 has.

    Raises MatrixError: another sign, entries off the diagonal that are too large.
    """
    diagonal = A.diagonal()
    if np.any(diagonal < 0):
        d = int(np.argmin(diagonal))
        raise MatrixError(f"{name}: got {diagonal[d]:g} on the diagonal at {where(d)}, expected none below 0")
    row = np.repeat(np.arange(A.shape[0]), np.diff(A.indptr))
    excess = A.data**2 - (1 + INDEFINITE) * diagonal[row] * diagonal[A.indices]
    k = int(np.argmax(excess))
    if excess[k] > 0:
        raise MatrixError(
            f"{name}: got {A.data[k]:g} between {where(int(row[k]))} and {where(int(A.indices[k]))}, whose "
            f"diagonals are {diagonal[row[k]]:g} and {diagonal[A.indices[k]]:g}; expected A_ij² ≤ A_ii A_jj; "
            "are entries counted twice, or the order of rows lost?"
        )


def check_masses(system: System, dofs: Dofs) -> None:
    """TᵀMT = m I for the translations T (n, 3): the same mass in each direction, none between two.

    Directions whose nodes differ (DOFs that were eliminated) are not compared.
    Raises MatrixError: no mass in a direction, K and M exchanged, masses that differ.
    """
    T = system.rigid[:, :3]
    mass = T.T @ (system.M @ T)
    size = T.T @ (abs(system.M) @ T)
    present = [k for k in range(3) if T[:, k].any()]
    for k in present:
        if not mass[k, k] > COHERENT * size[k, k] or _exchanged(system, T[:, k]):
            raise MatrixError(
                f"mass: got {mass[k, k]:.4g} kg in {AXES[k]}, expected a mass matrix; are stiffness and mass "
                "exchanged?"
            )
    masses = ", ".join(f"{AXES[k]} {mass[k, k]:.6g}" for k in present)
    nodes = [np.sort(dofs.node[dofs.direction == k]) for k in present]
    if not all(np.array_equal(nodes[0], other) for other in nodes):
        notice(f"mass by the degrees of freedom that are there: {masses} kg")
        return
    m = np.max(np.diag(mass))
    if np.max(np.abs(mass - m * np.diag(T.any(axis=0)))) > EQUAL * m:
        mixed = max((abs(mass[a, b]), AXES[a] + AXES[b]) for a in range(3) for b in range(a + 1, 3))
        raise MatrixError(
            f"mass: got {masses} kg and {mixed[0]:.4g} kg between {mixed[1][0]} and {mixed[1][1]}, expected "
            "one mass and none between directions; is each row's direction right, and a global one?"
        )


def _exchanged(system: System, t: Floats) -> bool:
    """K adds up along t as a mass does, M cancels as a stiffness does, and all is slower than 1 rad/s."""
    K, M = system.K, system.M
    adds_up = [float(t @ (A @ t)) / max(float(t @ (abs(A) @ t)), np.finfo(float).tiny) for A in (K, M)]
    heavy = M.diagonal() > 0
    fastest = float(np.max(K.diagonal()[heavy] / M.diagonal()[heavy], initial=0.0))
    return adds_up[0] > adds_up[1] and fastest < 1.0


def tell_rigid_content(system: System) -> None:
    """Say in a notice which rigid motions cost strain energy.

    Any answer is legal: supports may have been eliminated, or be springs. It is doubted where rotations cost
    energy while translations do not, and where energies are so small that digits must have been lost.
    """
    energy, rounding = energies(system.K, system.rigid, system.precision)
    known = system.rigid.any(axis=0)
    held = known & (energy > ZERO * rounding)
    names = np.array(["x", "y", "z", "rx", "ry", "rz"])
    share = energy[held] * system.precision / rounding[held]
    if not held.any():
        notice("K is of a free body: no rigid motion costs energy")
    elif np.any(share < FEW_DIGITS):
        warning(
            f"K: rigid motions {' '.join(names[held])} cost little energy ({share.min():.0e} of its entries) "
            f"but not none to its {system.precision:.0e}; export it with more digits"
        )
    elif not held[:3].any():
        warning(
            f"K: translations cost no energy, rotations {' '.join(names[held])} do; do the coordinates "
            "belong to these matrices (unit of length, order of rows)?"
        )
    else:
        notice(f"K holds {' '.join(names[held])}: supports or springs to ground are already in it")


def check_definite(system: System, free: Bools) -> None:
    """K ≥ 0 by the negative pivots of K − σM, σ below the rounding of zero; free: (n,) the DOFs not held.

    Raises MatrixError: motions of negative strain energy.
    """
    K, M = system.K[free][:, free], system.M[free][:, free]
    noise = eigenvalue_noise(K, M, system.rigid[free, :3], system.precision)
    pencil = Pencil(K, M, np.zeros((K.shape[0], 0)), noise)
    with factoriser() as factorise:
        negative = count_below(pencil, factorise, pencil.sigma)
    if negative:
        raise MatrixError(
            f"stiffness: got {negative} motions of negative strain energy, expected none; export K with all "
            "its digits, without a load beyond buckling, contact or Lagrange multipliers"
        )
