"""The coefficients of the analytic step against 60-digit arithmetic and the semigroup property."""

import math
from collections.abc import Callable

import mpmath as mp
import numpy as np
import pytest
from hypothesis import example, given, settings, target
from hypothesis import strategies as st

from fmu_src.runtime.model import Floats
from fmu_src.runtime.propagator import Propagator, propagator

NAMES = ("E11", "E12", "E21", "E22", "G0", "G1", "G2", "G3")
# What is promised, relative to the largest absolute value over [h/2, 2h] and per 1 + ωh: a rounding of ω
# alone turns into a phase error of ωh roundings. Long searches found 1.3e-15 at worst.
PROMISE = 3e-15


def exact(lam: float, d: float, h: float) -> list[mp.mpf]:
    """The coefficients from the roots [2.34] by their textbook formulas, in arithmetic that affords them."""
    tiny = sum(max(0.0, -math.log10(x)) for x in (lam, d, h) if x > 0)
    with mp.workdps(
        100 + int(5 * tiny)
    ):  # differences of the order of (λh²)², dh and λ/d² lose so many digits
        lam, d, h = mp.mpf(lam), mp.mpf(d), mp.mpf(h)
        root = mp.sqrt(d * d / 4 - lam)
        r1, r2 = -d / 2 + root, -d / 2 - root
        e1, e2 = mp.exp(r1 * h), mp.exp(r2 * h)
        if root == 0:
            E11, E12, E22 = (1 - r1 * h) * e1, h * e1, (1 + r1 * h) * e1
        else:
            E11 = (r1 * e2 - r2 * e1) / (r1 - r2)
            E12 = (e1 - e2) / (r1 - r2)
            E22 = (r1 * e1 - r2 * e2) / (r1 - r2)
        if lam > 0:
            G0 = (1 - E11) / lam
            G1 = (h - E12 - d * G0) / lam
            G2 = (h * h / 2 - G0 - d * G1) / lam
            G3 = (h**3 / 6 - G1 - d * G2) / lam
        elif d > 0:
            G0 = (h - E12) / d
            G1 = (h * h / 2 - G0) / d
            G2 = (h**3 / 6 - G1) / d
            G3 = (h**4 / 24 - G2) / d
        else:
            G0, G1, G2, G3 = h * h / 2, h**3 / 6, h**4 / 24, h**5 / 120
        return [mp.re(c) for c in (E11, E12, -lam * E12, E22, G0, G1, G2, G3)]


def largest(lam: float, d: float, h: float) -> list[mp.mpf]:
    """Largest absolute value of each coefficient over nine points of [h/2, 2h]."""
    samples = [exact(lam, d, h / 2 * 4 ** (k / 8)) for k in range(9)]
    return [max(abs(c) for c in column) for column in zip(*samples, strict=True)]


def errors(P: Propagator, lam: float, d: float) -> dict[str, float]:
    """Error of each coefficient in units of what is promised."""
    unit = PROMISE * (1 + math.sqrt(lam) * P.h)
    found = {}
    for name, reference, scale in zip(NAMES, exact(lam, d, P.h), largest(lam, d, P.h), strict=True):
        if scale > 1e-290:  # below that float64 has no full precision left
            found[name] = float(abs(mp.mpf(float(getattr(P, name)[0])) - reference) / scale) / unit
    return found


@st.composite
def oscillators(draw: st.DrawFn) -> tuple[float, float, float]:
    """λ ∈ [0, 1e16], d ∈ [0, 1e9], h ∈ [1e-9, 1e2], ωh ≤ 1e9; the corners as often as the inside."""
    exponent = st.floats(-30, 16)
    lam = draw(st.one_of(st.just(0.0), st.floats(0, 1e16), exponent.map(lambda x: 10.0**x)))
    critical = 2 * math.sqrt(lam)
    near = st.floats(-17, 0).flatmap(
        lambda x: st.sampled_from([critical * (1 + 10.0**x), critical * (1 - 10.0**x), critical])
    )
    d = draw(st.one_of(st.just(0.0), st.floats(0, 1e9), st.floats(-30, 9).map(lambda x: 10.0**x), near))
    top = min(1e2, 1e9 / math.sqrt(lam)) if lam > 0 else 1e2
    scale = max(math.sqrt(lam), d)  # the fastest rate of the oscillator
    own = st.floats(-3, 3).map(lambda x: min(top, max(1e-9, 10.0**x / scale)) if scale > 0 else 1.0)
    h = draw(st.one_of(st.floats(1e-9, top), st.floats(-9, math.log10(top)).map(lambda x: 10.0**x), own))
    return lam, min(d, 1e9), min(max(h, 1e-9), top)


CORNERS = [
    (1.0, 2.0, 1.0),  # exactly critical
    (1.0, math.nextafter(2.0, 3.0), 1.0),
    (1.0, math.nextafter(2.0, 1.0), 1.0),
    (0.0, 0.0, 100.0),  # rigid and free
    (0.0, 1e9, 100.0),  # rigid in molasses
    (1e16, 0.0, 10.0),  # 1e9 radians
    (1e-30, 1e9, 1e-9),
    (1.5**2, 3.0, 1.0),  # where the series ends
]


def assert_promise_is_kept(twin: Callable[[Floats, Floats, float], Propagator], examples: int) -> None:
    """At the corners, and wherever a search that climbs to the worst case comes to."""

    @settings(max_examples=examples, deadline=None)
    @given(oscillators())
    def search(oscillator: tuple[float, float, float]) -> None:
        lam, d, h = oscillator
        found = errors(twin(np.array([lam]), np.array([d]), h), lam, d)
        target(math.log10(max(found.values(), default=0.0) + 1e-9))
        assert max(found.values(), default=0.0) <= 1.0, (found, lam, d, h)

    for corner in CORNERS:
        search = example(corner)(search)
    search()


def test_coefficients_are_exact() -> None:
    assert_promise_is_kept(propagator, 1500)


@pytest.mark.parametrize(("lam", "d", "h"), [(1.0, 2 + 1e-12, 1.0), (1e-9, 1e3, 1.0), (1.0, 0.0, 1e-4)])
def test_textbook_formulas_would_fail(lam: float, d: float, h: float) -> None:
    """Negative control: in float64 the textbook quotients miss the promise that the code keeps."""
    root = np.sqrt(complex(d * d / 4 - lam))
    r1, r2 = -d / 2 + root, -d / 2 - root
    e1, e2 = np.exp(r1 * h), np.exp(r2 * h)
    E11 = ((r1 * e2 - r2 * e1) / (r1 - r2)).real
    E12 = ((e1 - e2) / (r1 - r2)).real
    naive = (h - E12 - d * (1 - E11) / lam) / lam
    P = propagator(np.array([lam]), np.array([d]), h)
    G1 = exact(lam, d, h)[5]
    assert abs(naive - G1) / G1 > 100 * PROMISE
    assert errors(P, lam, d)["G1"] < 1.0


def test_modes_do_not_mix() -> None:
    """A vector of modes of all kinds gives what each gives alone."""
    lam = np.array([0.0, 0.0, 1.0, 1.0, 1.0, 1e8])
    d = np.array([0.0, 3.0, 0.1, 2.0, 50.0, 1e-3])
    together = propagator(lam, d, 0.7)
    for i in range(len(lam)):
        alone = propagator(lam[i : i + 1], d[i : i + 1], 0.7)
        for name in NAMES:
            assert getattr(together, name)[i] == getattr(alone, name)[0]
