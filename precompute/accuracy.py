"""What the reduction costs: the responses of the reduced model against those of the full one."""

from collections.abc import Sequence

import numpy as np

from fmu_src.runtime.model import ReducedModel

from .arrays import Floats
from .certificate import ONE_PERCENT, Certificate, Comparison, holds_to
from .frequency_samples import UNDAMPED, samples
from .full_model import FullModel
from .full_response import Reference
from .oscillators import Complexes, Oscillators, oscillators_of, resonances
from .reference_error import NOTHING, peaks, reference_error, to_peak
from .system import System
from .transfer import Block, blocks_of, norms, transfer

BAND = 1.5  # the highest mode kept lies this much above the default band


def default_band(frequencies: Floats) -> tuple[float, float] | None:
    """0 to the highest frequency kept (Hz) / 1.5; none without elastic modes.

    There a mode beyond acts mostly by its static part, of which ω²/λ < 0.44 is missing.
    """
    highest = float(np.max(frequencies, initial=0.0))
    return (0.0, highest / BAND) if highest > 0 else None


def captured_mass(system: System, Phi: Floats) -> Floats:
    """Σᵢ (rᵀMφᵢ)² / rᵀMr for the translations r in x, y, z: (3,), NaN where nothing moves so.

    Phi: (n, r), ΦᵀMΦ = I.
    """
    r = system.rigid[:, :3]
    mass = np.sum(r * (system.M @ r), axis=0)
    moved = np.sum((r.T @ (system.M @ Phi)) ** 2, axis=1)
    return np.asarray(np.divide(moved, mass, out=np.full(3, np.nan), where=mass > 0))


def certify(reference: Reference, model: ReducedModel, captured: Floats, tolerance: float) -> Certificate:
    """The reduced model against the full model over the reference's band, sampled at the resonances of both.

    captured: (3,) of `captured_mass`. Velocities carry R u̇, which a master that holds its inputs does not
    see.
    """
    full, system = reference.full, oscillators_of(model)
    swings, zeta = full.resonances
    low, high = reference.band
    undamped = int(np.sum((zeta < UNDAMPED) & (swings >= low) & (swings <= high)))
    frequency = samples(reference.band, *np.concatenate([[swings, zeta], resonances(system)], axis=1))
    omega, blocks = 2 * np.pi * frequency, blocks_of(full.ports)
    if not blocks:
        return Certificate(
            frequency, reference.asked, reference.band, tolerance, (), captured, 0, 0.0, 0.0, 0
        )
    proved_to = holds_to(frequency, np.where(full.proved(omega), 0.0, 1.0), 0.5)
    H = transfer(full.oscillators, full.lines, omega)
    H_r = transfer(system, full.lines, omega)
    doubt, peak = reference_error(full, blocks, omega), peaks(full, blocks, omega)
    error = to_peak(np.array([norms(H - H_r, block) for block in blocks]) + doubt, peak)
    compared = (
        _comparison(full, system, block, frequency, H, H_r, error[k], float(peak[k]))
        for k, block in enumerate(blocks)
    )
    return Certificate(
        frequency, reference.asked, reference.band, tolerance, tuple(compared), captured, full.trial.shape[1],
        float(np.max(to_peak(doubt, peak))), proved_to, undamped,
    )  # fmt: skip  # as few lines as it needs


def _comparison(
    full: FullModel,
    system: Oscillators,
    block: Block,
    frequency: Floats,
    H: Complexes,
    H_r: Complexes,
    error: Floats,
    peak: float,
) -> Comparison:
    """Of one block, error (f,) and peak of it; H, H_r: (f, p, n_u) of all."""
    worst = int(np.argmax(error))
    deviation = np.abs(H - H_r)[worst][block.lines[:, None], block.columns]
    i, j = np.unravel_index(np.argmax(deviation), deviation.shape)
    line, column = block.lines[i], block.columns[j]
    inputs = [f"{port.name}.{key}" for port in full.ports for key in port.inputs]
    return Comparison(
        output=block.output,
        input=block.input,
        unit=block.unit,
        error=error,
        peak=peak,
        static=static_error(full, system, block),
        holds_to=holds_to(frequency, error, ONE_PERCENT),
        worst_frequency=float(frequency[worst]),
        pair=(full.lines.names[line], inputs[column]),
        deviation=float(deviation[i, j]),
        size=float(np.abs(H[worst, line, column])),
    )


def static_error(full: FullModel, system: Oscillators, block: Block) -> float | None:
    """‖H(0) − H_r(0)‖₂ / ‖H(0)‖₂ of the elastic body; none for what is no position or does not respond."""
    if any(full.lines.laws[line] != "position" for line in block.lines):
        return None
    rows, columns = full.lines.rows[block.lines][:, None], block.columns
    elastic = system.k > 0
    own = system.C[:, elastic] @ (system.B[elastic] / system.k[elastic, None]) + system.R
    whole = full.static_response + full.direct
    size = float(np.linalg.norm(whole[rows, columns], 2))
    reach, load = full.static_sizes
    if size <= NOTHING * np.max(reach[rows]) * np.max(load[columns]):
        return None
    return float(np.linalg.norm((whole - own)[rows, columns], 2)) / size


def errors(
    full: FullModel, system: Oscillators, blocks: Sequence[Block], omega: Floats, H: Complexes, peak: Floats
) -> Floats:
    """error(f) of each block, without the reference's own: (blocks, f).

    H: (f, p, n_u) of the full model at omega (f,); peak: (blocks,).
    """
    E = H - transfer(system, full.lines, omega)
    return to_peak(np.array([norms(E, block) for block in blocks]), peak)
