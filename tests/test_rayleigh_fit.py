"""α, β fitted to ratios, against the closed form of two points."""

import logging
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fmu_src.runtime.model import damping_ratio
from precompute.damping import Damping, rayleigh
from precompute.errors import ModalFmuError
from precompute.notice import LOGGER_NAME
from precompute.rayleigh_fit import fit_ratios

ELASTIC = (2 * np.pi * np.array([10.0, 70.0, 500.0])) ** 2
ROUNDING = 1e-14  # some ten operations on float64, relative

unhurried = settings(deadline=None)
ratios = st.floats(0.0, 3.0)
hertz = st.floats(1e-3, 1e6)


def fitted(pairs: list[tuple[float, float]]) -> Damping:
    return rayleigh(ELASTIC, *fit_ratios(pairs))


def curve(alpha: float, beta: float, frequency: float) -> float:
    """ζ(ω) = α/(2ω) + βω/2."""
    omega = 2 * math.pi * frequency
    return alpha / (2 * omega) + beta * omega / 2


def two_point(f1: float, zeta1: float, f2: float, zeta2: float) -> tuple[float, float]:
    """α = 2ω₁ω₂(ζ₁ω₂ − ζ₂ω₁)/(ω₂² − ω₁²), β = 2(ζ₂ω₂ − ζ₁ω₁)/(ω₂² − ω₁²)."""
    w1, w2 = 2 * math.pi * f1, 2 * math.pi * f2
    span = (w2 - w1) * (w2 + w1)
    return 2 * w1 * w2 * (zeta1 * w2 - zeta2 * w1) / span, 2 * (zeta2 * w2 - zeta1 * w1) / span


def d_of(damping: Damping) -> list[float]:
    """dᵢ = α + β λᵢ [2.28]."""
    return [damping.alpha + damping.beta * lam for lam in ELASTIC]


@pytest.fixture
def said(caplog: pytest.LogCaptureFixture) -> pytest.LogCaptureFixture:
    caplog.set_level(logging.INFO, logger=LOGGER_NAME)
    return caplog


def test_two_points_are_met_by_the_closed_form(said: pytest.LogCaptureFixture) -> None:
    damping = fitted([(10.0, 0.02), (500.0, 0.01)])
    alpha, beta = two_point(10.0, 0.02, 500.0, 0.01)
    assert damping.alpha == pytest.approx(alpha, rel=ROUNDING * 10)  # a 2 × 2 solution besides
    assert damping.beta == pytest.approx(beta, rel=ROUNDING * 10)
    zeta = damping_ratio(ELASTIC, np.array(d_of(damping)))
    np.testing.assert_allclose(zeta[[0, 2]], [0.02, 0.01], rtol=ROUNDING * 10)
    assert zeta[1] < 0.005  # between the two points the curve sags
    assert not said.records


@unhurried
@given(f1=hertz, factor=st.floats(1.1, 1e4), alpha=st.floats(1e-3, 1e3), share=st.floats(1e-3, 1e3))
def test_points_of_a_curve_give_the_curve_back(f1: float, factor: float, alpha: float, share: float) -> None:
    frequencies = [f1, f1 * math.sqrt(factor), f1 * factor]
    omega = 2 * math.pi * frequencies[1]
    beta = share * alpha / omega**2
    # Rounding of ζ, times how much smaller than ζ a part can be at its own end, times the nearness
    # of the frequencies.
    slack = ROUNDING * max(share, 1 / share) * factor / math.log(factor)
    for points in (frequencies[::2], frequencies):
        damping = fitted([(f, curve(alpha, beta, f)) for f in points])
        assert damping.alpha == pytest.approx(alpha, rel=slack)
        assert damping.beta == pytest.approx(beta, rel=slack)


