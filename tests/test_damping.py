"""Modal damping against closed forms: α and β, ratios, a loss factor, a table."""

import logging
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fmu_src.runtime.model import damping_ratio
from precompute.arrays import Floats
from precompute.damping import Damping, damping_of, modal_ratio, modal_table, rayleigh, structural
from precompute.damping_table import DampingForm
from precompute.errors import ModalFmuError
from precompute.mode_ratios import table_ratios
from precompute.notice import LOGGER_NAME

LAM = (2 * np.pi * np.array([0.0, 0.0, 10.0, 70.0, 500.0])) ** 2  # two rigid modes, then 10, 70, 500 Hz
ELASTIC = LAM[2:]
ROUNDING = 1e-14  # some ten operations on float64, relative

unhurried = settings(deadline=None)


def d_of(damping: Damping, lam: Floats) -> Floats:
    """dᵢ = α + β λᵢ + D_rest,ᵢᵢ [2.28]."""
    return damping.alpha + damping.beta * lam + np.diag(damping.D_rest)


def asked(form: DampingForm, lam: Floats) -> Damping:
    """The damping of a part without D and dashpots, whose mode shapes do not matter then."""
    return damping_of(form, lam, np.zeros((0, len(lam))))


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


class TestRatio:
    def test_every_elastic_mode_has_it_and_rigid_modes_move_freely(self) -> None:
        damping = modal_ratio(LAM, 0.02)
        d = d_of(damping, LAM)
        np.testing.assert_allclose(d[2:], 2 * 0.02 * 2 * np.pi * np.array([10, 70, 500]), rtol=ROUNDING)
        assert (d[:2] == 0).all()
        assert (damping.alpha, damping.beta) == (0.0, 0.0)
        assert np.count_nonzero(damping.D_rest) == 3  # a diagonal

    @unhurried
    @given(ratio=st.floats(0.0, 3.0))
    def test_is_what_is_achieved(self, ratio: float) -> None:
        zeta = damping_ratio(LAM, d_of(modal_ratio(LAM, ratio), LAM))
        np.testing.assert_allclose(zeta, [0, 0, ratio, ratio, ratio], rtol=ROUNDING, atol=5e-324)


class TestStructural:
    def test_loss_factor_is_the_inverse_of_the_amplification_at_resonance(self) -> None:
        # |H(iω₀)| / H(0) = λ / (dω) of q̈ + dq̇ + λq = f; of K(1 + iη) it is 1/η
        d = d_of(structural(ELASTIC, 0.05), ELASTIC)
        np.testing.assert_allclose(ELASTIC / (d * np.sqrt(ELASTIC)), 1 / 0.05, rtol=ROUNDING)

    def test_rigid_modes_move_freely(self) -> None:
        assert (d_of(structural(LAM, 0.05), LAM)[:2] == 0).all()


class TestTable:
    def test_named_modes_have_their_ratio_and_rigid_ones_count(self, said: pytest.LogCaptureFixture) -> None:
        damping = modal_table(LAM, [(5, 0.03), (3, 0.01), (4, 0.02)])
        zeta = damping_ratio(LAM, d_of(damping, LAM))
        np.testing.assert_allclose(zeta, [0, 0, 0.01, 0.02, 0.03], rtol=ROUNDING)
        assert not said.records

    def test_between_named_modes_the_ratio_is_linear_in_frequency(
        self, said: pytest.LogCaptureFixture
    ) -> None:
        zeta = table_ratios(LAM, [(3, 0.01), (5, 0.03)])
        assert zeta[3] == pytest.approx(0.01 + 0.02 * (70 - 10) / (500 - 10), rel=ROUNDING)
        (record,) = said.records
        assert record.levelno == logging.INFO
        assert "leaves out 1 of 3 elastic modes, the first is mode 4" in record.message

    def test_beyond_named_modes_it_is_that_of_the_nearest(self, said: pytest.LogCaptureFixture) -> None:
        np.testing.assert_array_equal(table_ratios(LAM, [(4, 0.02)]), [0, 0, 0.02, 0.02, 0.02])
        assert "leaves out 2 of 3" in said.text

    def test_modes_of_one_frequency_each_keep_their_own(self) -> None:
        lam = np.array([1.0, 4.0, 4.0, 9.0])
        np.testing.assert_array_equal(
            table_ratios(lam, [(1, 0.1), (2, 0.2), (3, 0.3), (4, 0.4)]), [0.1, 0.2, 0.3, 0.4]
        )

    def test_a_ratio_of_0_is_one(self) -> None:
        np.testing.assert_array_equal(table_ratios(ELASTIC, [(1, 0.0), (2, 0.1), (3, 0.0)]), [0.0, 0.1, 0.0])

    @pytest.mark.parametrize(
        ("table", "words"),
        [
            ([(3, 0.1), (6, 0.1)], "got mode 6, expected 1 to 5; keep more modes, or remove it"),
            ([(0, 0.1)], "got mode 0, expected 1 to 5"),
            ([(2, 0.1), (3, 0.1)], "got mode 2, which is rigid and has no ratio"),
            ([(3, 0.1), (3, 0.2)], "expected none twice"),
        ],
    )
    def test_refuses_modes_that_have_no_ratio(self, table: list[tuple[int, float]], words: str) -> None:
        with pytest.raises(ModalFmuError, match=words):
            table_ratios(LAM, table)


