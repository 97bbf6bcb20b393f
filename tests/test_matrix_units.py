"""Units of matrices: force, stiffness and inertia as converted by hand."""

import numpy as np
import pytest
from scipy.sparse import csr_array

from precompute.errors import MatrixError
from precompute.matrix_units import MASSES, Units, in_si

POUND_FORCE = 4.4482216152605  # N, NIST SP 811
ONE = csr_array(np.ones((2, 2)))
BOTH = np.array([0, 4])  # a translation and a rotation


def converted(units: Units, per_time: int) -> np.ndarray:
    return in_si(ONE, BOTH, units, per_time).toarray()


def test_millimetres_tonnes_seconds():
    """N/mm, N, N·mm; t, t·mm, t·mm²; N·s/mm …"""
    units = Units("mm", "t", "s")
    assert converted(units, 2) == pytest.approx(np.array([[1e3, 1.0], [1.0, 1e-3]]), rel=1e-15)
    assert converted(units, 0) == pytest.approx(np.array([[1e3, 1.0], [1.0, 1e-3]]), rel=1e-15)


@pytest.mark.parametrize(
    ("units", "metres"), [(Units("in", "slinch", "s"), 0.0254), (Units("ft", "slug", "s"), 0.3048)]
)
def test_pounds_force(units, metres):
    """lbf per unit of length, lbf, lbf times the unit."""
    expected = POUND_FORCE * np.array([[1 / metres, 1.0], [1.0, metres]])
    assert converted(units, 2) == pytest.approx(expected, rel=1e-12)


def test_masses():
    """NIST SP 811: slug 14.593 90 kg, pound 0.453 592 37 kg; a slinch is 12 slugs."""
    assert MASSES["slug"] == pytest.approx(14.59390, rel=1e-6)
    assert MASSES["slinch"] == pytest.approx(12 * MASSES["slug"], rel=1e-15)
    assert MASSES["lb"] == 0.45359237


def test_milliseconds():
    """kg, mm, ms: kN/mm, and kg/ms for damping."""
    units = Units("mm", "kg", "ms")
    assert converted(units, 2)[0, 0] == pytest.approx(1e6, rel=1e-15)
    assert converted(units, 1)[0, 0] == pytest.approx(1e3, rel=1e-15)
    assert converted(units, 0) == pytest.approx(np.array([[1.0, 1e-3], [1e-3, 1e-6]]), rel=1e-15)


def test_symmetry_stays_exact():
    rng = np.random.default_rng(0)
    A = rng.standard_normal((6, 6))
    converted = in_si(csr_array(A + A.T), np.arange(6), Units("in", "slinch", "ms"), 2)
    assert abs(converted - converted.T).nnz == 0


@pytest.mark.parametrize("wrong", [{"length": "km"}, {"mass": "oz"}, {"time": "min"}])
def test_unknown_units(wrong):
    name, unit = next(iter(wrong.items()))
    with pytest.raises(MatrixError, match=rf"^units: got {name} '{unit}', expected one of .*"):
        Units(**wrong)
