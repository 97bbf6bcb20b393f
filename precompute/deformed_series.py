"""The deformed shape p' = p + Uq [2.19, 2.20] over time, as a series that ParaView plays."""

import tempfile
from pathlib import Path
from xml.sax.saxutils import quoteattr

import numpy as np

from .arrays import Floats, Ints
from .errors import ModalFmuError
from .output_file import replacing
from .shape import Shape, deformed_points
from .vtu_file import write_vtu

FRAMES = 200


def write_series(
    path: Path, shape: Shape, time: Floats, q: Floats, scale: float = 1.0, frames: int = FRAMES
) -> Path:
    """NAME.pvd and, beside it, one numbered NAME_000.vtu per frame; gives the path of the .pvd file.

    path: its ending does not matter; time: (n,) s; q: (n, r) modal amplitudes. Of the n instants at most
    `frames` are drawn, the first and the last among them. The points of a frame are p + s·Uq, s = `scale`;
    its field "displacement" is the true Uq in m.
    Raises ModalFmuError where the shape has other modes than q.
    """
    if q.shape != (len(time), shape.Phi.shape[2]):
        raise ModalFmuError(
            f"got modal amplitudes {q.shape}, expected ({len(time)}, {shape.Phi.shape[2]}); build the FMU again"
        )
    Phi = shape.Phi.astype(np.float64)
    chosen = drawn_instants(len(time), frames)
    digits = max(3, len(str(len(chosen) - 1)))
    names = [f"{path.stem}_{k:0{digits}d}.vtu" for k in range(len(chosen))]
    # All frames are made aside, so that a run that fails leaves an older series whole.
    with tempfile.TemporaryDirectory(prefix=f".{path.stem}.", dir=path.parent) as folder:
        for name, i in zip(names, chosen, strict=True):
            write_vtu(
                Path(folder, name),
                deformed_points(shape, q[i], scale).astype(np.float32),
                shape.faces,
                {"displacement": (Phi @ q[i]).astype(np.float32)},
            )
        for name in names:
            Path(folder, name).replace(path.with_name(name))
    series = path.with_suffix(".pvd")
    with replacing(series) as aside:
        aside.write_text(_collection(time[chosen], names), encoding="utf-8")
    return series


def drawn_instants(n: int, frames: int) -> Ints:
    """At most `frames` of 0 … n − 1, evenly spread with both ends."""
    chosen: Ints = np.unique(np.linspace(0, n - 1, min(n, frames)).round().astype(np.int64))
    return chosen


def largest_displacement(shape: Shape, q: Floats) -> float:
    """max |Uq| over all points and the drawn instants, m; q: (n, r)."""
    Phi = shape.Phi.astype(np.float64)
    return max(
        float(np.linalg.norm(Phi @ q[i], axis=1).max()) for i in drawn_instants(len(q), FRAMES)
    )


def _collection(time: Floats, names: list[str]) -> str:
    frames = "".join(
        f"  <DataSet timestep={quoteattr(repr(float(t)))} part=\"0\" file={quoteattr(name)}/>\n"
        for t, name in zip(time, names, strict=True)
    )
    return (
        '<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1" byte_order="LittleEndian">\n'
        f" <Collection>\n{frames} </Collection>\n</VTKFile>\n"
    )
