"""Stress at ports, linear in the displacements: σ = λ tr(H) I + μ (H + Hᵀ) with H_ij = ∂u_i/∂x_j."""

from collections.abc import Mapping, Sequence

import numpy as np
from scipy.sparse import csr_array, kron

from .arrays import Bools, Floats, Ints
from .cell_matrices import gradients
from .errors import ModalFmuError
from .material import CellMaterial
from .mesh import Mesh
from .nodal_recovery import RECOVERIES
from .notice import notice

COMPONENTS = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))  # xx yy zz xy yz zx


def stress_rows(mesh: Mesh, materials: Sequence[CellMaterial], nodes: Ints, weights: Floats) -> csr_array:
    """S (6, 3n) in Pa/m with S u = Σ_a w_a σ(x_a): the mean stress over a port's nodes, xx yy zz xy yz zx.

    nodes (k,) rows of mesh.points; weights (k,) ≥ 0 of sum 1; u by DOF 3·node + direction. At a node the
    stress is the mean over the cells that contain it, weighted by their volumes, of the stress that each cell
    has there (`nodal_recovery`). Stress jumps between materials, so one material counts at a node: of those
    that meet there the one that is at most of the port's nodes, the first in order among equals.
    Raises ModalFmuError: a weight below 0.
    """
    if not (weights >= 0).all():
        raise ModalFmuError(
            f"stress: got a weight of {weights.min():.3g}, expected weights ≥ 0; use equal ones"
        )
    n = len(mesh.points)
    around = [_cells_at(mesh, material, nodes) for material in materials]
    volumes = np.array([_volumes_at(mesh, cells, n)[nodes] for cells in around])
    owner = _owners(volumes > 0, materials)
    S = csr_array((6, 3 * n))
    for k, (material, cells) in enumerate(zip(materials, around, strict=True)):
        own = owner == k
        if own.any():
            per_volume = np.zeros(n)
            per_volume[nodes[own]] = weights[own] / volumes[k, own]
            S = S + _stress(material, _mean_gradient(mesh, cells, per_volume))
    return S


def _cells_at(mesh: Mesh, material: CellMaterial, nodes: Ints) -> Mapping[str, Ints]:
    """family → the nodes (c, k) of those cells of the material that contain one of `nodes`."""
    marked = np.zeros(len(mesh.points), dtype=np.bool_)
    marked[nodes] = True
    cells = {family: mesh.cells[family][rows] for family, rows in material.cells.items()}
    return {family: of[marked[of].any(axis=1)] for family, of in cells.items()}


def _volumes_at(mesh: Mesh, cells: Mapping[str, Ints], n: int) -> Floats:
    """The volume of all these cells that contain a node, m³: (n,)."""
    total = np.zeros(n)
    for family, of in cells.items():
        _, dV = gradients(mesh.points[of], RECOVERIES[family].rule)
        total += np.bincount(of.ravel(), np.repeat(dV.sum(axis=1), of.shape[1]), minlength=n)
    return total


def _owners(present: Bools, materials: Sequence[CellMaterial]) -> Ints:
    """Which material counts at each node (k,), from those that are there (materials, k)."""
    if (present.sum(axis=0) > 1).any():
        met = [m.name for m, there in zip(materials, present, strict=True) if there.any()]
        notice(f"stress: the materials {', '.join(met)} meet at a port; stress there is taken on one side")
    order = np.argsort(-present.sum(axis=1), kind="stable")
    owner: Ints = order[np.argmax(present[order], axis=0)]
    return owner


def _mean_gradient(mesh: Mesh, cells: Mapping[str, Ints], per_volume: Floats) -> csr_array:
    """g (3, n) with Σ_b g_jb u_bi = Σ_cells V Σ_a p_a ∂u_i/∂x_j(x_a), p = per_volume (n,) in 1/m³."""
    n = len(mesh.points)
    g = csr_array((3, n))
    for family, of in cells.items():
        recovery = RECOVERIES[family]
        G, dV = gradients(mesh.points[of], recovery.rule)
        at_points = dV.sum(axis=1)[:, None] * per_volume[of] @ recovery.extrapolation
        values = np.einsum("cs,csbj->jcb", at_points, G)
        columns = np.broadcast_to(of, values.shape)
        rows = np.broadcast_to(np.arange(3)[:, None, None], values.shape)
        g = g + csr_array((values.ravel(), (rows.ravel(), columns.ravel())), shape=(3, n))
    return g


def _stress(material: CellMaterial, g: csr_array) -> csr_array:
    """(6, 3n): λ δ_ij Σ_k H_kk + μ (H_ij + H_ji) with H_ij = Σ_b g_jb u_bi, row 3j + i of g ⊗ I₃."""
    C = np.zeros((6, 9))
    for row, (i, j) in zip(C, COMPONENTS, strict=True):
        row[3 * j + i] += material.mu
        row[3 * i + j] += material.mu
        if i == j:
            row[[0, 4, 8]] += material.lam
    return csr_array(csr_array(C) @ kron(g, np.eye(3), format="csr"))
