"""The mode shapes on the mesh of the part, to look at in ParaView."""

from pathlib import Path

import numpy as np

from .dofs import nodal
from .errors import PartError
from .mode_report import hertz
from .output_file import replacing
from .pipeline import Reduction
from .vtu_file import write_vtu

LARGEST = 0.05  # of the mesh's diagonal: easily seen, and the part still looks like itself


def write_mode_shapes(path: Path, reduction: Reduction) -> None:
    """A .vtu file: the solid cells in m, and a field φᵢ (n, 3) per mode such as "mode 01 440.00 Hz".

    Each field is scaled so that its largest displacement is 5 % of the mesh's diagonal: ParaView's filter
    Warp By Vector shows it with scale factor 1.
    """
    mesh = reduction.full.mesh
    if mesh is None:
        raise PartError(
            f"{reduction.part.source.name}: got no mesh to draw mode shapes on; add [part] mesh, with the "
            "node numbers of the matrices"
        )
    shapes = nodal(reduction.full.dofs, reduction.modes.Phi, len(mesh.points))
    r = shapes.shape[2]
    largest = np.linalg.norm(shapes, axis=1).max(axis=0)
    drawn = (shapes * (LARGEST * mesh.diagonal / largest)).astype(np.float32)
    names = [_name(i, r, f) for i, f in enumerate(reduction.model.frequency.tolist(), start=1)]
    with replacing(path) as aside:
        write_vtu(aside, mesh.points, mesh.cells, {name: drawn[..., i] for i, name in enumerate(names)})


def _name(i: int, r: int, f: float) -> str:
    number = str(i).zfill(max(2, len(str(r))))
    return f"mode {number} {f'{hertz(f)} Hz' if f > 0 else 'rigid'}"
