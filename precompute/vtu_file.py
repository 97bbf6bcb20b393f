"""A mesh with fields at its points, as a .vtu file for ParaView."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import meshio
from numpy.typing import NDArray

from .arrays import Ints
from .vtk_file import KINDS

NAMES = {ours: theirs for theirs, ours in KINDS.items()}


def write_vtu(
    path: Path, points: NDArray[Any], cells: Mapping[str, Ints], fields: Mapping[str, NDArray[Any]]
) -> None:
    """points (n, 3); cells: family of solids or faces → (c, k) rows of points; fields: name → (n, ...)."""
    blocks = [
        (NAMES.get(family.removesuffix("r"), family.removesuffix("r")), nodes)
        for family, nodes in cells.items()
    ]
    meshio.Mesh(points, blocks, point_data=dict(fields)).write(path, file_format="vtu")
