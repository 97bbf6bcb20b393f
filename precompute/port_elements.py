"""Springs, masses and dashpots at ports."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from scipy.sparse import csr_array, vstack

from .dofs import DIRECTIONS, Dofs
from .notice import warning
from .port_motion import motion
from .ports import PortNodes
from .system import System

MANY = 3000  # nodes: k² entries in K, a hundred megabytes


def element_motion(
    ports: Mapping[str, PortNodes], port: str, direction: str, to: str | None, dofs: Dofs
) -> csr_array:
    """w (1, n): w u is the motion of `port` in x, y, z, rx, ry or rz, less that of `to`.

    A spring has the strain energy ½ k (w u)², a dashpot takes the power c (w u̇)²; without `to` the other
    end is the ground. Raises PartError as `motion` does.
    """
    k = DIRECTIONS.index(direction)
    own = motion(ports[port], k, dofs)
    return own if to is None else csr_array(own - motion(ports[to], k, dofs))


def with_springs(system: System, springs: Sequence[tuple[csr_array, float]]) -> System:
    """K + Σ k wᵀw, springs (w (1, n), k in N/m or N.m/rad)."""
    return replace(system, K=_with_squares(system.K, springs))


def with_masses(system: System, masses: Sequence[tuple[PortNodes, float]], dofs: Dofs) -> System:
    """M + Σ m wᵀw over the three directions: a mass (kg) that moves with the mean displacement of its port.

    Directions that no node of the port has a DOF in do not move, and are left out. Raises PartError: some
    nodes have it and some not.
    """
    rows = [
        (motion(port, k, dofs), m)
        for port, m in masses
        for k in range(3)
        if (dofs.find(port.nodes, k) >= 0).any()
    ]
    return replace(system, M=_with_squares(system.M, rows))


def _with_squares(A: csr_array, rows: Sequence[tuple[csr_array, float]]) -> csr_array:
    """A + Σ s wᵀw, exactly symmetric: √s w times itself."""
    if not rows:
        return A
    most = max(w.nnz for w, _ in rows)
    if most > MANY:
        warning(
            f"a spring or mass at a port couples its {most} DOFs with each other, which costs memory and "
            "time; a port with fewer nodes is quicker"
        )
    W = csr_array(vstack([np.sqrt(s) * w for w, s in rows]))
    total = csr_array(A + W.T @ W)
    total.sort_indices()
    return total
