"""Units of imported matrices that are legal but improbable: one warning, not an error."""

import numpy as np

from .arrays import Floats
from .dofs import Dofs
from .notice import warning
from .system import System

DENSITIES = (0.1, 3e4)  # kg/m³ of the box around the part: a truss … osmium
SPEEDS = (20.0, 1e6)  # m/s, of waves across a cell: soft foam 30, steel 5000, diamond 18 000
MASSES = (1e-12, 1e8)  # kg
FREQUENCIES = (0.1, 1e13)  # Hz, of the stiffest degree of freedom


def doubt_units(system: System, dofs: Dofs, points: Floats) -> None:
    """Warn where mass per volume and speed of waves are those of no part; points: (k, 3) m, NaN if unknown.

    Without coordinates the mass and the stiffest ω² = K_ii/M_ii have to do; without translations, nothing.
    """
    T = system.rigid[:, :3]
    if not T.any():
        return
    mass = float(np.max(np.sum(T * (system.M @ T), axis=0)))
    stiff, omega = _stiffest(system, dofs)
    if np.isfinite(points).all():
        volume = float(np.prod(np.ptp(points, axis=0)))
        _doubt(
            "mass per volume of the surrounding box", mass / volume if volume else None, DENSITIES, "kg/m³"
        )
        h = _distance(system, dofs, points, stiff)
        _doubt("speed of waves across a cell", omega * h if h else None, SPEEDS, "m/s")
    else:
        _doubt("mass", mass, MASSES, "kg")
        _doubt("highest frequency", omega / (2 * np.pi), FREQUENCIES, "Hz")


def _stiffest(system: System, dofs: Dofs) -> tuple[int, float]:
    """The translation with the largest ω² = K_ii/M_ii, and ω in rad/s."""
    K, M = system.K.diagonal(), system.M.diagonal()
    square = np.where((M > 0) & (dofs.direction < 3), K / np.where(M > 0, M, 1.0), 0.0)
    i = int(np.argmax(square))
    return i, float(np.sqrt(square[i]))


def _distance(system: System, dofs: Dofs, points: Floats, i: int) -> float:
    """From DOF i's node to the nearest one that K couples it to; 0 where there is none."""
    coupled = system.K.indices[system.K.indptr[i] : system.K.indptr[i + 1]]
    away = np.linalg.norm(points[dofs.node[coupled]] - points[dofs.node[i]], axis=1)
    return float(np.min(away[away > 0], initial=np.inf)) if np.any(away > 0) else 0.0


def _doubt(what: str, value: float | None, usual: tuple[float, float], unit: str) -> None:
    if value is not None and not usual[0] <= value <= usual[1]:
        warning(
            f"{what}: {value:.3g} {unit} is outside {usual[0]:g} to {usual[1]:g}; are the units of [system] "
            "right, and stiffness and mass not exchanged?"
        )
