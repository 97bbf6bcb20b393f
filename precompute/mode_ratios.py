"""A damping ratio for every mode from a table that names some."""

from collections.abc import Sequence

import numpy as np

from .arrays import Bools, Floats
from .errors import ModalFmuError
from .notice import notice


def table_ratios(lam: Floats, table: Sequence[tuple[int, float]]) -> Floats:
    """ζᵢ (r,) of the modes lam (r,), 0 for rigid ones.

    table: pairs of a mode's number, from 1 and rigid modes counted, and its ζ. A mode that is not named has
    a ratio between those of the named modes around it, linear in frequency, or that of the nearest one
    where all named modes are on one side: a notice says so.
    Raises ModalFmuError: a number beyond the modes, a rigid mode, one number twice.
    """
    numbers, zeta = (np.array(column) for column in zip(*sorted(table), strict=True))
    elastic = lam > 0
    _check_numbers(numbers.tolist(), elastic)
    named, omega = numbers - 1, np.sqrt(lam)
    ratios: Floats = np.interp(omega, omega[named], zeta)
    ratios[named] = zeta  # of modes with one frequency each keeps its own
    ratios[~elastic] = 0.0
    others = np.flatnonzero(elastic & ~np.isin(np.arange(len(lam)), named)) + 1
    if len(others):
        notice(
            f"damping: the table leaves out {len(others)} of {elastic.sum()} elastic modes, the first is "
            f"mode {others[0]}; they take ratios between those of the table, linear in frequency, and beyond "
            "it that of the nearest mode"
        )
    return ratios


def _check_numbers(numbers: list[int], elastic: Bools) -> None:
    r = len(elastic)
    if beyond := [number for number in numbers if not 1 <= number <= r]:
        raise ModalFmuError(
            f"damping.table: got mode {beyond[0]}, expected 1 to {r}; keep more modes, or remove it"
        )
    if rigid := [number for number in numbers if not elastic[number - 1]]:
        raise ModalFmuError(
            f"damping.table: got mode {rigid[0]}, which is rigid and has no ratio, expected elastic modes; "
            "remove it (alpha and dashpots damp rigid modes)"
        )
    if len({*numbers}) < len(numbers):
        raise ModalFmuError(f"damping.table: got the modes {numbers}, expected none twice; remove one")
