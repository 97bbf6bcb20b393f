"""Mesh and materials → M ü + D u̇ + K u = F [2.16], DOF 3·node + direction."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from threadpoolctl import threadpool_limits

from .arrays import Floats, Ints
from .cell_checks import check_materials, check_shapes, check_twins
from .cell_matrices import mass, stiffness
from .dofs import mesh_dofs
from .elements import ELEMENTS
from .material import CellMaterial, shared_rayleigh
from .mesh import Mesh
from .node_pairs import BlockSums, is_upper, kron_identity, pair_keys
from .system import System, rigid_motions

_BLOCK_BYTES = 4_000_000  # of the cells' K at a time: they stay in the processor's cache


@dataclass(frozen=True)
class _Block:
    """Some cells of one family and one material: nodes (c, k)."""

    family: str
    material: CellMaterial
    nodes: Ints


def _blocks(mesh: Mesh, materials: Sequence[CellMaterial]) -> Iterator[_Block]:
    for material in materials:
        for family, cells in material.cells.items():
            step = max(1, _BLOCK_BYTES // (8 * (3 * ELEMENTS[family].nodes) ** 2))
            for start in range(0, len(cells), step):
                yield _Block(family, material, mesh.cells[family][cells[start : start + step]])


def assemble(
    mesh: Mesh,
    materials: Sequence[CellMaterial],
    progress: Callable[[float], None] = lambda fraction: None,
) -> System:
    """K = Σ_cells ∫ Bᵀ C B dV, M = Σ_cells ∫ ρ N_a N_b dV ⊗ I₃ (consistent mass), D = Σ_m α_m M_m + β_m K_m.

    mesh: n points; materials: every cell is in exactly one of them; progress: called with the fraction done.
    Gives M in kg, K in N/m and D in N·s/m, (3n, 3n), exactly symmetric, with sorted int32 indices. D lacks
    the α and β that all materials share (`shared_rayleigh`); there is none where nothing else is left.
    Raises MeshError: cells in no material or in two, a material without cells, det J ≤ 0 somewhere.
    """
    check_materials(mesh, materials)
    # many small products: BLAS threads would cost more than they give
    with threadpool_limits(limits=1, user_api="blas"):
        check_twins(mesh)
        check_shapes(mesh)
        K, m, D = _sums(mesh, materials, progress)
    return System(
        M=kron_identity(m.symmetric()),
        K=K.symmetric(),
        rigid=rigid_motions(mesh_dofs(len(mesh.points)), mesh.points),
        D=None if D is None else D.symmetric(),
    )


def _sums(
    mesh: Mesh, materials: Sequence[CellMaterial], progress: Callable[[float], None]
) -> tuple[BlockSums, BlockSums, BlockSums | None]:
    """Σ_cells K_ab, m_ab and α_m m_ab I₃ + β_m K_ab for every pair of nodes that share a cell."""
    n = len(mesh.points)
    alpha, beta = shared_rayleigh(materials)
    blocks = list(_blocks(mesh, materials))
    keys = [pair_keys(block.nodes, n) for block in blocks]
    ends = np.cumsum([len(k) for k in keys])
    pairs, slots = np.unique(np.concatenate(keys), return_inverse=True)
    del keys
    K = BlockSums(pairs, n, np.zeros((len(pairs), 9)))
    m = BlockSums(pairs, n, np.zeros((len(pairs), 1)))
    differ = any((material.alpha, material.beta) != (alpha, beta) for material in materials)
    D = BlockSums(pairs, n, np.zeros((len(pairs), 9))) if differ else None
    for number, (block, slot) in enumerate(zip(blocks, np.split(slots, ends[:-1]), strict=True)):
        upper = is_upper(block.nodes)
        x = mesh.points[block.nodes]
        K_ab = _stiffness_blocks(block, x)[upper].reshape(-1, 9)
        m_ab = mass(block.family, x, block.material.density)[upper][:, None]
        K.add(slot, K_ab)
        m.add(slot, m_ab)
        if D is not None:
            own_alpha, own_beta = block.material.alpha - alpha, block.material.beta - beta
            D.add(slot, own_alpha * m_ab * np.eye(3).ravel() + own_beta * K_ab)
        if 100 * number // len(blocks) != 100 * (number + 1) // len(blocks):
            progress((number + 1) / len(blocks))
    return K, m, D


def _stiffness_blocks(block: _Block, x: Floats) -> Floats:
    """K_ab (c, k, k, 3, 3)."""
    c, k = block.nodes.shape
    K = stiffness(block.family, x, block.material.lam, block.material.mu)
    return K.reshape(c, k, 3, k, 3).swapaxes(2, 3)
