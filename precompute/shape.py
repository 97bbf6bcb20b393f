"""The deformed shape p' = p + Ux [2.19, 2.20]: the part's surface and its shapes, kept in the FMU."""

import io
import json
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .arrays import Floats, Ints
from .errors import ModelError
from .faces import exterior_faces
from .mesh import Mesh

FOLDER = "extra/modalfmu/shape"
FAMILIES = ("tri3", "tri6", "quad4", "quad8")


@dataclass(frozen=True)
class Shape:
    """points: (n, 3) m, surface nodes; faces: family → (f, k) rows of them; Phi: (n, 3, k + r).

    The k first shapes are those of prescribed motions, m per m or rad, the others mode shapes in kg^-1/2.
    """

    points: Floats
    faces: Mapping[str, Ints]
    Phi: NDArray[np.float32]


def surface_shape(mesh: Mesh, Phi: Floats) -> Shape:
    """The exterior faces of the mesh with the shapes at their nodes; Phi: (n, 3, k + r)."""
    faces = exterior_faces(mesh)
    nodes = np.unique(np.concatenate([f.ravel() for f in faces.values()]))
    place = np.zeros(len(mesh.points), dtype=np.int64)
    place[nodes] = np.arange(len(nodes))
    return Shape(
        mesh.points[nodes],
        {family: place[f] for family, f in faces.items()},
        Phi[nodes].astype(np.float32),
    )


def deformed_points(shape: Shape, q: Floats, scale: float = 1.0) -> Floats:
    """p' = p + scale·Ux [2.19, 2.20] for coordinates x = [s; q] (k + r,); 1 is the true shape; (n, 3) m."""
    return shape.points + scale * (shape.Phi.astype(np.float64) @ q)


def write_shape(shape: Shape) -> dict[str, bytes]:
    """Files of the archive by name: `.npy` arrays (float32 and int32, little-endian) and a `shape.json`."""
    arrays: dict[str, NDArray[Any]] = {
        "points": shape.points.astype("<f4"),
        "Phi": shape.Phi.astype("<f4"),
        **{family: faces.astype("<i4") for family, faces in shape.faces.items()},
    }
    about = {
        "points": "surface nodes, (n, 3) m",
        "Phi": "shapes at them, (n, 3, k + r): displacement = Phi @ x, x the k prescribed displacements and "
        "rotations of ports, then modes.amplitude",
        "faces": dict.fromkeys(shape.faces, "node numbers from 0, VTK order"),
    }
    files = {f"{FOLDER}/{name}.npy": _npy(array) for name, array in arrays.items()}
    files[f"{FOLDER}/shape.json"] = (json.dumps(about, indent=1) + "\n").encode()
    return files


def read_shape(fmu: Path) -> Shape:
    """The shape that an FMU carries; raises ModelError where it carries none, or a damaged one."""
    try:
        with zipfile.ZipFile(fmu) as archive:
            present = set(archive.namelist())
            arrays = {
                name: np.load(io.BytesIO(archive.read(f"{FOLDER}/{name}.npy")), allow_pickle=False)
                for name in ("points", "Phi", *FAMILIES)
                if f"{FOLDER}/{name}.npy" in present
            }
    except (OSError, ValueError, zipfile.BadZipFile) as error:
        raise ModelError(f"{fmu.name}: its mode shapes cannot be read ({error}); build it again") from error
    if not {"points", "Phi"} <= arrays.keys() or len(arrays) < 3:
        raise ModelError(f"{fmu.name}: it carries no mode shapes; build it with modalfmu to draw its shape")
    points, Phi = arrays.pop("points"), arrays.pop("Phi")
    n = len(points)
    if (
        points.shape != (n, 3)
        or Phi.ndim != 3
        or Phi.shape[:2] != (n, 3)
        or any(f.ndim != 2 or f.min() < 0 or f.max() >= n for f in arrays.values())
    ):
        raise ModelError(f"{fmu.name}: its mode shapes do not fit its surface; build it again")
    faces = {family: f.astype(np.int64) for family, f in arrays.items()}
    return Shape(points.astype(np.float64), faces, Phi.astype(np.float32))


def _npy(array: NDArray[Any]) -> bytes:
    buffer = io.BytesIO()
    np.save(buffer, np.ascontiguousarray(array), allow_pickle=False)
    return buffer.getvalue()
