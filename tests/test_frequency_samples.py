"""Where responses are sampled."""

import numpy as np
import pytest

from precompute.arrays import Floats
from precompute.errors import ModalFmuError
from precompute.frequency_samples import between, elastic_band, samples

BAND = (20.0, 100.0)


def found(resonances: list[float], zeta: list[float], band: tuple[float, float] = BAND) -> Floats:
    return samples(band, np.array(resonances), np.array(zeta))


def test_it_covers_the_band_and_nothing_else() -> None:
    frequency = found([50.0, 300.0], [0.01, 0.01])
    assert frequency[0] == 20.0
    assert frequency[-1] == 100.0
    assert np.all(np.diff(frequency) > 0)
    assert np.max(np.diff(frequency)) <= 1.34  # 80 Hz in 60 steps


def test_resonances_have_their_half_power_points() -> None:
    """At f (1 ± ζ) the response is 3 dB below its peak; without the resonance nothing is there."""
    for point in (50.0, 50.0 * 0.99, 50.0 * 1.01):
        assert np.min(np.abs(found([50.0], [0.01]) - point)) <= 1e-12 * point
    assert np.min(np.abs(found([], []) - 50.0)) > 0.1


@pytest.mark.parametrize("resonance", [50.0, 60.0])
def test_the_endless_peak_of_an_undamped_mode_is_left_out(resonance: float) -> None:
    """60 Hz is a sample of the even ones too."""
    frequency = found([resonance], [0.0])
    nearest = np.min(np.abs(frequency - resonance)) / resonance
    assert 1e-4 < nearest < 5e-4
    assert resonance in found([resonance], [1e-6])


def test_a_band_at_an_undamped_resonance_has_no_samples() -> None:
    with pytest.raises(ModalFmuError, match=r"band: got 49\.9999 to 50\.0001 Hz, .* expected a wider band"):
        found([50.0], [0.0], (49.9999, 50.0001))


def test_zero_is_no_sample() -> None:
    assert found([], [], (0.0, 10.0))[0] > 0


def test_between_is_new_everywhere() -> None:
    frequency = found([50.0], [0.01])
    other = between(frequency)
    assert len(np.intersect1d(frequency, other)) == 0
    assert np.all((other > frequency[:-1]) & (other < frequency[1:]))


def test_the_band_of_elastic_motion() -> None:
    """Whole without rigid modes; from half the first resonance with them, or half the band below it."""
    assert elastic_band((0.0, 100.0), False, 30.0) == (0.0, 100.0)
    assert elastic_band((0.0, 100.0), True, 30.0) == (15.0, 100.0)
    assert elastic_band((40.0, 100.0), True, 30.0) == (40.0, 100.0)
    assert elastic_band((0.0, 100.0), True, 900.0) == (50.0, 100.0)
