"""Which nodes a support or a port takes, which cells a material takes."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from typing import Literal, TypeAlias

import numpy as np

from .arrays import Bools, Floats, Ints
from .errors import SelectionError
from .mesh import Mesh
from .notice import warning

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


def select_nodes(mesh: Mesh, at: Selection | str, scale: float) -> Ints:
    """Rows of mesh.points that `at` selects, sorted and unique, at least one.

    scale: metres per unit of the coordinates in `at` (UNITS[length_unit] of read_mesh).
    Boxes and planes include what lies within 1e-6 of the mesh's diagonal. A plain str is a NamedSet.
    Raises SelectionError, beginning with what was selected: nothing matches, a node number does not exist.
    """
    match at:
        case str(name) | NamedSet(name):
            return _named(mesh, name)
        case Point(p):
            return _nearest(mesh, np.array(p, float), scale)
        case Box(low, high):
            tolerance = TOLERANCE * mesh.diagonal
            above = mesh.points >= np.array(low, float) * scale - tolerance
            below = mesh.points <= np.array(high, float) * scale + tolerance
            return _inside(mesh, np.all(above & below, axis=1), f"box {list(low)} to {list(high)}", scale)
        case Plane(normal, position):
            offset = mesh.points[:, "xyz".index(normal)] - position * scale
            return _inside(
                mesh, abs(offset) <= TOLERANCE * mesh.diagonal, f"plane {normal} = {position:g}", scale
            )
        case Nodes(ids):
            return _numbered(mesh, np.unique(np.array(ids, np.int64)))


def select_cells(mesh: Mesh, name: str) -> Mapping[str, Ints]:
    """family → rows of mesh.cells[family] of the cell set `name`.

    Raises SelectionError where no cell set has the name.
    """
    known = _lookup(name, mesh.cell_sets)
    if known is not None:
        return mesh.cell_sets[known]
    if _lookup(name, mesh.node_sets) is not None:
        raise SelectionError(
            f"set {name!r} has nodes but no solid cells; {_choice('cell set', mesh.cell_sets, name)}"
        )
    raise SelectionError(f"no cell set is named {name!r}; {_choice('cell set', mesh.cell_sets, name)}")


def _named(mesh: Mesh, name: str) -> Ints:
    known = _lookup(name, mesh.node_sets)
    if known is not None:
        nodes = mesh.node_sets[known]
    else:
        known = _lookup(name, mesh.cell_sets)
        if known is None:
            names = [*mesh.node_sets, *(n for n in mesh.cell_sets if n not in mesh.node_sets)]
            raise SelectionError(f"no set is named {name!r}; {_choice('set', names, name)}")
        rows = [mesh.cells[family][cells].ravel() for family, cells in mesh.cell_sets[known].items()]
        nodes = np.unique(np.concatenate(rows)) if rows else np.zeros(0, np.int64)
    if not nodes.size:
        raise SelectionError(f"set {known!r} has no node in a solid cell; {_sets(mesh)}")
    return nodes


def _nearest(mesh: Mesh, p: Floats, scale: float) -> Ints:
    """argmin_i |p_i − p|, the first of equals."""
    distance = np.linalg.norm(mesh.points - p * scale, axis=1)
    row = int(np.argmin(distance))
    if distance[row] > FAR * mesh.diagonal:
        warning(
            f"point {_coordinates(p)}: the nearest node, {mesh.node_ids[row]} at "
            f"{_coordinates(mesh.points[row] / scale)}, is {distance[row] / scale:.4g} away, "
            f"{distance[row] / mesh.diagonal:.0%} of the mesh's diagonal; is the point in its length unit?"
        )
    return np.array([row], np.int64)


def _inside(mesh: Mesh, inside: Bools, what: str, scale: float) -> Ints:
    nodes = np.flatnonzero(inside).astype(np.int64)
    if not nodes.size:
        low, high = mesh.bounds / scale
        raise SelectionError(
            f"{what} holds no node; the mesh reaches from {_coordinates(low)} to {_coordinates(high)} "
            f"in its length unit; {_sets(mesh)}"
        )
    return nodes


def _numbered(mesh: Mesh, ids: Ints) -> Ints:
    rows = np.flatnonzero(np.isin(mesh.node_ids, ids)).astype(np.int64)
    missing = np.setdiff1d(ids, mesh.node_ids[rows])
    if missing.size or not rows.size:
        raise SelectionError(
            f"nodes {_shortened(missing.tolist())} are in no solid cell of the mesh; its numbers lie between "
            f"{mesh.node_ids.min()} and {mesh.node_ids.max()}; {_sets(mesh)}"
        )
    return rows


def _lookup(name: str, names: Iterable[str]) -> str | None:
    """The name as the mesh spells it; decks know no case, so one that differs in case alone will do."""
    names = list(names)
    if name in names:
        return name
    alike = [known for known in names if known.casefold() == name.casefold()]
    return alike[0] if len(alike) == 1 else None


def _sets(mesh: Mesh) -> str:
    return _choice("set", list(dict.fromkeys([*mesh.node_sets, *mesh.cell_sets])), "")


def _choice(what: str, names: Iterable[str], wanted: str) -> str:
    """did you mean 'clamp'? the mesh has the sets 'clamp', 'tip'."""
    names = sorted(names)
    if not names:
        return (
            f"the mesh has no {what}: name groups where it is made, or select by point, box, plane or nodes"
        )
    near = get_close_matches(wanted.casefold(), [name.casefold() for name in names], n=1)
    meant = [name for name in names if near and name.casefold() == near[0]]
    hint = f"did you mean {meant[0]!r}? " if meant else ""
    return f"{hint}the mesh has the {what}s {_shortened([repr(name) for name in names])}"


def _shortened(items: list[str] | list[int], most: int = 20) -> str:
    more = f" … ({len(items)} in all)" if len(items) > most else ""
    return ", ".join(map(str, items[:most])) + more


def _coordinates(p: Floats) -> str:
    return "[" + ", ".join(f"{x:.6g}" for x in p) + "]"
