"""What one needs to know of a mesh in order to write a part file for it."""

import json
import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from rich import box
from rich.console import RenderableType
from rich.table import Table

from .arrays import Floats, Ints
from .faces import exterior_faces, node_areas
from .mesh import Mesh

HELD = re.compile("fix|clamp|support|ground|root|base|hold|encastre", re.IGNORECASE)  # names of supports


def inspection(mesh: Mesh, file: Path, unit: str | None) -> Iterator[RenderableType]:
    """Cells, extent and surface, named sets, and the tables of a part file that could use them.

    mesh: as read in m where no unit is known, so that its numbers are those of the file.
    """
    metres = UNITS[unit or "m"]
    word = unit or "in the file's unit"
    low, high = mesh.bounds / metres
    area = sum(node_areas(mesh.points, name, faces).sum() for name, faces in exterior_faces(mesh).items())
    yield f"{file.name}: {len(mesh.points)} nodes, {3 * len(mesh.points)} degrees of freedom"
    yield f"cells: {', '.join(f'{len(nodes)} {family}' for family, nodes in mesh.cells.items())}"
    yield f"box: {_at(low)} to {_at(high)} {word}"
    yield f"size: {' x '.join(f'{x:.6g}' for x in high - low)} {word}"