@unhurried
@given(pairs=st.lists(st.tuples(hertz, ratios), min_size=2, max_size=5, unique_by=lambda pair: pair[0]))
def test_no_other_alpha_beta_not_below_0_is_nearer(pairs: list[tuple[float, float]]) -> None:
    damping = fitted(pairs)
    assert damping.alpha >= 0
    assert damping.beta >= 0

    def miss(alpha: float, beta: float) -> float:
        return sum((curve(alpha, beta, f) - zeta) ** 2 for f, zeta in pairs)

    # The problem is convex: where no step in any direction goes down, it is the minimum.
    largest = max(zeta for _, zeta in pairs)
    middle = 2 * math.pi * math.exp(sum(math.log(f) for f, _ in pairs) / len(pairs))
    least = miss(damping.alpha, damping.beta)
    for da, db in [(1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1)]:
        alpha = damping.alpha + 1e-3 * da * largest * 2 * middle
        beta = damping.beta + 1e-3 * db * largest * 2 / middle
        if alpha >= 0 and beta >= 0:
            assert miss(alpha, beta) >= least - 1e-13 * largest**2  # rounding of ten squares


@pytest.mark.parametrize("factor", [1.5, 2.0, 3.0, 7.0, 10.0, 30.0, 100.0])
def test_mass_and_stiffness_alone(said: pytest.LogCaptureFixture, factor: float) -> None:
    # ζ ∝ 1/f is α alone, ζ ∝ f is β alone; the other may come out as rounding, without a warning.
    mass = fitted([(10.0, 0.01 * factor), (10.0 * factor, 0.01)])
    stiffness = fitted([(10.0, 0.01), (10.0 * factor, 0.01 * factor)])
    assert mass.alpha == pytest.approx(0.01 * factor * 2 * 2 * math.pi * 10, rel=ROUNDING)
    assert stiffness.beta == pytest.approx(0.01 * 2 / (2 * math.pi * 10), rel=ROUNDING)
    # The other part of the ratio at its own end of the range, beside the largest ratio.
    assert 0 <= curve(0.0, mass.beta, 10.0 * factor) <= ROUNDING * 0.01 * factor
    assert 0 <= curve(stiffness.alpha, 0.0, 10.0) <= ROUNDING * 0.01 * factor
    assert not said.records


def test_steeper_than_beta_alone_is_said(said: pytest.LogCaptureFixture) -> None:
    # Two points that ask for α < 0. β alone: x = Σωζ/Σω², β = 2x, by hand for ω in units of ω₁.
    damping = fitted([(10.0, 0.01), (20.0, 0.05)])
    assert two_point(10.0, 0.01, 20.0, 0.05)[0] < 0
    x = (1 * 0.01 + 2 * 0.05) / (1**2 + 2**2)  # 0.022
    assert damping.alpha == 0
    assert damping.beta == pytest.approx(2 * x / (2 * math.pi * 10), rel=ROUNDING)
    (record,) = said.records
    assert record.levelno == logging.WARNING
    assert "achieved 0.022 (asked 0.01) at 10 Hz, 0.044 (asked 0.05) at 20 Hz" in record.message


def test_a_bound_is_said_though_the_miss_is_small(said: pytest.LogCaptureFixture) -> None:
    # ζ₂/ζ₁ = 2.1 where β alone gives 2: α < 0 asked, and each ratio within 10 %.
    fitted([(10.0, 0.01), (20.0, 0.021)])
    assert len(said.records) == 1


def test_a_curve_that_cannot_bend_so_is_said(said: pytest.LogCaptureFixture) -> None:
    fitted([(10.0, 0.01), (100.0, 0.03), (1000.0, 0.01)])  # ζ(ω) has no maximum
    assert len(said.records) == 1


def test_a_miss_below_a_tenth_is_not_said(said: pytest.LogCaptureFixture) -> None:
    fitted([(10.0, 0.0205), (20.0, 0.0155), (40.0, 0.0205)])
    exact = curve(*two_point(10.0, 0.0205, 40.0, 0.0205), 20.0)
    assert exact != pytest.approx(0.0155, rel=0.01)  # three points that no curve meets
    assert not said.records


def test_no_damping_asked_is_none(said: pytest.LogCaptureFixture) -> None:
    assert not any(d_of(fitted([(1.0, 0.0), (2.0, 0.0)])))
    assert not said.records


@pytest.mark.parametrize("pairs", [[], [(1.0, 0.1)], [(1.0, 0.1), (1.0, 0.2)], [(0.0, 0.1), (1.0, 0.1)]])
def test_too_few_frequencies(pairs: list[tuple[float, float]]) -> None:
    with pytest.raises(ModalFmuError, match="two or more distinct frequencies > 0"):
        fitted(pairs)
