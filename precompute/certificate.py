"""What a certificate of accuracy states."""

from dataclasses import dataclass

import numpy as np

from .arrays import Floats

ONE_PERCENT = 0.01


def percent(share: float) -> str:
    """To be read: 0.05 %, 12.3 %, 1200 %."""
    return f"{100 * share:.0f} %" if share >= 1 else f"{100 * share:.3g} %"


@dataclass(frozen=True, eq=False)  # arrays have no one truth value
class Comparison:
    """error(f) = ‖H(f) − H_r(f)‖₂ / max ‖H‖₂ over the band, of all inputs of one kind to outputs of one kind.

    output, input: the kinds, with their unit; error: (f,), the reference's own error included; peak: max ‖H‖₂
    in that unit; static: the error at rest relative to the static response, none for what has none;
    holds_to: Hz, the last sample up to which 1 % is not exceeded, 0 where the first one exceeds it;
    worst_frequency in Hz, pair: the output and the input with the largest deviation there, deviation: its
    size, size: that of the full model's response between them, both in the unit.
    """

    output: str
    input: str
    unit: str
    error: Floats
    peak: float
    static: float | None
    holds_to: float
    worst_frequency: float
    pair: tuple[str, str]
    deviation: float
    size: float

    @property
    def largest(self) -> float:
        """The largest error found."""
        return float(np.max(self.error))


@dataclass(frozen=True, eq=False)
class Certificate:
    """How far the reduced model is from the full one, port to port.

    frequency: (f,) Hz, the samples, close at the resonances; asked, band: Hz, the band asked for and what
    of it elastic motion governs, where the part can move as a rigid body too; tolerance: what is asked for;
    comparisons: one for each pair of kinds, none where there is no input or no output; captured: (3,) the
    share of the mass that the modes move in x, y, z, NaN where nothing can move; vectors: Krylov vectors
    beside the known modes; reference_error: of the full model's responses, relative to their peaks, a bound
    at every sample up to proved_to (Hz) and an estimate beyond; undamped: how many resonances of the band
    have no damping, whose peaks the samples leave out. Between the samples nothing is proved.
    """

    frequency: Floats
    asked: tuple[float, float]
    band: tuple[float, float]
    tolerance: float
    comparisons: tuple[Comparison, ...]
    captured: Floats
    vectors: int
    reference_error: float
    proved_to: float
    undamped: int

    @property
    def worst(self) -> Comparison | None:
        """Where the largest error was found."""
        return max(self.comparisons, key=lambda comparison: comparison.largest, default=None)

    @property
    def largest(self) -> float:
        """The largest error found in any pair of kinds."""
        return max((comparison.largest for comparison in self.comparisons), default=0.0)

    def holds_to(self, error: float) -> float:
        """The last sample in Hz up to which no kind exceeds this error; 0 where the first one does."""
        largest = np.max([c.error for c in self.comparisons], axis=0, initial=0.0)
        return holds_to(self.frequency, np.broadcast_to(largest, self.frequency.shape), error)

    @property
    def kept(self) -> bool:
        """Whether the tolerance is kept at every sample."""
        return self.largest <= self.tolerance


def holds_to(frequency: Floats, error: Floats, level: float) -> float:
    """The last frequency before the first error above the level, 0 where that is the first one."""
    exceeded = np.flatnonzero(error > level)
    first = exceeded[0] if len(exceeded) else len(frequency)
    return float(frequency[first - 1]) if first else 0.0
