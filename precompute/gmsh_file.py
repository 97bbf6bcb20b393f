"""Gmsh meshes (.msh 2.2 and 4.1, text and binary): nodes, cells, physical groups.

Gmsh Reference Manual: "MSH file format", "Legacy formats", "Node ordering".
"""

import re
from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .arrays import Floats, Ints
from .errors import MeshError
from .gmsh_sections import MshFile, Numbers, open_msh, section
from .raw_mesh import Block, RawMesh, rows_of


@dataclass(frozen=True)
class CellType:
    """A cell type of Gmsh: our name, number of nodes, dimension; order: Gmsh's place of each of our nodes."""

    kind: str
    k: int
    dimension: int
    order: tuple[int, ...] | None = None


CELL_TYPES: Mapping[int, CellType] = {
    **{1: CellType("line2", 2, 1), 2: CellType("tri3", 3, 2), 3: CellType("quad4", 4, 2)},
    **{4: CellType("tet4", 4, 3), 5: CellType("hex8", 8, 3), 6: CellType("wedge6", 6, 3)},
    **{7: CellType("pyramid5", 5, 3), 8: CellType("line3", 3, 1), 9: CellType("tri6", 6, 2)},
    10: CellType("quad9", 9, 2),
    11: CellType("tet10", 10, 3, (0, 1, 2, 3, 4, 5, 6, 7, 9, 8)),
    **{12: CellType("hex27", 27, 3), 13: CellType("wedge18", 18, 3), 14: CellType("pyramid14", 14, 3)},
    **{15: CellType("point", 1, 0), 16: CellType("quad8", 8, 2)},
    17: CellType("hex20", 20, 3, (0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15)),
    **{18: CellType("wedge15", 15, 3), 19: CellType("pyramid13", 13, 3)},
}


@dataclass(frozen=True)
class Cells:
    """Cells of one type: nodes (c, k) as tags; groups: physical tag → rows of its cells."""

    type: CellType
    nodes: Ints
    groups: Mapping[int, Ints]


def read_gmsh(path: Path) -> RawMesh:
    """What a .msh file says. Sets: physical groups by name, "physical 7" where tag 7 has no name.

    Raises MeshError: no or another Gmsh format, a file cut off, cells of third or higher order.
    """
    msh = open_msh(path.read_bytes())
    if msh.version == "4.1":
        tags, points = _nodes_4(Numbers(msh, "Nodes"))
        blocks = _cells_4(Numbers(msh, "Elements"), _entities(msh))
    else:
        if section(msh, "ParametricNodes") is not None:
            raise MeshError("got $ParametricNodes; save without them (Mesh.SaveParametric = 0)")
        nodes = Numbers(msh, "Nodes")
        tags, points = nodes.tagged_points(nodes.line())
        blocks = _cells_2(Numbers(msh, "Elements"))
    names = _physical_names(msh)
    sets: dict[str, dict[int, Ints]] = defaultdict(dict)
    for number, cells in enumerate(blocks):
        for tag, rows in cells.groups.items():
            members = sets[names.get((cells.type.dimension, tag), f"physical {tag}")]
            members[number] = np.union1d(members.get(number, rows), rows)
    return RawMesh(
        points=points,
        node_ids=tags,
        blocks=[Block(cells.type.kind, rows_of(cells.nodes, tags)) for cells in blocks],
        node_sets={},
        sets=sets,
    )


def _cell_type(number: int) -> CellType:
    if number not in CELL_TYPES:
        raise MeshError(
            f"got cells of Gmsh type {number}; expected first or second order (Mesh.ElementOrder = 2)"
        )
    return CELL_TYPES[number]


def _physical_names(msh: MshFile) -> dict[tuple[int, int], str]:
    """(dimension, tag) → name."""
    text = (section(msh, "PhysicalNames") or b"").decode(errors="replace")
    return {
        (int(d), int(tag)): name for d, tag, name in re.findall(r'^(\d) +(\d+) +"(.*)"', text, re.MULTILINE)
    }


