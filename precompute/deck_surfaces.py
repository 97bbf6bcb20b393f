"""Surfaces of a deck: the nodes of *SURFACE."""

from collections.abc import Sequence

import numpy as np

from .arrays import Ints
from .deck_cells import Elements
from .deck_lines import Keyword
from .deck_sets import Lookup
from .faces import CELL_FACES

_LABELS = ("S1", "S2", "S3", "S4", "S5", "S6")  # Abaqus and CalculiX number faces in the order of CELL_FACES


def surface_nodes(
    keyword: Keyword, elements: Sequence[Elements], elsets: Lookup, nsets: Lookup
) -> Ints | None:
    """Sorted unique ids of the nodes on a *SURFACE; None where its data cannot be told from the mesh alone.

    TYPE=NODE: lines of a node or node set. TYPE=ELEMENT: lines of an element or its set and a face S1 … S6
    or SPOS, SNEG of shells (all their nodes).
    """
    of_nodes = keyword.options.get("TYPE", "ELEMENT").upper() == "NODE"
    nodes = [np.zeros(0, np.int64)]
    for line in keyword.data:
        name, *rest = (token.strip().strip("\"'") for token in line.text.split(","))
        name = name.rpartition(".")[2]
        ids = np.array([int(name)]) if name.isdecimal() else (nsets if of_nodes else elsets)(name.upper())
        if ids is None or "COMBINE" in keyword.options:
            return None
        if of_nodes:
            nodes.append(ids)
            continue
        face = rest[0].upper() if rest else ""
        if face not in (*_LABELS, "SPOS", "SNEG"):
            return None
        nodes += [block.nodes[np.isin(block.ids, ids)][:, _local(block, face)].ravel() for block in elements]
    return np.unique(np.concatenate(nodes))


def _local(block: Elements, face: str) -> list[int]:
    """Local nodes on a face of the elements; none where they have no such face."""
    if block.family is None:
        return list(range(block.nodes.shape[1])) if face in ("SPOS", "SNEG") else []
    return list(dict(zip(_LABELS, CELL_FACES[block.family], strict=False)).get(face, ()))
