"""At which frequencies responses are compared: over the whole band, closest at the resonances."""

import numpy as np

from .arrays import Floats
from .errors import ModalFmuError

EVEN = 60  # samples over the band, in equal steps
DECADES = 3  # below its end that are sampled in equal ratios too
RATIOS = 40  # … by this many samples
AROUND = np.array([-8.0, -3.0, -1.0, -0.4, 0.0, 0.4, 1.0, 3.0, 8.0])  # half-widths about a resonance
SHARPEST = 1e-3  # ζ: narrower resonances are sampled as if they were this wide …
UNDAMPED = 1e-9  # … and below this ζ not at their peaks, which have no bound
UNSEEN = 0.2 * SHARPEST  # of an undamped resonance: no sample lies so near
ASIDE = 0.382  # of the way to the next sample: never at one, nor in the middle between two


def samples(band: tuple[float, float], resonances: Floats, zeta: Floats) -> Floats:
    """Frequencies > 0 in Hz within the band, ascending; resonances (k,) in Hz, zeta (k,) damping ratios.

    Raises ModalFmuError: the band is no wider than what is left out about an undamped resonance.
    """
    low, high = band
    even = np.linspace(low, high, EVEN + 1)
    ratios = np.geomspace(max(low, high * 10.0**-DECADES), high, RATIOS)
    width = resonances * np.maximum(zeta, SHARPEST)
    near = (resonances + width * AROUND[:, None]).ravel()
    found = np.unique(np.concatenate([even, ratios, near[(near >= low) & (near <= high)]]))
    endless = resonances[zeta < UNDAMPED]
    aside = np.abs(found[:, None] - endless) > UNSEEN * endless
    found = found[(found > 0) & aside.all(axis=1)]
    if not len(found):
        raise ModalFmuError(
            f"band: got {low:.6g} to {high:.6g} Hz, all of it at an undamped resonance, whose peak has no "
            "bound; expected a wider band, or damping"
        )
    return np.asarray(found)


def between(frequencies: Floats) -> Floats:
    """One frequency in every gap of the given ones: none that was looked at before."""
    return frequencies[:-1] + ASIDE * np.diff(frequencies)


def elastic_band(band: tuple[float, float], rigid: bool, first: float) -> tuple[float, float]:
    """The band; with rigid modes from half the `first` elastic resonance (Hz) or half the band's end on.

    Below, the rigid motion grows as 1/f² and would hide every elastic error behind its size.
    """
    low, high = band
    return (max(low, 0.5 * min(first, high)), high) if rigid else band
