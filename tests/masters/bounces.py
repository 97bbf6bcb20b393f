"""The monolithic solution of a part that a force drives against a stop: linear from contact to contact."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from body import Body
from monolith import Monolith, after, beside, crossing, fed_back, monolith, output

from fmu_src.runtime.model import Floats

PUSH, TIP = "tip.force.z", "tip.displacement.z"
SCAN = 2e-6  # s, between which contacts are looked for; the reed's fastest mode has 200 µs


@dataclass(frozen=True)
class Stop:
    """A spring in N/m, `gap` m away, that can only push; the force in N on the part from t = 0."""

    stiffness: float
    gap: float
    force: float


@dataclass(frozen=True, eq=False)
class Bounces:
    """The monolithic solution: linear from one contact or departure to the next."""

    starts: tuple[tuple[float, Monolith, Floats], ...]

    @property
    def events(self) -> Floats:
        """The times of contact, departure, contact …, s."""
        return np.array([t for t, _, _ in self.starts[1:]])

    def tip(self, times: Floats) -> Floats:
        """The tip's displacement, m."""
        return np.array([self._tip(t) for t in times])

    def _tip(self, t: float) -> float:
        start, system, x = next(s for s in reversed(self.starts) if s[0] <= t)
        return float(output(system, after(system, t - start, x), TIP))


def bounces(body: Body, stop: Stop, end: float) -> Bounces:
    """From rest at t = 0 to `end`; a state that stays 1 gives the force and the place of the stop."""
    constant = Monolith(np.zeros((1, 1)), np.ones(1), {}, {"one": np.ones(1)})
    reed = beside(monolith(body), constant)
    u, one = reed.outputs[TIP], reed.outputs["one"]
    flight = fed_back(reed, PUSH, stop.force * one)
    contact = fed_back(flight, PUSH, -stop.stiffness * (u - stop.gap * one))
    turns = (flight, u - stop.gap * one), (contact, stop.gap * one - u)

    def segments() -> Iterator[tuple[float, Monolith, Floats]]:
        t, x, turn = 0.0, reed.x0, 0
        while t < end:
            system, row = turns[turn]
            yield t, system, x
            lasts, x = crossing(system, x, row, SCAN, end - t)
            t, turn = t + lasts, 1 - turn

    return Bounces(tuple(segments()))
