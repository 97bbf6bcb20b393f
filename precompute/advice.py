"""What to change where a reduced model misses the accuracy asked for."""

from collections.abc import Iterator

import numpy as np

from .candidates import MoreVectors, candidate, residual_vectors, ritz_vectors
from .certificate import Certificate, percent
from .frequency_samples import samples
from .full_response import Reference
from .needed_modes import SAFE, Residual, Yardstick, reduced, yardstick
from .oscillators import Oscillators, resonances
from .transfer import blocks_of, norms

CONVERGED = 0.1  # relative residual of a Ritz vector; that of its eigenvalue is the square of it
MARGIN = 1.01  # max_frequency lies this far above the mode that it is to include
DIGITS = 1e-6  # of a frequency, as it is written


def advice(
    reference: Reference, certificate: Certificate, residual: Residual, *, modal: bool = True
) -> str | None:
    """One line on the largest error, and changes of the part file that mend it, with the error they leave.

    None where the tolerance is kept. residual: what the part has now; modal: whether its basis is. The
    changes were tried on what is known of the full model; those of the modes are of a modal basis.
    """
    worst = certificate.worst
    if worst is None or certificate.kept:
        return None
    output, by = worst.pair
    found = (
        f"accuracy: got an error of {percent(worst.largest)} of the peak at {worst.worst_frequency:.4g} Hz "
        f"in {output} per {by}, expected at most {percent(certificate.tolerance)}"
    )
    against = yardstick(reference.full, certificate.frequency)
    basis = "" if modal else '[basis] kind = "modal", '
    changes = [
        f"{basis}[modes] {keys}" for keys in _of_the_modes(against, certificate.tolerance, residual, modal)
    ]
    end = _end_of_band(against, certificate)
    if not changes and end is not None:
        changes = [f"an [accuracy] band that ends at {end:.6g} Hz, up to which it is kept"]
    more = "keep more modes" if modal else 'write [basis] kind = "modal"'
    return f"{found}; {'write ' + ' or '.join(changes) if changes else more}"


def _of_the_modes(against: Yardstick, tolerance: float, residual: Residual, modal: bool) -> Iterator[str]:
    """More modes, residual vectors beside those that there are, or both where neither alone does."""
    alone = _more_modes(against, tolerance, residual)
    if alone is not None:
        yield alone
    if residual == "modes":
        return
    full = against.full
    error = _error(against, reduced(full, np.ones(len(full.lam), dtype=bool), "modes"))
    if modal and error <= tolerance:
        yield f'residual = "modes" (leaves {percent(error)})'
    elif alone is None:
        both = _more_modes(against, tolerance, "modes")
        if both is not None:
            yield f'residual = "modes" and {both}'


def _more_modes(against: Yardstick, tolerance: float, residual: Residual) -> str | None:
    """The lowest frequency up to which all modes do, exact ones and those the ports have shown beyond them.

    Only as far as these are modes: (K⁺M − μ) v of a Ritz vector is to be small against μ v in strain energy.
    """
    full = against.full
    more = ritz_vectors(full)
    left = np.linalg.norm(full.off_trial(full.M @ more.y), axis=0) * more.lam / np.linalg.norm(more.y, axis=0)
    modes = int(np.argmin(np.append(left <= CONVERGED, False)))
    keep = np.ones(len(full.lam), dtype=bool)
    for j in range(1, modes + 1):
        first = MoreVectors(more.lam[:j], more.phi[:, :j], more.y[:, :j])
        if residual == "modes":
            first = residual_vectors(full, keep, first)
        error = _error(against, candidate(full, keep, first, feed_through=residual is True))
        if error <= SAFE * tolerance:
            frequency = MARGIN * np.sqrt(more.lam[j - 1]) / (2 * np.pi)
            return f"max_frequency = {frequency:.4g} (leaves about {percent(error)})"
    return None


def _error(against: Yardstick, system: Oscillators) -> float:
    """At the frequencies of the certificate, and at the resonances that a reduced model has instead."""
    frequency = against.omega / (2 * np.pi)
    own = samples((frequency[0], frequency[-1]), *resonances(system))
    return max(against.error(system), yardstick(against.full, own, against.peak).error(system))


def _end_of_band(against: Yardstick, certificate: Certificate) -> float | None:
    """The highest sample in Hz up to which the error is kept, relative to the peaks up to there."""
    blocks = blocks_of(against.full.ports)
    size = np.maximum.accumulate([norms(against.H, block) for block in blocks], axis=1)
    peak = against.peak[:, None]
    error = np.maximum.accumulate([c.error * c.peak for c in certificate.comparisons], axis=1)
    kept = (error <= certificate.tolerance * np.where(size[:, -1:] < peak, peak, size)).all(axis=0)
    met = certificate.frequency[kept & (certificate.frequency > certificate.band[0])]
    return float(met[-1]) * (1 - DIGITS) if len(met) else None
