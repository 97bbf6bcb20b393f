"""Modal damping D̃ = αI + βΛ + D_rest, so that dᵢ = α + β λᵢ + D_rest,ᵢᵢ at unit modal mass [2.28].

λᵢ in 1/s² with exactly 0 for rigid modes, ωᵢ = √λᵢ in rad/s, ζᵢ = dᵢ/(2ωᵢ).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csr_array

from .arrays import Floats
from .coupled_damping import projected_damping
from .damping_table import DampingForm
from .errors import ModalFmuError
from .mode_ratios import table_ratios
from .notice import notice
from .rayleigh_fit import fit_ratios


@dataclass(frozen=True, eq=False)  # arrays have no one truth value
class Damping:
    """D̃ = αI + βΛ + D_rest; alpha in 1/s, beta in s, D_rest (r, r) in 1/s.

    ratio: ζ of the modes that are not kept, beside α and β (see `rule`).
    Raises ModalFmuError where α, β or the ratio is no finite number ≥ 0 or D_rest is not square, finite,
    symmetric and ≥ 0 on its diagonal (which x'D_rest x ≥ 0 needs).
    """

    alpha: float
    beta: float
    D_rest: Floats
    ratio: float = 0.0

    def __post_init__(self) -> None:
        if not (0 <= self.alpha < np.inf and 0 <= self.beta < np.inf and 0 <= self.ratio < np.inf):
            raise ModalFmuError(
                f"damping: got alpha = {self.alpha}, beta = {self.beta}, ratio = {self.ratio}, "
                "expected finite numbers ≥ 0"
            )
        D = self.D_rest
        square = D.ndim == 2 and D.shape[0] == D.shape[1]
        if not (square and np.isfinite(D).all() and (D == D.T).all() and (np.diag(D) >= 0).all()):
            raise ModalFmuError(
                f"damping: got D_rest {D.shape} or numbers in it that cannot be, expected (r, r), all "
                "finite, symmetric, none on the diagonal below 0"
            )

    def rule(self, lam: Floats) -> Floats:
        """d(λ) = α + βλ + 2ζ√λ in 1/s of modes that are not kept, ζ = `ratio`; lam and the result (k,).

        It is the part of the damping that [damping] gives; D and dashpots come on top of it.
        """
        return self.alpha + self.beta * lam + 2 * self.ratio * np.sqrt(lam)


def rayleigh(lam: Floats, alpha: float, beta: float) -> Damping:
    """D = αM + βK, so dᵢ = α + β λᵢ [2.28]; lam (r,), alpha in 1/s, beta in s."""
    return Damping(float(alpha), float(beta), np.zeros((len(lam), len(lam))))


def modal_ratio(lam: Floats, ratio: float) -> Damping:
    """dᵢ = 2ζωᵢ, one ζ = `ratio` for all modes and 0 for rigid ones, in the diagonal of D_rest."""
    return Damping(0.0, 0.0, np.diag(2 * ratio * np.sqrt(lam)), ratio)


def structural(lam: Floats, loss_factor: float) -> Damping:
    """dᵢ = η ωᵢ, ζ = η/2: at resonance it dissipates as K(1 + iη) does, π η λᵢ q² in a cycle of size q."""
    return modal_ratio(lam, loss_factor / 2)


def modal_table(lam: Floats, table: Sequence[tuple[int, float]]) -> Damping:
    """dᵢ = 2ζᵢωᵢ with a ratio per mode (see `table_ratios`); modes that are not kept take the last one."""
    zeta = table_ratios(lam, table)
    return Damping(0.0, 0.0, np.diag(2 * zeta * np.sqrt(lam)), max(table)[1])


def damping_of(
    form: DampingForm,
    lam: Floats,
    Phi: Floats,
    D: csr_array | None = None,
    dashpots: Sequence[tuple[csr_array, float]] = (),
    shared: tuple[float, float] = (0.0, 0.0),
) -> Damping:
    """All damping of a part: what [damping] asks for, α and β of the whole body, D and dashpots.

    lam (r,), Phi (n, r); D (n, n) in N·s/m, damping that no α, β describe; dashpots: w (1, n) and c each;
    shared: α and β that come with the materials or the matrices, and add to those of the form.
    α damps rigid modes too, like a motion through a viscous medium: a notice says so.
    Raises ModalFmuError: a table that names a mode not kept or rigid, D that is not symmetric ≥ 0.
    """
    modal = _modal_damping(form, lam)
    alpha, rigid = modal.alpha + shared[0], int(np.sum(lam == 0))
    if alpha > 0 and rigid:
        notice(f"damping: alpha = {alpha:.4g} 1/s damps the {rigid} rigid modes too; beta alone does not")
    rest = modal.D_rest + projected_damping(lam, Phi, D, dashpots)
    return replace(modal, alpha=alpha, beta=modal.beta + shared[1], D_rest=rest)


def _modal_damping(form: DampingForm, lam: Floats) -> Damping:
    if form.ratio is not None:
        return modal_ratio(lam, form.ratio)
    if form.ratios is not None:
        return rayleigh(lam, *fit_ratios(form.ratios))
    if form.table is not None:
        return modal_table(lam, form.table)
    if form.structural is not None:
        return structural(lam, form.structural)
    return rayleigh(lam, form.alpha, form.beta)
