"""The mesh of an Abaqus or CalculiX deck (.inp): nodes, elements, sets and surfaces; all else is passed over.

What keywords and their data lines mean: Abaqus Keywords Reference Guide; CalculiX CrunchiX User's Manual.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from .arrays import Floats, Ints
from .deck_cells import Elements, parse_elements, parse_nodes
from .deck_lines import Keyword, part_level, read_keywords
from .deck_sets import lookup, named_ids
from .deck_surfaces import surface_nodes
from .errors import MeshError
from .notice import notice
from .raw_mesh import Block, RawMesh, rows_of

_GENERATORS = frozenset({"NGEN", "NFILL", "NCOPY", "NMAP", "ELGEN", "ELCOPY", "SYSTEM"})


def read_deck(path: Path) -> RawMesh:
    """What a deck says of its mesh: one part, flat or as *PART with one *INSTANCE.

    Raises MeshError: a line that is not what its keyword wants, an element without all of its nodes, a node
        or an element defined twice, keywords that generate them, several parts, a deck that was cut off.
    """
    keywords = part_level(read_keywords(path))
    for keyword in keywords:
        if keyword.name in _GENERATORS:
            raise MeshError(
                f"{keyword.where}: *{keyword.name} is not carried out; write all nodes and elements out"
            )
    nodes = {i: parse_nodes(keyword) for i, keyword in enumerate(keywords) if keyword.name == "NODE"}
    elements = {i: parse_elements(keyword) for i, keyword in enumerate(keywords) if keyword.name == "ELEMENT"}
    node_ids, points = _points(list(nodes.values()))
    blocks = [_block(keywords[i], block, node_ids) for i, block in elements.items()]
    _check_end(path, keywords[-1], blocks, len(points))

    element_ids = _element_ids(list(elements.values()))
    members = {i: block.ids for i, block in elements.items()}
    elsets = named_ids(keywords, "ELSET", members, element_ids, lookup({}))

    def nodes_of(elset: str) -> Ints | None:
        ids = lookup(elsets)(elset)
        if ids is None:
            return None
        return np.concatenate([block.nodes[np.isin(block.ids, ids)].ravel() for block in elements.values()])

    nsets = named_ids(keywords, "NSET", {i: ids for i, (ids, _) in nodes.items()}, node_ids, nodes_of)
    surfaces = _surfaces(keywords, list(elements.values()), elsets, nsets)
    node_sets = {name: rows_of(ids, node_ids) for name, ids in {**surfaces, **nsets}.items()}
    sets = {name: _cells(ids, list(elements.values())) for name, ids in elsets.items()}
    for name, ids in elsets.items():
        _tell_missing(name, "elements", int(np.count_nonzero(~np.isin(ids, element_ids))))
    for name, rows in node_sets.items():
        _tell_missing(name, "nodes", int(np.count_nonzero(rows < 0)))
    return RawMesh(points, node_ids, blocks, node_sets, sets)


def _points(blocks: Sequence[tuple[Ints, Floats]]) -> tuple[Ints, Floats]:
    """Ids and coordinates in the order of the deck; a node may be repeated with the same coordinates."""
    ids = np.concatenate([np.zeros(0, np.int64), *(ids for ids, _ in blocks)])
    points = np.concatenate([np.zeros((0, 3)), *(points for _, points in blocks)])
    _, first, which = np.unique(ids, return_index=True, return_inverse=True)
    moved = np.flatnonzero((points != points[first][which]).any(axis=1) & np.isfinite(points).all(axis=1))
    if moved.size:
        i = int(moved[0])
        raise MeshError(
            f"node {ids[i]} is defined at {points[first[which[i]]].tolist()} and {points[i].tolist()}; "
            f"give each node a number of its own"
        )
    first.sort()
    return ids[first], points[first]


def _block(keyword: Keyword, elements: Elements, node_ids: Ints) -> Block:
    rows = rows_of(elements.nodes, node_ids)
    if elements.family is None:
        return Block(elements.kind, rows)
    missing = np.argwhere(rows < 0)
    if missing.size:
        cell, node = missing[0]
        raise MeshError(
            f"{keyword.where}: element {elements.ids[cell]} names node {elements.nodes[cell, node]}, "
            f"which the deck does not define; is the file cut off?"
        )
    return Block(elements.family, rows)


def _element_ids(elements: Sequence[Elements]) -> Ints:
    ids = np.concatenate([np.zeros(0, np.int64), *(block.ids for block in elements)])
    unique, counts = np.unique(ids, return_counts=True)
    if (counts > 1).any():
        raise MeshError(
            f"element {unique[counts > 1][0]} is defined twice; give each element a number of its own"
        )
    return unique


def _check_end(path: Path, last: Keyword, blocks: Sequence[Block], n: int) -> None:
    """A cut may hide in the last number of a deck that ends in elements: then some nodes are used by none."""
    if last.name != "ELEMENT" or path.read_bytes()[-1:].isspace():
        return
    if len(np.unique(np.concatenate([block.nodes.ravel() for block in blocks]))) < n:
        raise MeshError(
            f"the deck ends amid a line of the *ELEMENT of {last.where} and has nodes that no element uses, "
            f"as if cut off; export it again, or end the last line if it is whole"
        )


def _surfaces(
    keywords: Sequence[Keyword],
    elements: Sequence[Elements],
    elsets: Mapping[str, Ints],
    nsets: Mapping[str, Ints],
) -> dict[str, Ints]:
    surfaces: dict[str, Ints] = {}
    for keyword in keywords:
        if keyword.name == "SURFACE" and keyword.options.get("NAME"):
            name = keyword.options["NAME"]
            nodes = surface_nodes(keyword, elements, lookup(elsets), lookup(nsets))
            if nodes is None:
                notice(
                    f"{keyword.where}: surface {name!r} is left out, it is not made of nodes or element faces"
                )
            else:
                surfaces[name] = nodes
    return surfaces


def _cells(ids: Ints, elements: Sequence[Elements]) -> dict[int, Ints]:
    """Number of a block → rows of its cells among the ids."""
    rows = {number: np.flatnonzero(np.isin(block.ids, ids)) for number, block in enumerate(elements)}
    return {number: cells.astype(np.int64) for number, cells in rows.items() if cells.size}


def _tell_missing(name: str, what: str, count: int) -> None:
    if count:
        notice(f"set {name!r} names {count} {what} that the deck does not have; they are passed over")
