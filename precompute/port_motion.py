"""The mean motion of a port: three displacements and three rotations, each one row over all DOFs."""

import numpy as np
from scipy.sparse import csr_array

from .arrays import Bools, Floats, Ints
from .dofs import DIRECTIONS, Dofs
from .errors import PartError
from .node_table import COORDINATES
from .ports import PortNodes

THIN = 1e-5  # width to length: nodes that are nearer to a line tell nothing about turning about it
ROUNDING = 1e-12  # of the part's distance from the origin, and of the largest coefficient of a row


def motion(port: PortNodes, direction: int, dofs: Dofs) -> csr_array:
    """The row m (1, n) whose product with the displacements u (n,) is the motion of the port.

    direction 0, 1, 2: Σ wᵢ uᵢ in x, y, z (m).
    direction 3, 4, 5: θ about x, y, z (rad) of the rigid motion that is nearest to the nodes' own,
        min Σ aᵢ |uᵢ − ū − θ × rᵢ|²  →  θ = J⁻¹ Σ aᵢ rᵢ × uᵢ,  J = Σ aᵢ (|rᵢ|² I − rᵢ rᵢᵀ),
    with a the port's shares and rᵢ = xᵢ − Σ aⱼ xⱼ. Where J does not tell it (one node, nodes on a line), the
    mean of the nodes' own rotations, if they have them. mᵀ are the nodal forces of a unit force or moment
    (power-conjugate); those of a moment have no resultant.
    Raises PartError: a rotation that the nodes do not tell, a node without the DOF.
    """
    if direction < 3:
        return _row(port, np.outer(port.weights, np.eye(3)[direction]), dofs)
    axis = direction - 3
    r = arms(port)
    inertia, axes = np.linalg.eigh(tensor(port.shares, r))
    told = inertia > smallest(inertia, port)
    if np.abs(axes[axis, ~told]).max(initial=0.0) > THIN:
        return _own_rotation(port, direction, dofs)
    g = axes[:, told] @ (axes[axis, told] / inertia[told])  # J⁻¹ e_axis
    return _row(port, port.shares[:, None] * np.cross(g, r), dofs)


def arms(port: PortNodes) -> Floats:
    """rᵢ = xᵢ − Σ aⱼ xⱼ in m, (k, 3). Raises PartError where coordinates are not known."""
    unknown = ~np.isfinite(port.points).all(axis=1)
    if unknown.any():
        raise PartError(
            f"port {port.name}: node {port.ids[np.argmax(unknown)]} has no coordinates, which rotations and "
            f"rigid ports need; {COORDINATES}"
        )
    r: Floats = port.points - port.shares @ port.points
    return r


def tensor(a: Floats, r: Floats) -> Floats:
    """J = Σ aᵢ (|rᵢ|² I − rᵢ rᵢᵀ), (3, 3), of arms r (k, 3)."""
    J: Floats = (a * (r**2).sum(axis=1)).sum() * np.eye(3) - (a[:, None] * r).T @ r
    return J


def smallest(inertia: Floats, port: PortNodes) -> float:
    """Below it a moment of inertia (3,) in m² is that of a line, or of a point with rounded coordinates."""
    rounded = ROUNDING * np.abs(port.points).max()
    return float(max(THIN**2 * inertia.max(), rounded**2))


def _own_rotation(port: PortNodes, direction: int, dofs: Dofs) -> csr_array:
    found = dofs.find(port.nodes, direction)
    if (found < 0).any():
        what = "one node does" if len(port.nodes) == 1 else "nodes at one place or on a line do"
        raise PartError(
            f"port {port.name}: got a rotation or moment about {'xyz'[direction - 3]}, which {what} not "
            "tell; select nodes around the axis, such as a face"
        )
    return _sparse(port.shares, found, len(dofs.node))


def _row(port: PortNodes, coefficients: Floats, dofs: Dofs) -> csr_array:
    """Σ_ij coefficients_ij u_ij over nodes i and directions j: coefficients (k, 3)."""
    used: Bools = np.abs(coefficients) > ROUNDING * np.abs(coefficients).max()
    found = np.stack([dofs.find(port.nodes, j) for j in range(3)], axis=1)
    missing = np.argwhere(used & (found < 0))
    if len(missing):
        i, j = missing[0]
        raise PartError(
            f"port {port.name}: node {port.ids[i]} has no DOF in {DIRECTIONS[j]}, expected one at each node "
            "of the port; select others, or export the matrices with it"
        )
    return _sparse(coefficients[used], found[used], len(dofs.node))


def _sparse(values: Floats, found: Ints, n: int) -> csr_array:
    # 32-bit indices as those of K, which the solvers take
    return csr_array((values, found.astype(np.int32), np.array([0, len(found)], np.int32)), shape=(1, n))
