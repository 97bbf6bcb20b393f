"""The deformed shape p' = p + Uq [2.19, 2.20] over time, as a series that ParaView plays."""

import tempfile
from pathlib import Path
from xml.sax.saxutils import quoteattr

import numpy as np

from .arrays import Floats, Ints
from .errors import ModalFmuError
from .notice import notice
from .output_file import replacing
from .shape import Shape, deformed_points
from .vtu_file import write_vtu

FRAMES = 200
SEEN = 0.05  # of the part's size: a deformation that is easily seen


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
            f"got modal amplitudes {q.shape}, expected ({len(time)}, {shape.Phi.shape[2]}); "
            "build the FMU again"
        )
    Phi = shape.Phi.astype(np.float64)
    chosen = drawn_instants(len(time), frames)
    digits = max(3, len(str(len(chosen) - 1)))
    names = [f"{path.stem}_{k:0{digits}d}.vtu" for k in range(len(chosen))]
    largest = max(float(np.linalg.norm(Phi @ q[i], axis=1).max()) for i in chosen)
    _tell_scale(scale, largest, float(np.linalg.norm(np.ptp(shape.points, axis=0))))
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


def _tell_scale(scale: float, largest: float, size: float) -> None:
    """A shape that seems not to move is drawn too small: say which scale would show it."""
    drawn = abs(scale) * largest / size
    if 0 < drawn < 0.2 * SEEN:
        notice(
            f"the largest displacement, {largest:.3g} m, is drawn as {100 * drawn:.2g} % of the part; "
            f"a scale of {SEEN * size / largest:.1g} would draw {100 * SEEN:g} %"
        )


def _collection(time: Floats, names: list[str]) -> str:
    frames = "".join(
        f'  <DataSet timestep={quoteattr(repr(float(t)))} part="0" file={quoteattr(name)}/>\n'
        for t, name in zip(time, names, strict=True)
    )
    return (
        '<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1" byte_order="LittleEndian">\n'
        f" <Collection>\n{frames} </Collection>\n</VTKFile>\n"
    )
