"""Few modes whose port-to-port responses stay within an error over a band."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from .damping import Damping
from .eigen import Modes
from .errors import EigenError
from .extra_damping import Dashpots
from .full_response import Reference, full_response
from .interface import Interface
from .known_modes import KnownModes
from .needed_modes import Residual, needed_modes
from .statics import StaticSolver

BEYOND = 1.5  # times the band's end: all modes up to there are found first
FIRST = 20  # modes that are found in any case; if they do not do, twice as many, and so on …
MOST = 300  # … up to so many: more are no reduction
FINER = 1e-3  # of the error asked for: the reference's own


@dataclass(frozen=True)
class Choice:
    """modes: those needed; found: the exact modes they are of, the lowest; reference: the full model."""

    modes: Modes
    found: Modes
    reference: Reference


def choose_modes(
    solve: StaticSolver,
    find: Callable[..., Modes],
    damp: Callable[[Modes], Damping],
    interface: Interface,
    error: float,
    band: tuple[float, float],
    residual: Residual = "modes",
    dashpots: Dashpots = (),
) -> Choice:
    """Few modes with max ‖H − H_r‖₂ / max ‖H‖₂ ≤ error over the band (Hz) for every kind of quantity.

    Modes are added in the order of their frequencies until the error is met; then those are dropped, the
    least dominant first, without which it still is. That no smaller model exists is not proved.
    find: solve_modes of the part, called with count or max_frequency (Hz); damp: modes → their damping;
    residual: what the reduced model has beside its modes: False, True (feed-through) or "modes".
    Raises EigenError: all modes that were found, up to MOST, do not do.
    """
    total = int(np.count_nonzero(solve.system.M.diagonal()[~solve.held]))  # of modes that there are
    found = find(count=min(FIRST, total))
    if found.frequencies[-1] < BEYOND * band[1] and len(found.lam) < total:
        found = find(max_frequency=BEYOND * band[1])
    while True:
        damping = damp(found)
        known = KnownModes(found.lam, found.Phi, damping.D_rest)
        reference = full_response(solve, known, damping, interface, band, FINER * error, dashpots)
        keep = needed_modes(reference, error, residual)
        if keep is not None:
            kept = Modes(found.lam[keep], found.Phi[:, keep], found.rigid, found.solver)
            return Choice(kept, found, reference)
        if 2 * len(found.lam) > MOST or len(found.lam) == total:
            raise EigenError(
                f"error: got {error:g} over {band[0]:g} to {band[1]:g} Hz, which all {len(found.lam)} modes "
                f"up to {found.frequencies[-1]:.6g} Hz do not meet; expected a larger error"
                + ("" if residual == "modes" else ', or residual = "modes"')
            )
        found = find(count=min(2 * len(found.lam), total))
