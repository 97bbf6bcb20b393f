"""A bar of a few cells with its part file: small enough to be built in every test."""

from pathlib import Path

import meshio
import numpy as np
from boxes import box

from precompute.arrays import Floats, Ints

LENGTH, WIDTH, CELLS = 1.0, 0.1, 6
YOUNG, DENSITY = 210e9, 7850.0

TEXT = f"""\
[part]
name = "bar"
description = "a steel bar"
mesh = "bar.vtu"
length_unit = "m"

[[material]]
name = "steel"
young = {YOUNG}
poisson = 0.0
density = {DENSITY}

[[support]]
at = {{ plane = {{ normal = "x", at = 0.0 }} }}
fix = ["x", "y", "z"]

[[port]]
name = "tip"
at = {{ plane = {{ normal = "x", at = {LENGTH} }} }}
inputs = ["force.x", "force.z"]
outputs = ["displacement.x", "displacement.z", "velocity.z"]

[modes]
count = 8

[damping]
ratio = 0.02
"""


def bar() -> tuple[Floats, Ints]:
    """Points and 8-node hexahedra of the bar along x."""
    mesh = box("hex8", (CELLS, 1, 1), (LENGTH, WIDTH, WIDTH))
    return mesh.points, mesh.cells["hex8"]


def write_part(folder: Path, *changes: tuple[str, str]) -> Path:
    """bar.vtu and part.toml, each change (old, new) made in its text; gives the path of the part file."""
    text = TEXT
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, 1)
    write_mesh(folder, *bar())
    part = folder / "part.toml"
    part.write_text(text, encoding="utf-8")
    return part


def write_mesh(folder: Path, points: Floats, cells: Ints, groups: Ints | None = None) -> None:
    """groups: (c,) become the cell sets "group 1", "group 2", …"""
    data = {} if groups is None else {"group": [groups]}
    meshio.Mesh(points, [("hexahedron", cells)], cell_data=data).write(folder / "bar.vtu")


def beside(points: Floats, cells: Ints, shift: tuple[float, float, float]) -> tuple[Floats, Ints]:
    """The same cells once more, moved by `shift`; nodes at one place are one."""
    both = np.concatenate([points, points + shift])
    _, first, number = np.unique(both.round(9), axis=0, return_index=True, return_inverse=True)
    return both[first], number.ravel()[np.concatenate([cells, cells + len(points)])]
