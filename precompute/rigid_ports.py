"""Ports whose nodes move as one rigid body: u = T û."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from scipy.sparse import csr_array, hstack

from .arrays import Floats, Ints
from .constrained import Constrained, unconstrained
from .dofs import DIRECTIONS, Dofs
from .errors import PartError
from .port_motion import arms, smallest, tensor
from .ports import PortNodes
from .projection import inverse, projected
from .system import System


def constrain(system: System, fixed: Ints, dofs: Dofs, rigid_ports: Sequence[PortNodes]) -> Constrained:
    """The full model with the nodes of each rigid port moving as uᵢ = u_c + θ × (xᵢ − x_c), φᵢ = θ.

    x_c: the mean of the nodes; φᵢ: their rotations, where they have them. A port on a line, or of one node,
    has the motions that its DOFs can show and no others. Every column of a port moves its nodes by 1 m in
    the mean square (one node with rotations only: by 1 rad), so that K and M stay well scaled.
    Raises PartError: a node in two rigid ports, a held node, a node without a DOF or coordinates, a port of
    all nodes.
    """
    n = len(dofs.node)
    if not rigid_ports:
        return unconstrained(system, fixed, np.arange(n))
    _refuse_shared_nodes(rigid_ports)
    places = [_port_dofs(port, fixed, dofs) for port in rigid_ports]
    own = np.setdiff1d(np.arange(n), np.concatenate(places))
    kept = _sparse(np.ones(len(own)), own, np.arange(len(own)), (n, len(own)))
    moving = [_rigid_columns(port, place, dofs) for port, place in zip(rigid_ports, places, strict=True)]
    T = csr_array(hstack([kept, *moving], format="csr"))
    first = [np.full(columns.shape[1], place[0]) for columns, place in zip(moving, places, strict=True)]
    ends = np.cumsum([len(own), *(columns.shape[1] for columns in moving)])
    bodies = [np.arange(a, b) for a, b in pairwise(ends)]
    return Constrained(
        projected(system, T, bodies),
        np.searchsorted(own, np.unique(fixed)),
        T,
        inverse(T),
        np.concatenate([own, *first]),
        csr_array((0, n)),
        csr_array((n, 0)),
    )


def _refuse_shared_nodes(ports: Sequence[PortNodes]) -> None:
    for i, port in enumerate(ports):
        for other in ports[:i]:
            shared = np.isin(port.nodes, other.nodes)
            if shared.any():
                raise PartError(
                    f"port {port.name}: node {port.ids[np.argmax(shared)]} belongs to the rigid port "
                    f"{other.name} too; expected it in one of them: make one of them smaller, or "
                    'kind = "average"'
                )


def _port_dofs(port: PortNodes, fixed: Ints, dofs: Dofs) -> Ints:
    """All DOFs of the port's nodes: translations, then those rotations that exist."""
    found = np.concatenate([dofs.find(port.nodes, direction) for direction in range(6)])
    k = len(port.nodes)
    missing = np.flatnonzero(found[: 3 * k] < 0)
    if len(missing):
        raise PartError(
            f"port {port.name}: node {port.ids[missing[0] % k]} has no DOF in {DIRECTIONS[missing[0] // k]}; "
            'a rigid port needs all three at each of its nodes: select others, or kind = "average"'
        )
    held = np.flatnonzero(np.isin(found, fixed))
    if len(held):
        raise PartError(
            f"port {port.name}: a support holds its node {port.ids[held[0] % k]} in "
            f'{DIRECTIONS[held[0] // k]}; a rigid port must be free: select other nodes, or kind = "average"'
        )
    if np.count_nonzero(found >= 0) == len(dofs.node):
        raise PartError(
            f"port {port.name}: got all nodes of the part, which could not deform then; select fewer, or "
            'kind = "average"'
        )
    return np.asarray(found[found >= 0])


def _rigid_columns(port: PortNodes, place: Ints, dofs: Dofs) -> csr_array:
    """Translations, and rotations about the principal axes of the port that move something: (n, ≤ 6)."""
    r = arms(port)
    k = len(port.nodes)
    direction = dofs.direction[place]
    turning = direction >= 3
    J = k * tensor(np.full(k, 1 / k), r)
    J = J + np.diag([np.count_nonzero(direction == d) for d in (3, 4, 5)])
    inertia, axes = np.linalg.eigh(J)
    axes = axes[:, inertia > smallest(inertia, port)]
    columns = np.zeros((len(place), 3 + axes.shape[1]))
    columns[np.arange(3 * k), direction[: 3 * k]] = 1.0
    for column, axis in enumerate(axes.T, start=3):
        columns[: 3 * k, column] = np.cross(axis, r).T.ravel()
        columns[turning, column] = axis[direction[turning] - 3]
    columns *= np.sqrt(k) / np.linalg.norm(columns, axis=0)
    i, j = np.nonzero(columns)
    return _sparse(columns[i, j], place[i], j, (len(dofs.node), columns.shape[1]))


def _sparse(values: Floats, rows: Ints, columns: Ints, shape: tuple[int, int]) -> csr_array:
    """32-bit indices as those of K, which the solvers take."""
    return csr_array((values, (rows.astype(np.int32), columns.astype(np.int32))), shape=shape)
