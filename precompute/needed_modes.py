"""Which of the exact modes a reduced model needs to stay within an error."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np

from .accuracy import errors
from .arrays import Bools, Floats, Ints
from .candidates import candidate, no_more, residual_vectors
from .dominance import dominance
from .frequency_samples import between, samples
from .full_model import FullModel
from .full_response import Reference
from .oscillators import Complexes, Oscillators, resonances
from .reference_error import peaks
from .transfer import blocks_of, transfer

Residual: TypeAlias = bool | Literal["modes"]

SAFE = 0.95  # of the error asked for, where modes are chosen; what lies between may reach all of it
VERIFICATIONS = 5


@dataclass(frozen=True, eq=False)  # arrays have no one truth value
class Yardstick:
    """Ĥ of the full model at ω (f,), and the peaks of its blocks that errors are relative to."""

    full: FullModel
    omega: Floats
    H: Complexes
    peak: Floats

    def error(self, system: Oscillators) -> float:
        """The largest error of a reduced model at any of the frequencies."""
        blocks = blocks_of(self.full.ports)
        return float(np.max(errors(self.full, system, blocks, self.omega, self.H, self.peak), initial=0.0))


def yardstick(full: FullModel, frequency: Floats, peak: Floats | None = None) -> Yardstick:
    """At frequencies in Hz; peak: of the band, those at the frequencies where it is left out."""
    omega = 2 * np.pi * frequency
    if peak is None:
        peak = peaks(full, blocks_of(full.ports), omega)
    return Yardstick(full, omega, transfer(full.oscillators, full.lines, omega), peak)


def reduced(full: FullModel, keep: Bools, residual: Residual) -> Oscillators:
    """The reduced model of the exact modes `keep` with what `residual` adds."""
    more = residual_vectors(full, keep) if residual == "modes" else no_more(full)
    return candidate(full, keep, more, feed_through=residual is True)


def needed_modes(reference: Reference, error: float, residual: Residual) -> Bools | None:
    """Few of the exact modes (r,) that keep the error over the band; none where all of them do not.

    Rigid modes, and the most dominant one where there is none, stay. Chosen at the samples of the reference,
    verified at others between them and at the resonances of the model chosen.
    """
    full = reference.full
    everything = np.ones(len(full.lam), dtype=bool)
    frequency, room = reference.frequencies, error - reference.error
    for _ in range(VERIFICATIONS):
        against = yardstick(full, frequency)

        def meets(keep: Bools, against: Yardstick = against) -> bool:
            return against.error(reduced(full, keep, residual)) <= SAFE * room

        if not meets(everything):
            return None
        keep = _fewest(_by_dominance(full), everything, meets)
        system = reduced(full, keep, residual)
        other = np.union1d(between(frequency), samples(reference.band, *resonances(system)))
        if yardstick(full, other, against.peak).error(system) <= room:
            return keep
        frequency = np.union1d(frequency, other)
    return None


def _by_dominance(full: FullModel) -> Ints:
    """The elastic exact modes that may be dropped, the least dominant first."""
    lam, D = full.lam, full.D
    exact = Oscillators(lam, np.ones_like(lam), D, full.B, full.C, full.direct, full.alpha)
    order = np.argsort(dominance(exact, full.ports), kind="stable")
    elastic = order[lam[order] > 0]
    return elastic if len(elastic) < len(lam) else elastic[:-1]


def _fewest(order: Ints, everything: Bools, meets: Callable[[Bools], bool]) -> Bools:
    """Without as many of the first of `order` as bisection finds, then without each further one on trial."""

    def without(dropped: Ints) -> Bools:
        keep = everything.copy()
        keep[dropped] = False
        return keep

    low, high = 0, len(order)
    while low < high:
        middle = (low + high + 1) // 2
        low, high = (middle, high) if meets(without(order[:middle])) else (low, middle - 1)
    dropped = order[:low]
    for mode in order[low:]:
        further = np.append(dropped, mode)
        if meets(without(further)):
            dropped = further
    return without(dropped)
