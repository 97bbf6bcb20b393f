"""The full model of a part, assembled from a mesh or read from matrices, with where its DOFs are."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from .arrays import Ints
from .assembly import assemble
from .dofs import DIRECTIONS, Dofs, mesh_dofs
from .doubts import doubt_linear_cells
from .errors import PartError, SelectionError
from .material import CellMaterial, shared_rayleigh
from .matrices import SystemFiles, read_system
from .matrix_units import Units
from .mesh import Mesh
from .node_table import NodeTable, place
from .part import Part
from .read_mesh import UNITS, read_mesh
from .selection import Selection, select_cells, select_nodes
from .system import System

Progress = Callable[[str, float | None], None]
"""Called with the stage's name and the fraction of it that is done, None where that is not known."""


@dataclass(frozen=True)
class FullPart:
    """M ü + D u̇ + K u = F [2.16] of a part before its ports, and what the part file says of its nodes.

    nodes: points in m, numbers and sets, by which `dofs` counts; mesh: none where the matrices came without
    one; materials: none for imported matrices; fixed: the DOFs that supports hold, sorted; supports: those
    of each [[support]]; rayleigh: the α in 1/s and β in s that all materials share.
    """

    system: System
    dofs: Dofs
    nodes: NodeTable
    mesh: Mesh | None
    materials: tuple[CellMaterial, ...]
    fixed: Ints
    supports: tuple[Ints, ...]
    rayleigh: tuple[float, float]

    def where(self, dof: int) -> str:
        """The place of a DOF, for messages."""
        return place(self.nodes, self.dofs, dof)


def read_full_part(part: Part, progress: Progress) -> FullPart:
    """The files that a part file names, read and made to one model.

    Raises a ModalFmuError: files that cannot be read, cells that cannot be integrated, matrices that cannot
    be those of a part, selections that match nothing.
    """
    mesh = None
    if part.mesh is not None:
        progress("reading the mesh", None)
        mesh = read_mesh(part.mesh, part.length_unit)
    if part.system is not None:
        return _imported(part, mesh, progress)
    assert mesh is not None  # the part file has one of the two
    nodes = node_table(mesh)
    dofs = mesh_dofs(len(mesh.points))
    supports = _supports(part, nodes, dofs)
    materials = _materials(part, mesh)
    doubt_linear_cells(mesh)
    system = assemble(mesh, materials, lambda fraction: progress("assembling K and M", fraction))
    fixed = _union(supports)
    return FullPart(system, dofs, nodes, mesh, materials, fixed, supports, shared_rayleigh(materials))


def node_table(mesh: Mesh) -> NodeTable:
    """The nodes of a mesh, with its cells and sets."""
    return NodeTable(mesh.points, mesh.node_ids, mesh.cells, mesh.node_sets, mesh.cell_sets)


def nodes_at(part: Part, nodes: NodeTable, key: str, at: Selection) -> Ints:
    """The nodes that `at` of the part file's `key` selects; a SelectionError begins with the key."""
    try:
        return select_nodes(nodes, at, UNITS[part.length_unit])
    except SelectionError as error:
        raise SelectionError(f"{part.source.name}: {key}: {error}") from None


def _imported(part: Part, mesh: Mesh | None, progress: Progress) -> FullPart:
    assert part.system is not None  # the caller saw it
    progress("reading the matrices", None)
    units = part.system.units
    files = SystemFiles(
        part.system.stiffness,
        part.system.mass,
        part.system.damping,
        part.system.dofs,
        Units(units.length, units.mass, units.time),
    )
    read = read_system(files, mesh)
    supports = _supports(part, read.nodes, read.dofs)
    fixed = _union((*supports, read.fixed))
    return FullPart(read.system, read.dofs, read.nodes, mesh, (), fixed, supports, (0.0, 0.0))


def _supports(part: Part, nodes: NodeTable, dofs: Dofs) -> tuple[Ints, ...]:
    """The DOFs that each support holds; a direction that a node does not have is an error."""
    held = []
    for k, support in enumerate(part.supports):
        key = f"support[{k + 1}]"
        at = nodes_at(part, nodes, f"{key}.at", support.at)
        found = [dofs.find(at, DIRECTIONS.index(direction)) for direction in support.fix]
        for direction, places in zip(support.fix, found, strict=True):
            if (places < 0).any():
                node = nodes.node_ids[at[int(np.argmax(places < 0))]]
                raise PartError(
                    f"{part.source.name}: {key}.fix: node {node} has no degree of freedom {direction}, "
                    "expected one; was it eliminated where the matrices come from? leave it out here"
                )
        held.append(np.unique(np.concatenate(found)))
    return tuple(held)


def _union(dofs: tuple[Ints, ...]) -> Ints:
    return np.unique(np.concatenate([np.zeros(0, dtype=np.int64), *dofs]))


def _materials(part: Part, mesh: Mesh) -> tuple[CellMaterial, ...]:
    """Each material with its cells; one without `cells` takes what no other names."""
    named: dict[str, dict[str, Ints]] = {}
    for k, material in enumerate(part.materials):
        if material.cells is not None:
            try:
                named[material.name] = dict(select_cells(mesh, material.cells))
            except SelectionError as error:
                raise SelectionError(f"{part.source.name}: material[{k + 1}].cells: {error}") from None
    rest = {
        family: np.setdiff1d(
            np.arange(len(cells)),
            np.concatenate(
                [np.zeros(0, dtype=np.int64), *(c[family] for c in named.values() if family in c)]
            ),
        )
        for family, cells in mesh.cells.items()
    }
    rest = {family: cells for family, cells in rest.items() if len(cells)}
    for k, material in enumerate(part.materials):
        if material.cells is None and not rest:
            raise PartError(
                f"{part.source.name}: material[{k + 1}]: got no cell that is left for it, expected some; "
                f"remove {material.name!r} or the cells of another material"
            )
    return tuple(
        CellMaterial(
            m.name,
            m.young,
            m.poisson,
            m.density,
            named.get(m.name, rest) if m.cells else rest,
            m.alpha,
            m.beta,
        )
        for m in part.materials
    )
