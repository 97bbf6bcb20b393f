"""Can the cells be integrated: each in exactly one material, each with det J > 0."""

from collections.abc import Iterable, Sequence

import numpy as np

from .arrays import Floats, Ints
from .cell_matrices import determinants, jacobians
from .elements import ELEMENTS, Element
from .errors import MeshError
from .material import CellMaterial
from .mesh import Mesh

_SHOWN = 3  # cells named in a message
_STEP = 5_000  # cells at a time
_FLAT = 1e-12  # det J below this part of |∂x/∂ξ| |∂x/∂η| |∂x/∂ζ| is zero to rounding


def check_materials(mesh: Mesh, materials: Sequence[CellMaterial]) -> None:
    """Raises MeshError: a material without cells, cells in no material, cells in two materials."""
    for material in materials:
        if not any(len(cells) for cells in material.cells.values()):
            raise MeshError(
                f"material {material.name!r} covers no cell; expected at least one: "
                f"name one of the cell sets {_names(mesh.cell_sets)}, or take the material out"
            )
    uses = {
        family: np.bincount(
            np.concatenate([np.zeros(0, int), *(m.cells[family] for m in materials if family in m.cells)]),
            minlength=len(nodes),
        )
        for family, nodes in mesh.cells.items()
    }
    bare = {family: np.flatnonzero(use == 0) for family, use in uses.items()}
    if _count(bare):
        raise MeshError(
            f"cells without material: {_count(bare)}, first {_places(mesh, bare)}{_sets_of(mesh, bare)}; "
            f"give them one by `cells`, or leave `cells` out of one material to take all the others"
        )
    twice = {family: np.flatnonzero(use > 1) for family, use in uses.items()}
    if _count(twice):
        owners = [
            material.name
            for material in materials
            if any(np.isin(material.cells.get(family, []), cells).any() for family, cells in twice.items())
        ]
        raise MeshError(
            f"cells in more than one material ({_names(owners)}): {_count(twice)}, first "
            f"{_places(mesh, twice)}{_sets_of(mesh, twice)}; let every cell be in one material only"
        )


def check_twins(mesh: Mesh) -> None:
    """Raises MeshError: cells between the same nodes as another; stiffness and mass would count twice."""
    twins = {}
    for family, nodes in mesh.cells.items():
        _, first = np.unique(np.sort(nodes, axis=1), axis=0, return_index=True)
        twins[family] = np.setdiff1d(np.arange(len(nodes)), first)
    if _count(twins):
        raise MeshError(
            f"cells in the place of another: {_count(twins)}, first {_places(mesh, twins)}; expected "
            f"one cell between the same nodes: delete the duplicates"
        )


def check_shapes(mesh: Mesh) -> None:
    """Raises MeshError: det J ≤ 0, or zero to rounding, at an integration point of K or M."""
    bad = {family: _inverted(mesh.points, nodes, ELEMENTS[family]) for family, nodes in mesh.cells.items()}
    if _count(bad):
        raise MeshError(
            f"inverted or flat cells (det J ≤ 0 at an integration point): {_count(bad)}, first "
            f"{_places(mesh, bad)}; expected VTK's node order (first face counter-clockwise seen from inside)"
            f" and mid-edge nodes near the middle: reorder the nodes, or mesh curved places finer"
        )


def _inverted(points: Floats, nodes: Ints, element: Element) -> Ints:
    """Rows of the cells with det J ≤ 0 at a point of either rule."""
    dN = np.concatenate([element.stiffness.dN, element.mass.dN])
    found = [np.zeros(0, int)]
    for start in range(0, len(nodes), _STEP):
        J = jacobians(points[nodes[start : start + _STEP]], dN)
        size = np.sqrt(np.einsum("cqij,cqij->cqj", J, J)).prod(axis=-1)
        found.append(start + np.flatnonzero((determinants(J) <= _FLAT * size).any(axis=1)))
    return np.concatenate(found)


def _count(cells: dict[str, Ints]) -> int:
    return sum(len(rows) for rows in cells.values())


def _names(names: Iterable[str]) -> str:
    return ", ".join(repr(name) for name in names) or "(there are none)"


def _places(mesh: Mesh, cells: dict[str, Ints]) -> str:
    """The first cells by family, number (from 1) and centre."""
    first = [(family, row) for family, rows in cells.items() for row in rows][:_SHOWN]
    text = []
    for family, row in first:
        x, y, z = mesh.points[mesh.cells[family][row]].mean(axis=0)
        text.append(f"{family} cell {row + 1} near ({x:.4g}, {y:.4g}, {z:.4g}) m")
    return ", ".join(text) + (", …" if _count(cells) > _SHOWN else "")


def _sets_of(mesh: Mesh, cells: dict[str, Ints]) -> str:
    """The cell sets that hold any of the cells."""
    names = [
        name
        for name, members in mesh.cell_sets.items()
        if any(np.isin(members.get(family, []), rows).any() for family, rows in cells.items())
    ]
    return f" (in the cell sets {_names(names)})" if names else ""
