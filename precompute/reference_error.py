"""How far the responses that a reduced model is held against are from those of the full model."""

from collections.abc import Sequence

import numpy as np

from .arrays import Bools, Floats
from .full_model import FullModel
from .transfer import Block, blocks_of, measured, norms, spectral_norms, transfer

NOTHING = 1e-7  # of what no response exceeds: less is rounding
CHUNK = 64  # frequencies at once


def reference_error(full: FullModel, blocks: Sequence[Block], omega: Floats) -> Floats:
    """A bound of ‖H(ω) − Ĥ(ω)‖₂ for each block, (blocks, f), in its unit; Ĥ of the Galerkin solution.

    With the unbalanced forces r_b of the inputs and r_c of the measured rows, c A⁻¹ b − Ĥ = r_cᵀ A⁻¹ r_b, and
    ‖r_cᵀ A⁻¹ r_b‖ ≤ ‖r_c‖ ‖r_b‖ / s in the norm of K⁻¹ where |x*Ax| ≥ s x*Kx for all that they can move
    (`FullModel.stiffness`). Where that is not `proved`, it is an estimate. Blocks that do not respond have
    none.
    Source: Pierce and Giles, SIAM Review 42 (2000) 247–264, the adjoint error of Galerkin solutions.
    """
    found = []
    for part in np.array_split(omega, range(CHUNK, len(omega), CHUNK)):
        rows, inputs = full.unbalanced(part)
        left = np.array([spectral_norms(rows[:, block.lines]) for block in blocks])
        right = np.array([spectral_norms(inputs[:, :, block.columns]) for block in blocks])
        found.append(full.amplification(part) * left * right)
    return np.concatenate(found, axis=1) * _heard(full, blocks, omega)[:, None]


def peaks(full: FullModel, blocks: Sequence[Block], omega: Floats) -> Floats:
    """max ‖Ĥ‖₂ over ω of each block, (blocks,), in its unit; the level of rounding where that is higher."""
    H = transfer(full.oscillators, full.lines, omega)
    return np.maximum([np.max(norms(H, block)) for block in blocks], _rounding(full, blocks, omega))


def _rounding(full: FullModel, blocks: Sequence[Block], omega: Floats) -> Floats:
    """The level of rounding of each block, (blocks,), in its unit.

    |Ĥ| = |Σ cᵢbᵢ/zᵢ| ≤ √(Σ cᵢ²/|zᵢ|) √(Σ bᵢ²/|zᵢ|) with zᵢ = kᵢ − ω²mᵢ + iωDᵢᵢ, kᵢ beyond the Ritz vectors:
    what is NOTHING against the peaks of both factors has cancelled, as a force and a motion at right angles
    do.
    """
    system, w = full.oscillators, omega[:, None]
    z = np.abs(system.k - w**2 * system.m + 1j * w * np.diag(system.D))
    order = np.array([{"position": 0, "velocity": 1}.get(law, 2) for law in full.lines.laws])
    C, B = full.off_trial(full.C_y.T)[:, full.lines.rows], full.off_trial(full.B_y)
    rows = np.sqrt((1 / z) @ (system.C[full.lines.rows] ** 2).T + np.sum(C**2, axis=0))
    inputs = np.sqrt((1 / z) @ system.B**2 + np.sum(B**2, axis=0))
    rows, inputs = np.max(rows * w**order, axis=0), np.max(inputs, axis=0)
    return np.array([NOTHING * np.max(rows[b.lines]) * np.max(inputs[b.columns]) for b in blocks])


def _heard(full: FullModel, blocks: Sequence[Block], omega: Floats) -> Bools:
    """Which blocks respond at all, (blocks,), by exact modes and Ritz vectors or by the static response."""
    still = np.broadcast_to(full.static_response, (len(omega), *full.static_response.shape)).astype(complex)
    found = (
        transfer(full.oscillators, full.lines, omega),
        measured(full.lines, still, full.direct, full.alpha, omega),
    )
    level = _rounding(full, blocks, omega)
    return np.array([max(np.max(norms(H, b)) for H in found) for b in blocks]) > level


def to_peak(error: Floats, peak: Floats) -> Floats:
    """Errors (blocks, f) relative to the peaks (blocks,); 0 of a block that is 0 throughout."""
    whole = np.broadcast_to(peak[:, None], error.shape)
    return np.asarray(np.divide(error, whole, out=np.zeros_like(error), where=whole > 0))


def relative_error(full: FullModel, omega: Floats) -> float:
    """The largest `reference_error` over ω and blocks, relative to the peaks."""
    blocks = blocks_of(full.ports)
    if not blocks or not len(omega):
        return 0.0
    return float(np.max(to_peak(reference_error(full, blocks, omega), peaks(full, blocks, omega))))
