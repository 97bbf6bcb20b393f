"""Modal damping against the closed forms of proportional damping."""

import logging
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fmu_src.runtime.model import damping_ratio
from precompute.arrays import Floats
from precompute.damping import Damping, damping_of, fit_ratios, modal_ratio, rayleigh
from precompute.errors import ModalFmuError
from precompute.notice import LOGGER_NAME
from precompute.part_tables import DampingForm

LAM = (2 * np.pi * np.array([0.0, 0.0, 10.0, 70.0, 500.0])) ** 2  # two rigid modes, then 10, 70, 500 Hz
ELASTIC = LAM[2:]
ROUNDING = 1e-14  # some ten operations on float64, relative

unhurried = settings(deadline=None)
ratios = st.floats(0.0, 3.0)
hertz = st.floats(1e-3, 1e6)


def curve(alpha: float, beta: float, frequency: float) -> float:
    """ζ(ω) = α/(2ω) + βω/2."""
    omega = 2 * math.pi * frequency
    return alpha / (2 * omega) + beta * omega / 2


def two_point(f1: float, zeta1: float, f2: float, zeta2: float) -> tuple[float, float]:
    """α = 2ω₁ω₂(ζ₁ω₂ − ζ₂ω₁)/(ω₂² − ω₁²), β = 2(ζ₂ω₂ − ζ₁ω₁)/(ω₂² − ω₁²)."""
    w1, w2 = 2 * math.pi * f1, 2 * math.pi * f2
    span = (w2 - w1) * (w2 + w1)
    return 2 * w1 * w2 * (zeta1 * w2 - zeta2 * w1) / span, 2 * (zeta2 * w2 - zeta1 * w1) / span


def d_of(damping: Damping, lam: Floats) -> Floats:
    """dᵢ = α + β λᵢ + D_rest,ᵢᵢ [2.28]."""
    return damping.alpha + damping.beta * lam + np.diag(damping.D_rest)


@pytest.fixture
def said(caplog: pytest.LogCaptureFixture) -> pytest.LogCaptureFixture:
    caplog.set_level(logging.INFO, logger=LOGGER_NAME)
    return caplog


class TestRayleigh:
    def test_equation(self) -> None:
        damping = rayleigh(LAM, 3.0, 2e-4)
        np.testing.assert_allclose(d_of(damping, LAM), 3.0 + 2e-4 * LAM, rtol=ROUNDING)
        assert damping.D_rest.shape == (5, 5)
        assert not damping.D_rest.any()

    def test_the_ratio_is_lowest_at_the_geometric_mean_of_equal_parts(self) -> None:
        # dζ/dω = 0 at ω = √(α/β), where ζ = √(αβ).
        alpha, beta = 4.0, 1e-4
        lam = alpha / beta * np.array([0.9, 1.0, 1.1])
        zeta = damping_ratio(lam, d_of(rayleigh(lam, alpha, beta), lam))
        assert zeta[1] == pytest.approx(math.sqrt(alpha * beta), rel=ROUNDING)
        assert zeta[1] < min(zeta[0], zeta[2])

    def test_alpha_on_rigid_modes_is_said(self, said: pytest.LogCaptureFixture) -> None:
        rayleigh(LAM, 3.0, 0.0)
        (record,) = said.records
        assert record.levelno == logging.INFO
        assert "the 2 rigid modes" in record.message

    @pytest.mark.parametrize(("lam", "alpha"), [(LAM, 0.0), (ELASTIC, 3.0)])
    def test_nothing_is_said_otherwise(
        self, said: pytest.LogCaptureFixture, lam: Floats, alpha: float
    ) -> None:
        rayleigh(lam, alpha, 1e-4)
        assert not said.records


class TestRatio:
    def test_every_elastic_mode_has_it_and_rigid_modes_move_freely(self) -> None:
        damping = modal_ratio(LAM, 0.02)
        d = d_of(damping, LAM)
        np.testing.assert_allclose(d[2:], 2 * 0.02 * 2 * np.pi * np.array([10, 70, 500]), rtol=ROUNDING)
        assert (d[:2] == 0).all()
        assert (damping.alpha, damping.beta) == (0.0, 0.0)
        assert np.count_nonzero(damping.D_rest) == 3  # a diagonal

    @unhurried
    @given(ratio=ratios)
    def test_is_what_is_achieved(self, ratio: float) -> None:
        zeta = damping_ratio(LAM, d_of(modal_ratio(LAM, ratio), LAM))
        np.testing.assert_allclose(zeta, [0, 0, ratio, ratio, ratio], rtol=ROUNDING, atol=5e-324)


