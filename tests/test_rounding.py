"""What counts as no energy, by the digits of K."""

import numpy as np
import pytest
from boxes import box, mapped, steel
from scipy.sparse import csr_array

from precompute.assembly import assemble
from precompute.rounding import EPS, ZERO, eigenvalue_noise, energies, rounding_shown, without_energy

MESH = mapped(box("hex8", (2, 2, 2)), lambda p: p + 0.1 * np.sin(7 * p[:, [1, 2, 0]]))
SYSTEM = assemble(MESH, steel(MESH))


def printed(K: csr_array, digits: int) -> csr_array:
    """K as a file with so many digits gives it back, symmetric."""
    return csr_array(np.vectorize(lambda a: float(f"{a:.{digits - 1}e}"))(K.toarray()))


@pytest.mark.parametrize("digits", [5, 7, 9, 12])
def test_rigid_motions_of_a_printed_stiffness(digits):
    """Each entry is off by half a unit of its last digit at most, so |φᵀδKφ| ≤ ε|φ|ᵀ|K||φ|: always free."""
    K = printed(SYSTEM.K, digits)
    assert without_energy(K, SYSTEM.rigid, 0.5 * 10.0 ** (1 - digits)).all()
    energy, rounding = energies(K, SYSTEM.rigid)
    assert np.all(np.abs(energy) > ZERO * rounding)  # what double precision alone would take for a spring


@pytest.mark.parametrize("digits", [6, 12])
def test_springs_beyond_the_digits_are_seen(digits):
    """A spring to ground of 10 units of the last digit of all entries together."""
    precision = 0.5 * 10.0 ** (1 - digits)
    t = SYSTEM.rigid[:, 0]
    K = printed(SYSTEM.K, digits).tolil()
    K[0, 0] += 20 * precision * float(t @ (abs(SYSTEM.K) @ t))
    left = without_energy(csr_array(K), SYSTEM.rigid, precision)
    assert left.tolist()[:3] == [False, True, True]


def test_negative_energy_of_rigid_motions_shows_rounding():
    """δK = −10⁻¹²|K| gives every motion at most that, relative; the larger or positive is none."""
    K, R = SYSTEM.K, SYSTEM.rigid
    assert rounding_shown(K, R) < 2 * EPS
    assert 0.9e-12 < rounding_shown(csr_array(K - 1e-12 * abs(K)), R) < 2e-12
    assert rounding_shown(csr_array(K + 1e-12 * abs(K)), R) < 2 * EPS
    assert rounding_shown(csr_array(K - 1e-6 * abs(K)), R) == 0.0  # an indefinite K


def test_motions_that_are_not_known_show_nothing():
    R = SYSTEM.rigid.copy()
    R[:, 3:] = 0.0
    assert rounding_shown(csr_array(SYSTEM.K - 1e-12 * abs(SYSTEM.K)), R) > 0.9e-12


def test_noise_grows_with_precision():
    t = SYSTEM.rigid[:, :3]
    fine = eigenvalue_noise(SYSTEM.K, SYSTEM.M, t)
    assert eigenvalue_noise(SYSTEM.K, SYSTEM.M, t, 1e4 * EPS) == pytest.approx(1e4 * fine, rel=1e-12)
