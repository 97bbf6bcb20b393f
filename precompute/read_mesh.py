"""Any mesh file → Mesh."""

from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType

from .deck import read_deck
from .errors import MeshError
from .gmsh_file import read_gmsh
from .mesh import Mesh
from .nastran_file import read_nastran
from .raw_mesh import RawMesh, solid_mesh
from .vtk_file import read_vtk

UNITS: Mapping[str, float] = MappingProxyType(
    {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "um": 1e-6, "in": 0.0254, "ft": 0.3048}
)
"""Metres per unit of length."""

READERS: Mapping[str, Callable[[Path], RawMesh]] = MappingProxyType(
    {
        ".msh": read_gmsh,
        ".inp": read_deck,
        **dict.fromkeys((".bdf", ".nas", ".dat", ".fem"), read_nastran),
        **dict.fromkeys((".vtu", ".vtk"), read_vtk),
    }
)
"""Ending of a file, in small letters → who reads it."""


def read_mesh(path: Path, length_unit: str = "m") -> Mesh:
    """The mesh of a file, in metres; `length_unit` is the unit of its coordinates, one of UNITS.

    Raises MeshError, beginning with the file's name: no such file, an ending that is not one of READERS,
        a file that is damaged or cut off, no solid cell, cells that cannot be integrated.
    """
    path = Path(path)
    if length_unit not in UNITS:
        raise MeshError(f"got length_unit {length_unit!r}, expected one of {', '.join(UNITS)}")
    try:
        return solid_mesh(_read(path), UNITS[length_unit])
    except MeshError as error:
        raise MeshError(f"{path.name}: {error}") from None
    except OSError as error:
        raise MeshError(f"{path.name}: cannot be read ({error.strerror})") from None


def _read(path: Path) -> RawMesh:
    reader = READERS.get(path.suffix.lower())
    if path.is_dir():
        raise MeshError("got a folder; give the path of a mesh file")
    if reader is None:
        raise MeshError(
            f"got the ending {path.suffix!r}, expected one of {', '.join(READERS)}; convert the mesh"
        )
    if not path.exists():
        raise MeshError(f"no such file in {path.resolve().parent}")
    if path.stat().st_size == 0:
        raise MeshError("the file is empty; export the mesh again")
    return reader(path)
