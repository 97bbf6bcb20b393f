"""How much each mode matters between the ports, for people who choose by hand."""

from collections.abc import Sequence

import numpy as np

from fmu_src.runtime.model import Port

from .arrays import Floats
from .frequency_samples import SHARPEST
from .oscillators import Oscillators
from .transfer import blocks_of, lines_of, measured


def dominance(system: Oscillators, ports: Sequence[Port]) -> Floats:
    """The largest peak of each elastic mode among those of its kind of output and input, (r,) in 0 … 1.

    Alone, mode i answers at its resonance with ‖C_i‖ ‖B_i‖ ωᵢᵖ / (2 ζᵢ ωᵢ²), p = 0, 1, 2 for displacements,
    velocities and accelerations; ζᵢ < 0.1 % counts as 0.1 %. Each peak is relative to the highest of its
    kind, and the largest over all kinds is the mode's dominance. NaN for rigid modes, which have no peak.
    system: mass-normalised, m = 1.
    Source: Gawronski, Advanced Structural Dynamics and Active Control of Structures (2004), the H∞ norm of a
    mode.
    """
    found = np.where(system.k > 0, 0.0, np.nan)
    elastic = np.flatnonzero(system.k > 0)
    omega = np.sqrt(system.k[elastic])
    zeta = np.maximum(np.diag(system.D)[elastic] / (2 * omega), SHARPEST)
    shape = system.C.T[elastic, :, None].astype(complex)
    moved = measured(lines_of(ports), shape, np.zeros((len(system.C), 1)), system.alpha, omega)[:, :, 0]
    for block in blocks_of(ports):
        driven = np.linalg.norm(system.B[elastic][:, block.columns], axis=1)
        peak = np.linalg.norm(moved[:, block.lines], axis=1) * driven / (2 * zeta * omega**2)
        highest = np.max(peak, initial=0.0)
        if highest > 0:
            found[elastic] = np.maximum(found[elastic], peak / highest)
    return found