class TestFit:
    def test_two_points_are_met_by_the_closed_form(self, said: pytest.LogCaptureFixture) -> None:
        damping = fit_ratios(ELASTIC, [(10.0, 0.02), (500.0, 0.01)])
        alpha, beta = two_point(10.0, 0.02, 500.0, 0.01)
        assert damping.alpha == pytest.approx(alpha, rel=ROUNDING * 10)  # a 2 × 2 solution besides
        assert damping.beta == pytest.approx(beta, rel=ROUNDING * 10)
        zeta = damping_ratio(ELASTIC, d_of(damping, ELASTIC))
        np.testing.assert_allclose(zeta[[0, 2]], [0.02, 0.01], rtol=ROUNDING * 10)
        assert zeta[1] < 0.005  # between the two points the curve sags
        assert not said.records

    @unhurried
    @given(f1=hertz, factor=st.floats(1.1, 1e4), alpha=st.floats(1e-3, 1e3), share=st.floats(1e-3, 1e3))
    def test_points_of_a_curve_give_the_curve_back(
        self, f1: float, factor: float, alpha: float, share: float
    ) -> None:
        frequencies = [f1, f1 * math.sqrt(factor), f1 * factor]
        omega = 2 * math.pi * frequencies[1]
        beta = share * alpha / omega**2
        # Rounding of ζ, times how much smaller than ζ a part can be at its own end, times the nearness
        # of the frequencies.
        slack = ROUNDING * max(share, 1 / share) * factor / math.log(factor)
        for points in (frequencies[::2], frequencies):
            damping = fit_ratios(ELASTIC, [(f, curve(alpha, beta, f)) for f in points])
            assert damping.alpha == pytest.approx(alpha, rel=slack)
            assert damping.beta == pytest.approx(beta, rel=slack)

    @unhurried
    @given(pairs=st.lists(st.tuples(hertz, ratios), min_size=2, max_size=5, unique_by=lambda pair: pair[0]))
    def test_no_other_alpha_beta_not_below_0_is_nearer(self, pairs: list[tuple[float, float]]) -> None:
        damping = fit_ratios(ELASTIC, pairs)
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
    def test_mass_and_stiffness_alone(self, said: pytest.LogCaptureFixture, factor: float) -> None:
        # ζ ∝ 1/f is α alone, ζ ∝ f is β alone; the other may come out as rounding, without a warning.
        mass = fit_ratios(ELASTIC, [(10.0, 0.01 * factor), (10.0 * factor, 0.01)])
        stiffness = fit_ratios(ELASTIC, [(10.0, 0.01), (10.0 * factor, 0.01 * factor)])
        assert mass.alpha == pytest.approx(0.01 * factor * 2 * 2 * math.pi * 10, rel=ROUNDING)
        assert stiffness.beta == pytest.approx(0.01 * 2 / (2 * math.pi * 10), rel=ROUNDING)
        # The other part of the ratio at its own end of the range, beside the largest ratio.
        assert 0 <= curve(0.0, mass.beta, 10.0 * factor) <= ROUNDING * 0.01 * factor
        assert 0 <= curve(stiffness.alpha, 0.0, 10.0) <= ROUNDING * 0.01 * factor
        assert not said.records

    def test_steeper_than_beta_alone_is_said(self, said: pytest.LogCaptureFixture) -> None:
        # Two points that ask for α < 0. β alone: x = Σωζ/Σω², β = 2x, by hand for ω in units of ω₁.
        damping = fit_ratios(ELASTIC, [(10.0, 0.01), (20.0, 0.05)])
        assert two_point(10.0, 0.01, 20.0, 0.05)[0] < 0
        x = (1 * 0.01 + 2 * 0.05) / (1**2 + 2**2)  # 0.022
        assert damping.alpha == 0
        assert damping.beta == pytest.approx(2 * x / (2 * math.pi * 10), rel=ROUNDING)
        (record,) = said.records
        assert record.levelno == logging.WARNING
        assert "achieved 0.022 (asked 0.01) at 10 Hz, 0.044 (asked 0.05) at 20 Hz" in record.message

    def test_a_bound_is_said_though_the_miss_is_small(self, said: pytest.LogCaptureFixture) -> None:
        # ζ₂/ζ₁ = 2.1 where β alone gives 2: α < 0 asked, and each ratio within 10 %.
        fit_ratios(ELASTIC, [(10.0, 0.01), (20.0, 0.021)])
        assert len(said.records) == 1

    def test_a_curve_that_cannot_bend_so_is_said(self, said: pytest.LogCaptureFixture) -> None:
        fit_ratios(ELASTIC, [(10.0, 0.01), (100.0, 0.03), (1000.0, 0.01)])  # ζ(ω) has no maximum
        assert len(said.records) == 1

    def test_a_miss_below_a_tenth_is_not_said(self, said: pytest.LogCaptureFixture) -> None:
        fit_ratios(ELASTIC, [(10.0, 0.0205), (20.0, 0.0155), (40.0, 0.0205)])
        exact = curve(*two_point(10.0, 0.0205, 40.0, 0.0205), 20.0)
        assert exact != pytest.approx(0.0155, rel=0.01)  # three points that no curve meets
        assert not said.records

    def test_no_damping_asked_is_none(self, said: pytest.LogCaptureFixture) -> None:
        assert not d_of(fit_ratios(ELASTIC, [(1.0, 0.0), (2.0, 0.0)]), ELASTIC).any()
        assert not said.records

    @pytest.mark.parametrize("pairs", [[], [(1.0, 0.1)], [(1.0, 0.1), (1.0, 0.2)], [(0.0, 0.1), (1.0, 0.1)]])
    def test_too_few_frequencies(self, pairs: list[tuple[float, float]]) -> None:
        with pytest.raises(ModalFmuError, match="two or more distinct frequencies > 0"):
            fit_ratios(ELASTIC, pairs)


