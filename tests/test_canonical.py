"""One choice among equal eigenvectors."""

import numpy as np
import pytest

from precompute.canonical import canonical, canonical_vectors, clusters
from precompute.pencil import Pairs

RNG = np.random.default_rng(3)


def orthonormal(n: int, m: int) -> np.ndarray:
    return np.linalg.qr(RNG.standard_normal((n, m)))[0]


@pytest.mark.parametrize("m", [1, 2, 3, 7])
def test_any_basis_gives_the_same_vectors(m: int) -> None:
    Phi = orthonormal(60, m)
    first = canonical_vectors(Phi)
    for _ in range(5):
        np.testing.assert_allclose(canonical_vectors(Phi @ orthonormal(m, m)), first, atol=1e-13)  # rounding
    np.testing.assert_allclose(first @ first.T, Phi @ Phi.T, atol=1e-14)  # the same space


def test_the_sign_of_a_single_vector() -> None:
    np.testing.assert_array_equal(
        canonical_vectors(np.array([[1.0], [-3.0], [2.0]])), [[-1.0], [3.0], [-2.0]]
    )


def test_components_equal_but_for_rounding_leave_the_choice_to_the_first() -> None:
    v = np.array([[0.5], [-1.0], [1.0 + 1e-9]])
    np.testing.assert_array_equal(canonical_vectors(v), -v)
    clear = np.array([[0.5], [-1.0], [1.0 + 1e-3]])
    np.testing.assert_array_equal(canonical_vectors(clear), clear)


def test_pivots() -> None:
    """The first vector alone moves the DOF that moves most."""
    Phi = canonical_vectors(orthonormal(40, 3))
    pivot = int(np.argmax(np.linalg.norm(Phi, axis=1)))
    assert Phi[pivot, 0] > 0
    np.testing.assert_allclose(Phi[pivot, 1:], 0, atol=1e-15)


def test_clusters() -> None:
    lam = np.array([1.0, 2.0, 2.0 * (1 + 5e-9), 3.0, 3.0 * (1 + 1e-6)])
    assert clusters(lam) == [slice(0, 1), slice(1, 3), slice(3, 4), slice(4, 5)]


def test_only_clusters_are_mixed() -> None:
    Phi = orthonormal(30, 3)
    got = canonical(Pairs(np.array([1.0, 1.0, 2.0]), Phi, "")).Phi
    np.testing.assert_allclose(got[:, :2] @ got[:, :2].T, Phi[:, :2] @ Phi[:, :2].T, atol=1e-14)
    np.testing.assert_allclose(np.abs(got[:, 2]), np.abs(Phi[:, 2]), atol=1e-15)
