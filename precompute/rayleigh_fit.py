"""α and β of Rayleigh damping from ratios at given frequencies."""

from collections.abc import Sequence

import numpy as np
from scipy.optimize import nnls

from .errors import ModalFmuError
from .notice import warning

MISS = 0.1  # of the ratio asked for; a fit that misses more is worth a warning


def fit_ratios(pairs: Sequence[tuple[float, float]]) -> tuple[float, float]:
    """α (1/s), β (s) ≥ 0 that minimise Σₖ (ζ(ωₖ) − ζₖ)², with ζ(ω) = α/(2ω) + βω/2.

    pairs: two or more (frequency in Hz, ζ). Two are met exactly where the two equations have a
    solution with α, β ≥ 0; a warning tells what is achieved where α, β ≥ 0 binds or a ratio is missed by
    more than 10 %. Raises ModalFmuError for fewer than two distinct frequencies > 0.

    Caughey, Classical normal modes in damped linear dynamic systems, J. Appl. Mech. 27 (1960) 269–271:
    αM + βK are the first two terms of his series.
    """
    frequency, zeta = np.array(pairs, dtype=float).reshape(-1, 2).T
    if len(np.unique(frequency)) < 2 or not (frequency > 0).all():
        raise ModalFmuError(
            f"damping: got ratios at {frequency.tolist()} Hz, expected two or more distinct frequencies > 0"
        )
    omega = 2 * np.pi * frequency
    middle = np.exp(np.mean(np.log(omega)))
    # In units of α/(2ω̄) and βω̄/2 both columns are of one size, which α and β are not.
    A = np.column_stack([middle / omega, omega / middle])
    a, b = nnls(A, zeta)[0]
    achieved = A @ (a, b)
    free = np.linalg.lstsq(A, zeta, rcond=None)[0]
    binds = free.min() < -1e-9 * np.abs(free).max()  # not for a zero that came out as −rounding
    if binds or (np.abs(achieved - zeta) > MISS * zeta).any():
        warning(
            "damping: got ratios that no alpha, beta ≥ 0 meet, expected ζ(ω) = α/(2ω) + βω/2; achieved "
            + ", ".join(
                f"{z:.4g} (asked {asked:.4g}) at {f:.4g} Hz"
                for f, asked, z in zip(frequency, zeta, achieved, strict=True)
            )
        )
    return float(2 * middle * a), float(2 * b / middle)
