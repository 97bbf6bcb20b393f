"""Structured boxes of every family, to be mapped to other shapes: meshes made in the tests."""

from collections.abc import Callable
from itertools import permutations

import numpy as np

from precompute.arrays import Floats, Ints
from precompute.elements import HEX_EDGES, INTERPOLATIONS, TET_EDGES
from precompute.material import CellMaterial
from precompute.mesh import Mesh

BASE = {"hex8r": "hex8", "hex20r": "hex20"}  # reduced families have the nodes of the full ones


def mesh_of(points: Floats, cells: dict[str, Ints]) -> Mesh:
    """A mesh without sets, numbered from 1."""
    return Mesh(points, cells, np.arange(1, len(points) + 1), {}, {})


def _cells_of_a_cube(family: str) -> list[Floats]:
    """Nodes (k, 3) in [0, 1]³ of the cells that fill one cube; neighbouring cubes fit together."""
    nodes = INTERPOLATIONS[family].nodes
    if family.startswith("hex"):
        return [nodes]
    if family == "wedge6":
        lower = nodes @ np.array([[1, 0, 0], [1, 1, 0], [0, 0, 1]])
        upper = nodes @ np.array([[1, 1, 0], [0, 1, 0], [0, 0, 1]])
        return [lower, upper]
    cells = []
    for order in permutations(range(3)):  # six tetrahedra along the diagonal (Kuhn)
        steps = np.cumsum(np.eye(3)[list(order)], axis=0)
        if np.linalg.det(steps) < 0:
            steps = steps[[1, 0, 2]]
        cells.append(nodes @ steps)
    return cells


def box(
    family: str, counts: tuple[int, int, int], size: tuple[float, float, float] = (1.0, 1.0, 1.0)
) -> Mesh:
    """The box [0, size] in m of counts cubes."""
    base = BASE.get(family, family)
    grid = 2 * np.array(counts) + 1
    start = 2 * np.stack(np.meshgrid(*map(np.arange, counts), indexing="ij"), axis=-1).reshape(-1, 1, 3)
    place = np.concatenate([start + np.rint(2 * cell).astype(int) for cell in _cells_of_a_cube(base)])
    used, cells = np.unique(
        np.ravel_multi_index(tuple(np.moveaxis(place, -1, 0)), tuple(grid)), return_inverse=True
    )
    points = np.stack(np.unravel_index(used, tuple(grid)), axis=1) / (grid - 1) * np.array(size)
    return mesh_of(points, {family: cells.reshape(place.shape[:2])})


def mapped(mesh: Mesh, f: Callable[[Floats], Floats]) -> Mesh:
    """The same cells between the points f(p)."""
    return Mesh(f(mesh.points), mesh.cells, mesh.node_ids, mesh.node_sets, mesh.cell_sets)


def straightened(mesh: Mesh, family: str) -> Mesh:
    """Mid-edge nodes of a tet10 or hex20 mesh moved to the middle of their edges: edges become straight."""
    edges = TET_EDGES if family == "tet10" else HEX_EDGES
    cells, points = mesh.cells[family], mesh.points.copy()
    for mid, ends in zip(range(len(set(sum(edges, ()))), cells.shape[1]), edges, strict=True):
        points[cells[:, mid]] = points[cells[:, ends]].mean(axis=1)
    return Mesh(points, mesh.cells, mesh.node_ids, mesh.node_sets, mesh.cell_sets)


def joined(first: Mesh, second: Mesh) -> Mesh:
    """Both meshes, with nodes at the same place made one."""
    points = np.concatenate([first.points, second.points])
    _, keep, number = np.unique(np.round(points, 9), axis=0, return_index=True, return_inverse=True)
    number = number.ravel()
    cells = {family: number[nodes] for family, nodes in first.cells.items()}
    for family, nodes in second.cells.items():
        other = number[nodes + len(first.points)]
        cells[family] = np.concatenate([cells[family], other]) if family in cells else other
    return mesh_of(points[keep], cells)


def steel(mesh: Mesh, poisson: float = 0.3) -> list[CellMaterial]:
    """All cells of one material."""
    cells = {family: np.arange(len(nodes)) for family, nodes in mesh.cells.items()}
    return [CellMaterial("steel", young=210e9, poisson=poisson, density=7850.0, cells=cells)]
