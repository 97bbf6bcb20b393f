"""What one needs to know of a mesh in order to write a part file for it."""

import json
import re
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np
from rich import box
from rich.console import RenderableType
from rich.table import Table

from .arrays import Floats, Ints
from .faces import exterior_faces, node_areas
from .mesh import Mesh
from .read_mesh import UNITS

SUPPORTS = re.compile("fix|clamp|support|ground|root|base|held|hold|encastre|bolt|screw|mount", re.IGNORECASE)


def inspection(mesh: Mesh, file: Path, unit: str | None) -> Iterator[RenderableType]:
    """Cells by family, extent, surface, named sets, and tables of a part file that fit them.

    mesh: as read with `unit`, one of UNITS, or in "m" where it is not known (None).
    """
    metres = UNITS[unit or "m"]
    word = unit or "(unit of the file)"
    low, high = mesh.bounds / metres
    area = sum(node_areas(mesh.points, name, faces).sum() for name, faces in exterior_faces(mesh).items())
    yield f"{file.name}: {len(mesh.points)} nodes, {3 * len(mesh.points)} degrees of freedom"
    yield f"cells    {', '.join(f'{len(nodes)} {family}' for family, nodes in mesh.cells.items())}"
    yield f"from     {_list(low)} {word}"
    yield f"to       {_list(high)} {word}"
    yield f"size     {_list(high - low)} {word}"
    yield f"surface  {area / metres**2:.6g} {f'{unit}²' if unit else '(unit of the file)²'}"
    yield _sets(mesh, metres) if mesh.node_sets or mesh.cell_sets else "\nno named sets\n"
    yield "A part file could begin with\n\n" + example(mesh, file, unit)


def example(mesh: Mesh, file: Path, unit: str | None) -> str:
    """A part file for this mesh, with its own sets where it has some: TOML that can be read."""
    support, port = _places(mesh, UNITS[unit or "m"])
    return f"""\
[part]
name = "{re.sub("[^A-Za-z0-9_]", "_", file.stem).lstrip("0123456789") or "part"}"
mesh = {json.dumps(file.name, ensure_ascii=False)}
length_unit = "{unit or "m"}"{"" if unit else "               # the unit of the mesh's coordinates"}

[[material]]
name = "steel"
young = 210e9                   # Pa
poisson = 0.3
density = 7850.0                # kg/m³

[[support]]
at = {support}
fix = ["x", "y", "z"]

[[port]]
name = "tip"
at = {port}
inputs = ["force.z"]
outputs = ["displacement.z", "velocity.z"]

[modes]
count = 10

[damping]
ratio = 0.01
"""


def _sets(mesh: Mesh, metres: float) -> Table:
    table = Table(box=box.SIMPLE)
    for heading in ("set", "of", "count", "from", "to"):
        table.add_column(heading, justify="right" if heading == "count" else "left")
    for name, nodes in mesh.node_sets.items():
        table.add_row(name, "nodes", str(len(nodes)), *_extent(mesh, nodes, metres))
    for name, cells in mesh.cell_sets.items():
        count = sum(map(len, cells.values()))
        table.add_row(name, "cells", str(count), *_extent(mesh, _nodes_of(mesh, cells), metres))
    return table


def _nodes_of(mesh: Mesh, cells: Mapping[str, Ints]) -> Ints:
    rows = [mesh.cells[family][of_family].ravel() for family, of_family in cells.items()]
    return np.unique(np.concatenate(rows))


def _extent(mesh: Mesh, nodes: Ints, metres: float) -> tuple[str, str]:
    if not len(nodes):
        return "–", "–"
    p = mesh.points[nodes] / metres
    return _list(p.min(axis=0)), _list(p.max(axis=0))


def _places(mesh: Mesh, metres: float) -> tuple[str, str]:
    """Where a support and a port could be: sets of nodes, by their names, or the ends of the longest side."""
    sets = [name for name, nodes in mesh.node_sets.items() if 0 < len(nodes) < len(mesh.points)]
    sets.sort(key=lambda name: SUPPORTS.search(name) is None)
    low, high = mesh.bounds / metres
    k = int(np.argmax(high - low))
    end = mesh.points[np.argmax(mesh.points[:, k])] / metres
    support = json.dumps(sets[0], ensure_ascii=False) if sets else None
    port = json.dumps(sets[1], ensure_ascii=False) if len(sets) > 1 else None
    return (
        support or f'{{ plane = {{ normal = "{"xyz"[k]}", at = {low[k]:.9g} }} }}',
        port or f"{{ point = {_list(end, digits=9)} }}",
    )


def _list(p: Floats, digits: int = 6) -> str:
    return f"[{', '.join(f'{x + 0.0:.{digits}g}' for x in p)}]"
