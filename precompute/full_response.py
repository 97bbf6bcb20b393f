"""The full model's responses from one static factor: a block Krylov space shared by all frequencies."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csc_array

from .arrays import Floats
from .damping import Damping
from .energy_basis import Deflation, EnergyBasis
from .extra_damping import Dashpots, ExtraDamping
from .frequency_samples import elastic_band, samples
from .full_model import FullModel
from .interface import Interface
from .known_modes import KnownModes, rigid_only
from .port_coordinates import bending_part, distinct_columns, enlarged, known_part
from .reference_error import CHUNK, relative_error
from .statics import StaticSolver

VECTORS = 200  # the Krylov space is not grown beyond them: each step costs their cube at every frequency
NEEDED = 1e-4  # of the largest: unbalanced motions of less energy wait for the next block
ROUNDING = 1e-24  # of the static energy: what is unbalanced below it is rounding


@dataclass(frozen=True)
class Reference:
    """The full model at its ports.

    asked: the band in Hz that was asked for; band: what of it elastic motion governs (`elastic_band`);
    error: of the responses there, relative to their peaks.
    """

    full: FullModel
    asked: tuple[float, float]
    band: tuple[float, float]
    error: float

    @property
    def frequencies(self) -> Floats:
        """Samples of the band in Hz, close at the resonances."""
        return samples(self.band, *self.full.resonances)


def full_response(
    solve: StaticSolver,
    known: KnownModes,
    damping: Damping,
    interface: Interface,
    band: tuple[float, float],
    accuracy: float,
    dashpots: Dashpots = (),
) -> Reference:
    """H(ω) = c (K + iωD − ω²M)⁻¹ b over the band (Hz), to `accuracy` of its peak in every kind of quantity.

    Exact on the known modes; off them by Galerkin in the block Krylov space of K⁺M (and K⁺D, where D is a
    matrix of its own) from K⁺b, deflated against the known modes. The space serves all frequencies, for ω
    enters K(1 + iωβ) − (ω² − iωα)M only as a shift. Each block is spanned by what all frequencies of the band
    leave unbalanced. It grows from the inputs or from the measured rows, whichever are fewer, since the
    error is a product of what both leave. Where VECTORS are not enough, the error reached is told.

    damping: α, β and the ratio of modes that are not known; dashpots: their rows w (1, n) and c.
    Source: Bai, Applied Numerical Mathematics 43 (2002) 9–44, Krylov reduction; Saad, Yeung, Erhel and
    Guyomarc'h, SIAM J. Sci. Comput. 21 (2000) 1909–1926, deflation.
    """
    if np.sum(known.lam == 0) < solve.rigid.shape[1]:  # fewer modes than the body has rigid ones
        known = rigid_only(solve, dashpots)
    M, coupling = solve.system.M, ExtraDamping(solve.system.M.shape[0], solve.system.D, dashpots)
    deflation = Deflation(solve, known.Phi, M @ known.Phi)
    bending = bending_part(interface.b, solve)
    inputs, rows = distinct_columns(bending), distinct_columns(csc_array(interface.c.T))
    from_inputs = inputs.shape[1] <= rows.shape[1]

    full = known_part(known, damping, interface, bending, coupling)
    basis = EnergyBasis.empty(M.shape[0])
    loads = [inputs, rows, coupling.new(known.Phi), coupling.loads]
    while True:
        basis = basis.extended(np.column_stack(loads), deflation)
        full = enlarged(full, basis.Q, known.Phi, M, coupling, interface.c, bending)
        resonances, zeta = full.resonances
        within = elastic_band(band, bool((full.lam == 0).any()), min(resonances, default=band[1]))
        omega = 2 * np.pi * samples(within, resonances, zeta)
        error = relative_error(full, omega)
        new = _unbalanced(full, omega, from_inputs)
        if error <= accuracy or new.shape[1] == 0 or full.trial.shape[1] + new.shape[1] > VECTORS:
            return Reference(full, band, within, error)
        full = replace(full, trial=np.column_stack([full.trial, new]))
        V = basis.Q @ new
        loads = [M @ V, coupling.new(V)]


def _unbalanced(full: FullModel, omega: Floats, from_inputs: bool) -> Floats:
    """Directions (q, p) of most of what all frequencies leave unbalanced, orthonormal, off the trial space.

    Every load counts by what it leaves of its own static energy.
    """
    modal, load = (full.B, full.B_y) if from_inputs else (full.C.T, full.C_y.T)
    elastic = full.lam > 0
    energy = np.sum(modal[elastic] ** 2 / full.lam[elastic, None], axis=0) + np.sum(load**2, axis=0)
    weight = np.where(energy > 0, 1 / np.where(energy > 0, energy, 1.0), 0.0)
    gram = np.zeros((len(load), len(load)))
    for part in np.array_split(omega, range(CHUNK, len(omega), CHUNK)):
        left = full.remainder(part, modal, load)
        for half in (left.real, left.imag):
            flat = half.transpose(1, 0, 2).reshape(len(load), len(part) * load.shape[1])
            gram += (flat * np.tile(weight, len(part))) @ flat.T
    size, U = np.linalg.eigh(gram)
    U = U[:, size > max(NEEDED * np.max(size, initial=0.0), ROUNDING * len(omega))]
    U = U - full.trial @ (full.trial.T @ U)
    return np.linalg.qr(U)[0][:, ::-1]
