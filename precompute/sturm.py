"""The lowest modes, none missed: Lanczos finds them, the inertia of K − sM counts them."""

from collections.abc import Callable

import numpy as np
from scipy.sparse import csr_array

from .arrays import Floats
from .errors import EigenError
from .factor import Factor
from .pencil import Pairs, Pencil, nothing

EXTRA = 4  # modes beyond those wanted, among which s finds a gap
CLEAR = 1e-3  # of λ: the first gap as wide as this is taken …
NARROWEST = 1e-6  # … else the widest, if not narrower than this: s never cuts a cluster of equal λ
ROUNDINGS = 100.0  # · λ_ε: a gap must be wide against the rounding of K
SEARCHES = 10  # each finds more copies of a multiple eigenvalue


def count_below(pencil: Pencil, factorise: Callable[[csr_array], Factor], s: float) -> int | None:
    """The number of elastic λ < s: negative pivots of K − sM = L D Lᵀ, less the rigid modes; none if unknown.

    Source: Sylvester's law of inertia; Parlett, The Symmetric Eigenvalue Problem, 3.3.
    """
    try:
        negative = factorise(pencil.shifted(s)).negative_pivots()
    except EigenError:  # s hit an eigenvalue of a leading block: a zero pivot
        return None
    return None if negative is None else negative - pencil.rigid.shape[1]


def gap_above(lam: Floats, wanted: int, ceiling: float, noise: float) -> tuple[int, float] | None:
    """(j, s): the first j eigenvalues, j ≥ wanted, lie below s, the others above; s ≥ ceiling in a clear gap.

    lam: (k,) ascending. s is the ceiling itself where that is clear of its neighbours. None where no gap
    follows the wanted ones: more eigenvalues are needed.
    """
    found = []
    for j in range(max(wanted, 1), len(lam)):
        low, high = lam[j - 1], lam[j]
        s = ceiling if ceiling > low else 0.5 * (low + high)
        width = 2 * min(s - low, high - s)  # of the gap around s
        if width >= max(NARROWEST * high, ROUNDINGS * noise):
            found.append((width / high, j, s))
            if width >= CLEAR * high:
                break
    if not found:
        return None
    _, j, s = max(found)
    return j, s


def lowest_modes(
    pencil: Pencil,
    search: Callable[[Pairs, int], Pairs],
    count: Callable[[float], int | None],
    wanted: int,
    ceiling: float = 0.0,
) -> Pairs:
    """At least `wanted` of the lowest elastic pairs and all with λ ≤ ceiling, clusters whole, none missed.

    search(known, k): the known pairs and k more; count(s): the number of λ < s, none if not known.
    What the count misses is searched M-orthogonal to all those known, and counted again. Where there is no
    count, a second search, from another start vector, must find nothing below s.
    Raises EigenError: modes are missing and cannot be found.
    """
    known = search(nothing(pencil), wanted + EXTRA)
    for _ in range(SEARCHES):
        while (gap := gap_above(known.lam, wanted, ceiling, pencil.noise)) is None:
            if len(known.lam) >= pencil.elastic:
                break
            known = search(known, max(EXTRA, len(known.lam) // 2))
        if gap is None or len(known.lam) >= pencil.elastic:
            return known
        j, s = gap
        below = count(s)
        if below != j:
            known = search(known, EXTRA + max((below or j) - j, 0))
        if below == j or (below is None and np.sum(known.lam < s) == j):
            return known.first(j)
    raise EigenError(
        f"modes: {j} were found below {np.sqrt(s) / (2 * np.pi):.6g} Hz, but K − sM counts {below} there; "
        f"check that K and M are symmetric and not negative"
    )
