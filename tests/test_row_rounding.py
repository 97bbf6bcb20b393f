"""The rounding of an exported K, as its rows show it."""

import numpy as np
import pytest
from boxes import box, steel
from scipy.sparse import csr_array, diags_array

from precompute.assembly import assemble
from precompute.row_rounding import row_rounding

MESH = box("hex8", (6, 3, 3), (0.6, 0.3, 0.3))
SYSTEM = assemble(MESH, steel(MESH))
K, T = SYSTEM.K, SYSTEM.rigid[:, :3]


def rounded(A: csr_array, digits: int) -> csr_array:
    """Entries as a file of so many digits keeps them."""
    return csr_array(
        (np.array([float(f"{a:.{digits - 1}e}") for a in A.data]), A.indices, A.indptr), shape=A.shape
    )


def test_sums_in_double_precision_show_nothing_that_matters() -> None:
    assert 0 < row_rounding(K, T) < np.finfo(float).eps


@pytest.mark.parametrize("digits", [13, 14, 15])
def test_digits_that_were_lost_on_the_way(digits: int) -> None:
    """Half a unit of the last digit per entry; in a row of up to 81 of them most of it cancels."""
    half = 0.5 * 10.0 ** (1 - digits)
    assert 0.01 * half < row_rounding(rounded(K, digits), T) < half


def test_supports_and_springs_are_no_rounding() -> None:
    """Rows beside a support leave a translation with a force; the others tell."""
    free = np.flatnonzero(np.repeat(MESH.points[:, 0] > 0, 3))
    held = csr_array(K[free][:, free])
    assert row_rounding(held, T[free]) < np.finfo(float).eps
    assert np.abs(held @ T[free]).max() > 1e-3 * np.abs(K).max()  # they do


def test_a_foundation_under_every_node_is_none() -> None:
    """1e-9 of the diagonal everywhere is far more than the rounding of any sum."""
    assert row_rounding(csr_array(K + diags_array(1e-9 * K.diagonal())), T) == 0.0


def test_nothing_to_translate() -> None:
    """A matrix of rotations alone."""
    assert row_rounding(K, np.zeros_like(T)) == 0.0
