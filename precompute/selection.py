"""Which nodes a support or a port takes, which cells a material takes."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np

from .arrays import Bools, Floats, Ints
from .errors import SelectionError
from .mesh import Mesh
from .node_table import COORDINATES
from .notice import warning
from .set_names import Source, choice, sets_of, shortened, spelled

TOLERANCE = 1e-6  # of the mesh's diagonal: far above rounding of a file's digits, far below any cell
FAR = 1e-2  # of the diagonal: a nearest node farther away than this is probably not the one meant


@dataclass(frozen=True)
class NamedSet:
    """The nodes of a node set or, where no node set has the name, of a cell set."""

    name: str


@dataclass(frozen=True)
class Point:
    """The node nearest to p, (3,) in the file's length unit."""

    p: tuple[float, float, float]


@dataclass(frozen=True)
class Box:
    """The nodes with low ≤ p ≤ high, each (3,) in the file's length unit."""

    low: tuple[float, float, float]
    high: tuple[float, float, float]


@dataclass(frozen=True)
class Plane:
    """The nodes with p_normal = at, in the file's length unit."""

    normal: Literal["x", "y", "z"]
    at: float


@dataclass(frozen=True)
class Nodes:
    """The nodes with these numbers of the file."""

    ids: tuple[int, ...]


Selection: TypeAlias = NamedSet | Point | Box | Plane | Nodes


def select_nodes(source: Source, at: Selection | str, scale: float) -> Ints:
    """Rows of source.points that `at` selects, sorted and unique, at least one.

    scale: metres per unit of the coordinates in `at` (UNITS[length_unit] of read_mesh).
    Boxes and planes include what lies within 1e-6 of the mesh's diagonal. A plain str is a NamedSet.
    Nodes whose place is not known are selected by their numbers and sets only.
    Raises SelectionError, beginning with what was selected: nothing matches, a node number does not exist, a
    place is asked for and none is known.
    """
    match at:
        case str(name) | NamedSet(name):
            return _named(source, name)
        case Point(p):
            return _nearest(source, np.array(p, float), scale)
        case Box(low, high):
            what = f"box {list(low)} to {list(high)}"
            tolerance = TOLERANCE * _diagonal(source, what)
            above = source.points >= np.array(low, float) * scale - tolerance
            below = source.points <= np.array(high, float) * scale + tolerance
            return _inside(source, np.all(above & below, axis=1), what, scale)
        case Plane(normal, position):
            what = f"plane {normal} = {position:g}"
            offset = source.points[:, "xyz".index(normal)] - position * scale
            return _inside(source, abs(offset) <= TOLERANCE * _diagonal(source, what), what, scale)
        case Nodes(ids):
            return _numbered(source, np.unique(np.array(ids, np.int64)))


def select_cells(mesh: Mesh, name: str) -> Mapping[str, Ints]:
    """family → rows of mesh.cells[family] of the cell set `name`.

    Raises SelectionError where no cell set has the name.
    """
    known = spelled(name, mesh.cell_sets)
    if known is not None:
        return mesh.cell_sets[known]
    if spelled(name, mesh.node_sets) is not None:
        raise SelectionError(
            f"set {name!r} has nodes but no solid cells; {choice('cell set', mesh.cell_sets, name)}"
        )
    raise SelectionError(f"no cell set is named {name!r}; {choice('cell set', mesh.cell_sets, name)}")


def _named(source: Source, name: str) -> Ints:
    known = spelled(name, source.node_sets)
    if known is not None:
        nodes = source.node_sets[known]
    else:
        known = spelled(name, source.cell_sets)
        if known is None:
            raise SelectionError(f"no set is named {name!r}; {sets_of(source, name)}")
        rows = [source.cells[family][cells].ravel() for family, cells in source.cell_sets[known].items()]
        nodes = np.unique(np.concatenate(rows)) if rows else np.zeros(0, np.int64)
    if not nodes.size:
        raise SelectionError(f"set {known!r} has no node in a solid cell; {sets_of(source)}")
    return nodes


def _nearest(source: Source, p: Floats, scale: float) -> Ints:
    """argmin_i |p_i − p|, the first of equals."""
    diagonal = _diagonal(source, f"point {_coordinates(p)}")
    distance = np.linalg.norm(source.points - p * scale, axis=1)
    row = int(np.nanargmin(distance))
    if distance[row] > FAR * diagonal:
        warning(
            f"point {_coordinates(p)}: the nearest node, {source.node_ids[row]} at "
            f"{_coordinates(source.points[row] / scale)}, is {distance[row] / scale:.4g} away, "
            f"{distance[row] / diagonal:.0%} of the mesh's diagonal; is the point in its length unit?"
        )
    return np.array([row], np.int64)


def _inside(source: Source, inside: Bools, what: str, scale: float) -> Ints:
    nodes = np.flatnonzero(inside).astype(np.int64)
    if not nodes.size:
        low, high = np.nanmin(source.points, axis=0) / scale, np.nanmax(source.points, axis=0) / scale
        raise SelectionError(
            f"{what} holds no node; the mesh reaches from {_coordinates(low)} to {_coordinates(high)} "
            f"in its length unit; {sets_of(source)}"
        )
    return nodes


def _diagonal(source: Source, what: str) -> float:
    """Length of the diagonal of the box around the nodes, m."""
    if np.isnan(source.points).all():
        raise SelectionError(
            f"{what}: got matrices without coordinates, so that no node has a place; select by"
            f" nodes = [numbers], or {COORDINATES}"
        )
    return float(np.linalg.norm(np.nanmax(source.points, axis=0) - np.nanmin(source.points, axis=0)))


def _numbered(source: Source, ids: Ints) -> Ints:
    rows = np.flatnonzero(np.isin(source.node_ids, ids)).astype(np.int64)
    missing = np.setdiff1d(ids, source.node_ids[rows])
    if missing.size or not rows.size:
        where = "in no solid cell of the mesh; its" if source.cells else "not in the matrices; their"
        raise SelectionError(
            f"got nodes {shortened(missing.tolist())}, {where} numbers lie between "
            f"{source.node_ids.min()} and {source.node_ids.max()}; {sets_of(source)}"
        )
    return rows


def _coordinates(p: Floats) -> str:
    return "[" + ", ".join(f"{x:.6g}" for x in p) + "]"
