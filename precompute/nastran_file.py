"""Nastran bulk data (.bdf, .nas, .dat, .fem): GRID points, solid elements, properties as sets.

Fields have 8 characters, 16 where the name ends in *, or end at commas (Nastran Quick Reference Guide).
"""

import re
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from .errors import MeshError
from .raw_mesh import Block, RawMesh, rows_of

_SOLIDS: Mapping[str, Mapping[int, str]] = {
    "CTETRA": {4: "tet4", 10: "tet10"},
    "CHEXA": {8: "hex8", 20: "hex20"},
    "CPENTA": {6: "wedge6", 15: "wedge15"},
    "CPYRAM": {5: "pyramid5", 13: "pyramid13"},
}
# Nastran lists the mid-edge nodes of hexahedra bottom, upright, top; we bottom, top, upright.
_ORDER = {"hex20": [*range(12), *range(16, 20), *range(12, 16)]}
_OTHERS: Mapping[str, int] = {
    **dict.fromkeys(("CTRIA3", "CTRIAR"), 3),
    **dict.fromkeys(("CQUAD4", "CQUADR", "CSHEAR"), 4),
    **{"CTRIA6": 6, "CQUAD8": 8},
    **dict.fromkeys(("CBAR", "CBEAM", "CBEND", "CROD", "CTUBE"), 2),
    **{"CBUSH": 1},
    **dict.fromkeys(("CONM2", "RBE2", "RBE3", "CELAS1", "CELAS2"), 0),
}
"""Nodes of elements that are no solids; 0 for those that have no property, and so are in no set."""


class Card(NamedTuple):
    """An entry: its name without *, its fields from the second on, without blanks; where it begins."""

    name: str
    fields: list[str]
    where: str


def read_nastran(path: Path) -> RawMesh:
    """What the bulk data says. Sets: property ids as "pid 3".

    Raises MeshError: no ENDDATA, INCLUDE, points in a coordinate system of their own, an element without all
        of its nodes.
    """
    ids: list[int] = []
    points: list[list[float]] = []
    nodes: dict[str, list[list[int]]] = defaultdict(list)
    sets: dict[str, dict[str, list[int]]] = defaultdict(lambda: defaultdict(list))
    for card in _cards(path.read_text(encoding="utf-8", errors="replace").splitlines()):
        if card.name == "GRID":
            ids.append(_whole(card, 0))
            points.append(_coordinates(card))
        elif card.name in _SOLIDS or card.name in _OTHERS:
            kind, cell = _cell(card)
            pid = card.fields[1] if _OTHERS.get(card.name) != 0 else ""
            if pid:
                sets[f"pid {pid}"][kind].append(len(nodes[kind]))
            nodes[kind].append(cell)
        elif card.name in ("INCLUDE", "GRDSET"):
            raise MeshError(
                f"{card.where}: {card.name} is not carried out; write one file with plain GRID entries"
            )
    node_ids = np.array(ids, dtype=np.int64)
    if len(np.unique(node_ids)) < len(node_ids):
        unique, counts = np.unique(node_ids, return_counts=True)
        raise MeshError(f"GRID {unique[counts > 1][0]} is defined twice; give each point a number of its own")
    kinds = list(nodes)
    return RawMesh(
        points=np.array(points, dtype=float).reshape(-1, 3),
        node_ids=node_ids,
        blocks=[Block(kind, rows_of(np.array(nodes[kind], np.int64), node_ids)) for kind in kinds],
        node_sets={},
        sets={
            name: {kinds.index(kind): np.array(cells, np.int64) for kind, cells in members.items()}
            for name, members in sets.items()
        },
    )


def _cards(lines: Sequence[str]) -> Iterator[Card]:
    """The entries between BEGIN BULK, where there is one, and ENDDATA, their continuations joined."""
    begin = next((i for i, line in enumerate(lines) if re.match(r"\s*BEGIN\s+BULK", line, re.IGNORECASE)), -1)
    card: Card | None = None
    for number in range(begin + 1, len(lines)):
        name, fields = _fields(lines[number])
        if not name and not any(fields):
            continue
        if card is not None and (not name or name[0] in "+*"):
            card.fields.extend(fields)
            continue
        if card is not None:
            yield card
        if name == "ENDDATA":
            return
        card = Card(name.rstrip("*_"), fields, f"line {number + 1}")  # meshio writes CHEXA_
    raise MeshError(
        "got no ENDDATA at the end of the bulk data; is the file cut off? add the line if it is whole"
    )


def _fields(line: str) -> tuple[str, list[str]]:
    """The first field in capitals and the 8 behind it, or 4 wide ones; a last field joins lines."""
    line = line.split("$", 1)[0].rstrip()
    if "," in line:
        name, *fields = (field.strip() for field in line.split(","))
        wide = name.endswith("*")
        return name.upper(), (fields + [""] * 8)[: 4 if wide else 8]
    line = line.expandtabs(8)
    name = line[:8].strip().upper()
    width = 16 if "*" in name else 8
    return name, [line[at : at + width].strip() for at in range(8, 72, width)]


def _coordinates(card: Card) -> list[float]:
    number, system, *xyz = (card.fields + [""] * 5)[:5]
    if system not in ("", "0"):
        raise MeshError(
            f"{card.where}: GRID {number} is given in coordinate system {system}; export it in the basic one"
        )
    try:
        return [_real(text) for text in xyz]
    except ValueError:
        raise MeshError(f"{card.where}: expected GRID, id, system, x, y, z, got {card.fields[:5]}") from None


def _real(text: str) -> float:
    """1.5-3 and 1.5D-3 stand for 1.5E-3, nothing for 0."""
    return float(re.sub(r"(?<=[\d.])([+-])", r"E\1", text.upper().replace("D", "E")) or 0.0)


def _cell(card: Card) -> tuple[str, list[int]]:
    """Kind and nodes in our order."""
    if card.name in _OTHERS:
        return card.name, [_whole(card, 2 + i) for i in range(_OTHERS[card.name])]
    fields = card.fields[2:]
    while fields and not fields[-1]:
        fields.pop()
    by_count = _SOLIDS[card.name]
    if len(fields) not in by_count or "" in fields:
        raise MeshError(
            f"{card.where}: {card.name} {card.fields[0]} has {len(fields) - fields.count('')} nodes, "
            f"expected {' or '.join(map(str, by_count))}; is the file cut off?"
        )
    kind = by_count[len(fields)]
    nodes = [_whole(card, 2 + i) for i in range(len(fields))]
    return kind, [nodes[i] for i in _ORDER.get(kind, range(len(nodes)))]


def _whole(card: Card, field: int) -> int:
    text = card.fields[field] if field < len(card.fields) else ""
    if not text.isdecimal():
        raise MeshError(
            f"{card.where}: {card.name} {card.fields[0]} has {text!r} in field {field + 2}, expected a number"
        )
    return int(text)
