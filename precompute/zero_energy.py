"""Motions without strain energy beyond the rigid ones of the whole body: an error with number and place."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components

from .arrays import Bools, Ints
from .canonical import canonical_vectors
from .errors import EigenError, ZeroEnergyError
from .pencil import NEGATIVE, Pairs, Pencil
from .rigid import rigid_modes
from .rounding import EPS, ZERO, energies
from .system import System

SHOWN = 3  # places in a message

Where = Callable[[int], str]  # DOF → "node 17 at (1, 0, 0.5)"


def refuse_dofs_without_stiffness(K: csr_array, free: Bools, where: Where) -> None:
    """Raise ZeroEnergyError where K_ii = 0 at a free DOF: a node in no element."""
    empty = np.flatnonzero((K.diagonal() == 0) & free)
    if len(empty):
        raise ZeroEnergyError(
            f"{_modes(len(empty))}: {len(empty)} free DOFs without stiffness, {_places(empty, where)}; "
            f"remove the nodes that are in no element, or fix them"
        )


def refuse_loose_pieces(system: System, fixed: Bools, rigid: int, where: Where) -> None:
    """Raise ZeroEnergyError where the part falls into pieces that can move against each other.

    fixed: (n,); rigid: how many rigid modes the whole body has. Pieces are those of the graph of K, supports
    left in; each may have the rigid modes that its own supports leave. All of them together must be `rigid`.
    """
    number, piece = connected_components(system.K, directed=False)
    if number == 1:
        return
    order = np.argsort(piece, kind="stable")
    dofs = [d for d in np.split(order, np.cumsum(np.bincount(piece))[:-1]) if not fixed[d].all()]
    left = [rigid_modes(_piece(system, d), np.flatnonzero(fixed[d])).shape[1] for d in dofs]
    if sum(left) > rigid:
        loose = sorted((d for d, k in zip(dofs, left, strict=True) if k), key=len)
        shown = "; ".join(f"{len(d)} DOFs around {where(int(d[0]))}" for d in loose[:SHOWN])
        more = "; …" if len(loose) > SHOWN else ""
        raise ZeroEnergyError(
            f"{_modes(sum(left) - rigid)} beyond the {rigid} rigid ones: the part falls into {number} "
            f"pieces, {len(loose)} of them loose ({shown}{more}); let them share nodes, or support each"
        )


def refuse_mechanisms(pencil: Pencil, elastic: Pairs, free: Ints, where: Where) -> None:
    """Raise ZeroEnergyError where φᵀKφ of elastic modes is rounding only, EigenError where it is negative.

    free: (n,) the DOF of each row of the pencil. A place is where such a motion is largest.
    """
    energy, rounding = energies(pencil.K, elastic.Phi, pencil.precision)
    if np.any(energy < -ZERO * rounding):
        raise EigenError(NEGATIVE)
    zero = energy <= ZERO * rounding
    if zero.any():
        Phi = canonical_vectors(elastic.Phi[:, zero])
        raise ZeroEnergyError(
            f"{_modes(Phi.shape[1])} beyond the {pencil.rigid.shape[1]} rigid ones, "
            f"{_places(free[np.argmax(np.abs(Phi), axis=0)], where)}: a hinge, or a piece held by too few "
            f"nodes; connect it over faces or support it{_few_digits(pencil)}"
        )


def _few_digits(pencil: Pencil) -> str:
    return "; or K was written with too few digits: export it with more" if pencil.precision > EPS else ""


def _piece(system: System, dofs: Ints) -> System:
    return replace(
        system, M=system.M[dofs][:, dofs], K=system.K[dofs][:, dofs], D=None, rigid=system.rigid[dofs]
    )


def _modes(number: int) -> str:
    return "1 zero-energy mode" if number == 1 else f"{number} zero-energy modes"


def _places(dofs: Ints, where: Where) -> str:
    """near …, … and 5 more."""
    names = list(dict.fromkeys(where(int(dof)) for dof in dofs))
    more = f" and {len(names) - SHOWN} more" if len(names) > SHOWN else ""
    return "near " + ", ".join(names[:SHOWN]) + more