def _entities(msh: MshFile) -> dict[tuple[int, int], list[int]]:
    """(dimension, tag of an entity) → its physical tags, without the signs that say how it is turned."""
    if section(msh, "Entities") is None:
        return {}
    numbers = Numbers(msh, "Entities")
    groups: dict[tuple[int, int], list[int]] = {}
    for dimension, count in enumerate(numbers.sizes(4).tolist()):
        for _ in range(count):
            tag = int(numbers.ints(1)[0])
            numbers.floats(3 if dimension == 0 else 6)  # the place or the bounding box
            groups[dimension, tag] = abs(numbers.ints(int(numbers.sizes(1)[0]))).tolist()
            if dimension:
                numbers.ints(int(numbers.sizes(1)[0]))  # the entities around it
    return groups


def _nodes_4(numbers: Numbers) -> tuple[Ints, Floats]:
    tags, points = [np.zeros(0, np.int64)], [np.zeros((0, 3))]
    for _ in range(numbers.sizes(4)[0]):
        dimension, _, parametric = numbers.ints(3).tolist()
        count = int(numbers.sizes(1)[0])
        width = 3 + dimension if parametric else 3
        tags.append(numbers.sizes(count))
        points.append(numbers.floats(count * width).reshape(count, width)[:, :3])
    return np.concatenate(tags), np.concatenate(points)


def _cells_4(numbers: Numbers, groups: Mapping[tuple[int, int], list[int]]) -> list[Cells]:
    blocks: list[Cells] = []
    for _ in range(numbers.sizes(4)[0]):
        dimension, entity, number = numbers.ints(3).tolist()
        count = int(numbers.sizes(1)[0])
        cell_type = _cell_type(number)
        nodes = numbers.sizes(count * (1 + cell_type.k)).reshape(count, 1 + cell_type.k)[:, 1:]
        rows = np.arange(count, dtype=np.int64)
        blocks.append(_cells(cell_type, nodes, dict.fromkeys(groups.get((dimension, entity), ()), rows)))
    return blocks


def _cells(cell_type: CellType, nodes: Ints, groups: Mapping[int, Ints]) -> Cells:
    order = list(cell_type.order or range(cell_type.k))
    return Cells(cell_type, nodes[:, order], groups)


def _cells_2(numbers: Numbers) -> list[Cells]:
    """Version 2 repeats a cell for every physical group it is in: it becomes one cell again."""
    tables: dict[int, list[Ints]] = defaultdict(list)
    for number, table in _records(numbers):
        tables[number].append(table)
    blocks: list[Cells] = []
    for number, parts in tables.items():
        table = np.concatenate(parts)
        physical = abs(table[:, 0])
        _, first, which = np.unique(table[:, 1:], axis=0, return_index=True, return_inverse=True)
        cell = np.argsort(np.argsort(first))[which.ravel()]  # numbered by first appearance
        groups = {
            tag: np.unique(cell[physical == tag]) for tag in np.unique(physical[physical != 0]).tolist()
        }
        blocks.append(_cells(_cell_type(number), table[np.sort(first), 1:], groups))
    return blocks


def _records(numbers: Numbers) -> Iterator[tuple[int, Ints]]:
    """Type of the cells, table (c, 1 + k) of their physical tag (0: none) and nodes."""
    total = numbers.line()
    if numbers.is_text:
        values = numbers.rest()
        starts: dict[tuple[int, int], list[int]] = defaultdict(list)
        at, flat = 0, values.tolist()
        for _ in range(total):
            if at + 3 > len(flat) or flat[at + 2] < 0:
                break  # too few numbers, said below
            starts[flat[at + 1], flat[at + 2]].append(at)
            at += 3 + flat[at + 2] + _cell_type(flat[at + 1]).k
        if at != len(flat) or sum(map(len, starts.values())) != total:
            raise MeshError(f"$Elements does not hold the {total} cells it announces; is the file cut off?")
        for (number, tags), first in starts.items():
            columns = np.arange(3, 3 + tags + _cell_type(number).k)
            yield number, _physical_first(values[np.add.outer(np.array(first), columns)], tags)
        return
    while total > 0:
        number, count, tags = numbers.ints(3).tolist()
        width = 1 + tags + _cell_type(number).k
        yield number, _physical_first(numbers.ints(count * width).reshape(count, width)[:, 1:], tags)
        total -= max(count, 1)


def _physical_first(table: Ints, tags: int) -> Ints:
    """Columns of tags and nodes → the first tag, which is the physical one, and the nodes."""
    physical = table[:, 0] if tags else np.zeros(len(table), np.int64)
    return np.column_stack([physical, table[:, tags:]])