class TestAchieved:
    def test_all_cases_of_one_oscillator(self) -> None:
        lam = np.array([4.0, 4.0, 4.0, 4.0])
        d = np.array([0.0, 0.4, 4.0, 40.0])  # undamped, under-, critically and over-damped: ζ = d/4
        np.testing.assert_array_equal(damping_ratio(lam, d), [0.0, 0.1, 1.0, 10.0])

    def test_rigid_modes_have_none(self) -> None:
        zeta = damping_ratio(LAM, d_of(rayleigh(LAM, 5.0, 0.0), LAM))
        assert (zeta[:2] == 0).all()
        assert (zeta[2:] > 0).all()


class TestDampingOf:
    @pytest.mark.parametrize(
        ("form", "expected"),
        [
            (DampingForm(alpha=2.0), [2.0, 2.0, 2.0]),
            (DampingForm(alpha=1.0, beta=0.5), [1.0, 1.5, 3.0]),
            (DampingForm(ratio=0.25), [0.0, 0.5, 1.0]),
            # α = β = 0.2 gives ζ(1) = 0.2 and ζ(2) = 0.25, ω in rad/s
            (
                DampingForm(ratios=((1 / (2 * math.pi), 0.2), (2 / (2 * math.pi), 0.25))),
                [0.2, 0.4, 1.0],
            ),
        ],
    )
    def test_every_form(self, form: DampingForm, expected: list[float]) -> None:
        lam = np.array([0.0, 1.0, 4.0])
        np.testing.assert_allclose(d_of(damping_of(form, lam), lam), expected, rtol=10 * ROUNDING)


class TestDamping:
    @pytest.mark.parametrize("bad", [-1.0, math.nan, math.inf])
    def test_refuses_what_is_no_coefficient(self, bad: float) -> None:
        for alpha, beta in [(bad, 0.0), (0.0, bad)]:
            with pytest.raises(ModalFmuError, match="expected finite numbers ≥ 0"):
                Damping(alpha, beta, np.zeros((1, 1)))

    @pytest.mark.parametrize(
        "D_rest", [np.zeros(3), np.zeros((2, 3)), np.diag([1.0, np.nan]), np.diag([1.0, -1.0])]
    )
    def test_refuses_what_is_no_matrix(self, D_rest: Floats) -> None:
        with pytest.raises(ModalFmuError, match=r"expected \(r, r\)"):
            Damping(0.0, 0.0, D_rest)


def test_fitted_ratios_on_a_free_body_say_that_alpha_damps_it(said: pytest.LogCaptureFixture) -> None:
    lam = np.array([0.0, 0.0, 100.0, 2500.0])
    damping = fit_ratios(lam, [(1.0, 0.02), (8.0, 0.02)])
    assert damping.alpha > 0
    assert "damps the 2 rigid modes too" in said.text