class TestAchieved:
    def test_all_cases_of_one_oscillator(self) -> None:
        lam = np.array([4.0, 4.0, 4.0, 4.0])
        d = np.array([0.0, 0.4, 4.0, 40.0])  # undamped, under-, critically and over-damped: ζ = d/4
        np.testing.assert_array_equal(damping_ratio(lam, d), [0.0, 0.1, 1.0, 10.0])

    def test_rigid_modes_have_none(self) -> None:
        zeta = damping_ratio(LAM, d_of(rayleigh(LAM, 5.0, 0.0), LAM))
        assert (zeta[:2] == 0).all()
        assert (zeta[2:] > 0).all()


# lam = 0, 1, 4: ω = 0, 1, 2 rad/s
FORMS = [
    (DampingForm(alpha=2.0), [2.0, 2.0, 2.0]),
    (DampingForm(alpha=1.0, beta=0.5), [1.0, 1.5, 3.0]),
    (DampingForm(ratio=0.25), [0.0, 0.5, 1.0]),
    # α = β = 0.2 gives ζ(1) = 0.2 and ζ(2) = 0.25
    (DampingForm(ratios=((1 / (2 * math.pi), 0.2), (2 / (2 * math.pi), 0.25))), [0.2, 0.4, 1.0]),
    (DampingForm(table=((2, 0.25), (3, 0.5))), [0.0, 0.5, 2.0]),
    (DampingForm(structural=0.5), [0.0, 0.5, 1.0]),
]


class TestDampingOf:
    @pytest.mark.parametrize(("form", "expected"), FORMS)
    def test_every_form(self, form: DampingForm, expected: list[float]) -> None:
        lam = np.array([0.0, 1.0, 4.0])
        np.testing.assert_allclose(d_of(asked(form, lam), lam), expected, rtol=10 * ROUNDING)

    @pytest.mark.parametrize(("form", "expected"), FORMS)
    def test_the_rule_continues_what_the_modes_have(self, form: DampingForm, expected: list[float]) -> None:
        damping = asked(form, np.array([0.0, 1.0, 4.0]))
        np.testing.assert_allclose(damping.rule(np.array([0.0, 4.0])), expected[::2], rtol=10 * ROUNDING)

    def test_the_rule_of_a_table_is_its_last_ratio(self) -> None:
        damping = asked(DampingForm(table=((2, 0.5), (1, 0.25))), np.array([1.0, 4.0]))
        np.testing.assert_allclose(damping.rule(np.array([9.0, 100.0])), [3.0, 10.0], rtol=ROUNDING)

    @pytest.mark.parametrize(("form", "expected"), FORMS)
    def test_alpha_and_beta_of_the_body_add_to_it(self, form: DampingForm, expected: list[float]) -> None:
        lam = np.array([0.0, 1.0, 4.0])
        damping = damping_of(form, lam, np.zeros((0, 3)), shared=(2.0, 0.5))
        np.testing.assert_allclose(
            d_of(damping, lam), np.array(expected) + 2.0 + 0.5 * lam, rtol=10 * ROUNDING
        )

    @pytest.mark.parametrize(
        ("form", "shared"),
        [
            (DampingForm(alpha=3.0), (0.0, 0.0)),
            (DampingForm(ratios=((1.0, 0.02), (8.0, 0.02))), (0.0, 0.0)),
            (DampingForm(ratio=0.1), (3.0, 0.0)),
        ],
    )
    def test_alpha_on_rigid_modes_is_said(
        self, said: pytest.LogCaptureFixture, form: DampingForm, shared: tuple[float, float]
    ) -> None:
        damping_of(form, LAM, np.zeros((0, 5)), shared=shared)
        (record,) = said.records
        assert record.levelno == logging.INFO
        assert "the 2 rigid modes" in record.message

    @pytest.mark.parametrize(
        ("lam", "form"), [(LAM, DampingForm(beta=1e-4)), (ELASTIC, DampingForm(alpha=3.0, beta=1e-4))]
    )
    def test_nothing_is_said_otherwise(
        self, said: pytest.LogCaptureFixture, lam: Floats, form: DampingForm
    ) -> None:
        asked(form, lam)
        assert not said.records


class TestDamping:
    @pytest.mark.parametrize("bad", [-1.0, math.nan, math.inf])
    def test_refuses_what_is_no_coefficient(self, bad: float) -> None:
        for alpha, beta, ratio in [(bad, 0.0, 0.0), (0.0, bad, 0.0), (0.0, 0.0, bad)]:
            with pytest.raises(ModalFmuError, match="expected finite numbers ≥ 0"):
                Damping(alpha, beta, np.zeros((1, 1)), ratio)

    @pytest.mark.parametrize(
        "D_rest",
        [
            np.zeros(3),
            np.zeros((2, 3)),
            np.diag([1.0, np.nan]),
            np.diag([1.0, -1.0]),
            np.array([[1.0, 0.5], [0.4, 1.0]]),
        ],
    )
    def test_refuses_what_is_no_matrix(self, D_rest: Floats) -> None:
        with pytest.raises(ModalFmuError, match=r"expected \(r, r\)"):
            Damping(0.0, 0.0, D_rest)
