"""Modal damping D̃ = αI + βΛ + D_rest, so that dᵢ = α + β λᵢ + D_rest,ᵢᵢ at unit modal mass [2.28].

λᵢ in 1/s² with exactly 0 for rigid modes, ωᵢ = √λᵢ in rad/s, ζᵢ = dᵢ/(2ωᵢ).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import nnls

from .arrays import Floats
from .errors import ModalFmuError
from .notice import notice, warning
from .part_tables import DampingForm

MISS = 0.1  # of the ratio asked for; a fit that misses more is worth a warning


@dataclass(frozen=True)
class Damping:
    """D̃ = αI + βΛ + D_rest; alpha in 1/s, beta in s, D_rest (r, r) in 1/s.

    Raises ModalFmuError where α or β is no finite number ≥ 0 or D_rest is not square, finite
    and ≥ 0 on its diagonal (which x'D_rest x ≥ 0 needs).
    """

    alpha: float
    beta: float
    D_rest: Floats

    def __post_init__(self) -> None:
        if not (0 <= self.alpha < np.inf and 0 <= self.beta < np.inf):
            raise ModalFmuError(
                f"damping: got alpha = {self.alpha}, beta = {self.beta}, expected finite numbers ≥ 0"
            )
        shape = self.D_rest.shape
        square = len(shape) == 2 and shape[0] == shape[1]
        if not (square and np.isfinite(self.D_rest).all() and (np.diag(self.D_rest) >= 0).all()):
            raise ModalFmuError(
                f"damping: got D_rest {shape} or numbers in it that cannot be, expected (r, r), all finite, "
                "none on the diagonal below 0"
            )


def rayleigh(lam: Floats, alpha: float, beta: float) -> Damping:
    """D = αM + βK, so dᵢ = α + β λᵢ [2.28]; lam (r,), alpha in 1/s, beta in s.

    α damps rigid modes too, like a motion through a viscous medium: a notice says so.
    """
    rigid = int(np.sum(lam == 0))
    if alpha > 0 and rigid:
        notice(f"damping: alpha = {alpha:.4g} 1/s damps the {rigid} rigid modes too; beta alone does not")
    return Damping(float(alpha), float(beta), np.zeros((len(lam), len(lam))))


def modal_ratio(lam: Floats, ratio: float) -> Damping:
    """dᵢ = 2ζωᵢ, one ζ = `ratio` for all modes and 0 for rigid ones, in the diagonal of D_rest."""
    return Damping(0.0, 0.0, np.diag(2 * ratio * np.sqrt(lam)))


def fit_ratios(lam: Floats, pairs: Sequence[tuple[float, float]]) -> Damping:
    """α, β ≥ 0 that minimise Σₖ (ζ(ωₖ) − ζₖ)², with ζ(ω) = α/(2ω) + βω/2.

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
    return rayleigh(lam, 2 * middle * a, 2 * b / middle)


def damping_of(form: DampingForm, lam: Floats) -> Damping:
    """The damping that [damping] of a part file asks for, of the modes lam (r,)."""
    if form.ratio is not None:
        return modal_ratio(lam, form.ratio)
    if form.ratios is not None:
        return fit_ratios(lam, form.ratios)
    return rayleigh(lam, form.alpha, form.beta)
