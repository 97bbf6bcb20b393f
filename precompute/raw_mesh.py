"""What a mesh file says, before anything is left out: RawMesh → Mesh."""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from .arrays import Bools, Floats, Ints
from .errors import MeshError
from .mesh import FAMILIES, Mesh
from .notice import notice

SHAPES = frozenset({"point", "line2", "line3", "tri3", "tri6", "quad4", "quad8", "quad9"})
"""Cells of files that know geometry only (Gmsh, VTK): on the surface of solid cells they mark a boundary."""

_SPLIT = "use the linear family or tetrahedra there"
REMEDIES: Mapping[str, str] = {
    "hex27": "write 20-node hexahedra (Gmsh: Mesh.SecondOrderIncomplete = 1)",
    "wedge15": _SPLIT,
    "wedge18": _SPLIT,
    "pyramid5": "mesh without pyramids: tetrahedra alone, or hexahedra with wedges",
    "pyramid13": "mesh without pyramids: tetrahedra alone",
    "pyramid14": "mesh without pyramids: tetrahedra alone",
}
"""Solid cells that cannot be integrated, and what to do about them."""


@dataclass(frozen=True)
class Block:
    """Cells of one kind: a family, a key of REMEDIES, one of SHAPES, or the file's own name (S8R, CQUAD4).

    nodes: (c, k) rows of points, −1 for a node that the file does not have.
    """

    kind: str
    nodes: Ints


@dataclass(frozen=True)
class RawMesh:
    """points (n, 3) in the file's unit; node_ids (n,); sets: name → number of a block → rows of its cells."""

    points: Floats
    node_ids: Ints
    blocks: Sequence[Block]
    node_sets: Mapping[str, Ints]
    sets: Mapping[str, Mapping[int, Ints]]


def rows_of(ids: Ints, node_ids: Ints) -> Ints:
    """Row of each id in node_ids (any order), −1 where there is none."""
    if not node_ids.size:
        return np.full(ids.shape, -1, np.int64)
    order = np.argsort(node_ids, kind="stable")
    position = np.searchsorted(node_ids, ids, sorter=order)
    rows = order[np.minimum(position, len(order) - 1)].astype(np.int64)
    rows[node_ids[rows] != ids] = -1
    return rows


def solid_mesh(raw: RawMesh, metres: float) -> Mesh:
    """The solid cells, their points times `metres`, and the named sets as far as they lie on them.

    Cells of sets that are no solids (boundary groups, shells) leave their nodes as a node set of the name.
    What is left out is counted in a notice.
    Raises MeshError: no solid cell, or one that cannot be integrated.
    """
    _refuse(raw.blocks)
    cells, offsets = _families(raw.blocks)
    used = np.unique(np.concatenate([nodes.ravel() for nodes in cells.values()]))
    if used[0] < 0:
        raise MeshError("a solid cell names a node that the file does not have; is the file cut off?")
    kept = np.full(len(raw.points), -1, np.int64)
    kept[used] = np.arange(len(used))
    _tell(raw, kept >= 0)

    cell_sets: dict[str, dict[str, Ints]] = {}
    boundaries: dict[str, Ints] = {}
    for name, members in raw.sets.items():
        solids: dict[str, list[Ints]] = {}
        nodes = [np.zeros(0, np.int64)]
        for number, rows in members.items():
            block = raw.blocks[number]
            if number in offsets:
                solids.setdefault(block.kind, []).append(rows + offsets[number])
            else:
                nodes.append(block.nodes[rows].ravel())
        if solids:
            cell_sets[name] = {family: np.unique(np.concatenate(rows)) for family, rows in solids.items()}
        if len(nodes) > 1 or not solids:
            boundaries[name] = np.concatenate(nodes)
    return Mesh(
        points=raw.points[used] * metres,
        cells={family: kept[nodes] for family, nodes in cells.items()},
        node_ids=raw.node_ids[used],
        node_sets={name: _on(kept, rows) for name, rows in {**boundaries, **raw.node_sets}.items()},
        cell_sets=cell_sets,
    )


def _refuse(blocks: Sequence[Block]) -> None:
    for kind, count in _count(blocks).items():
        if kind in REMEDIES:
            raise MeshError(f"got {count} {kind} cells, which cannot be integrated; {REMEDIES[kind]}")
    if not any(block.kind in FAMILIES and len(block.nodes) for block in blocks):
        found = _listing(_count(blocks))
        if not found:
            raise MeshError("got no cells at all; is the file cut off, or was the part never meshed?")
        raise MeshError(
            f"got no solid cells but {found}; mesh the volume with tetrahedra, hexahedra or wedges"
        )


def _families(blocks: Sequence[Block]) -> tuple[dict[str, Ints], dict[int, int]]:
    """family → all its cells; number of a block of solids → row of its first cell among them."""
    parts: dict[str, list[Ints]] = {}
    offsets: dict[int, int] = {}
    for number, block in enumerate(blocks):
        if block.kind in FAMILIES and len(block.nodes):
            before = parts.setdefault(block.kind, [])
            offsets[number] = sum(map(len, before))
            before.append(block.nodes)
    return {family: np.concatenate(nodes) for family, nodes in parts.items()}, offsets


def _tell(raw: RawMesh, used: Bools) -> None:
    """Count what is left out; shapes on the solid's own nodes only mark its boundary."""
    left = _count(
        block
        for block in raw.blocks
        if block.kind not in FAMILIES
        and not (block.kind in SHAPES and (block.nodes >= 0).all() and used[block.nodes].all())
    )
    if left:
        notice("cells left out, not solid: " + _listing(left))
    if not used.all():
        notice(f"nodes dropped, in no solid cell: {np.count_nonzero(~used)}")


def _count(blocks: Iterable[Block]) -> Counter[str]:
    counts: Counter[str] = Counter()
    for block in blocks:
        counts[block.kind] += len(block.nodes)
    return +counts


def _listing(counts: Counter[str]) -> str:
    return ", ".join(f"{count} {kind}" for kind, count in counts.items())


def _on(kept: Ints, rows: Ints) -> Ints:
    """New rows of those nodes that are kept."""
    rows = rows[rows >= 0]
    new: Ints = np.unique(kept[rows])
    return new[new >= 0]
