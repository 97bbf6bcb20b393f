"""Sparse symmetric factors: solutions, inertia, choice of the solver."""

import sys

import numpy as np
import pytest
from scipy.sparse import csr_array, random
from systems import SOLVERS, chain, chain_held

from precompute.arrays import Floats
from precompute.errors import EigenError
from precompute.factor import Solver, SuperLU, choose, factoriser
from precompute.pardiso import library


def symmetric(n: int, shift: float, seed: int = 0) -> csr_array:
    A = csr_array(random(n, n, density=0.05, random_state=np.random.default_rng(seed), format="csr"))
    return csr_array(A + A.T + shift * csr_array(np.eye(n)))


@pytest.mark.parametrize("solver", SOLVERS)
class TestFactor:
    @pytest.mark.parametrize("shift", [20.0, 0.7])  # positive definite; indefinite
    @pytest.mark.parametrize("columns", [(), (1,), (7,)])
    def test_solves(self, solver: Solver, shift: float, columns: tuple[int, ...]) -> None:
        A = symmetric(120, shift)
        x = np.random.default_rng(1).standard_normal((120, *columns))
        with factoriser(solver) as factorise:
            got = factorise(A).solve(A @ x)
        assert got.shape == x.shape
        # ε · condition (< 1e4 here) · growth of a factor without full pivoting
        np.testing.assert_allclose(got, x, rtol=0, atol=1e-9)

    def test_counts_eigenvalues_below(self, solver: Solver) -> None:
        system, lam = chain(200, ground=1.0), chain_held(200, 200)
        with factoriser(solver) as factorise:
            for j in (0, 1, 57, 100, 199, 200):
                s = 0.5 * (np.r_[-1.0, lam][j] + np.r_[lam, 5.0][j])
                assert factorise(csr_array(system.K - s * system.M)).negative_pivots() == j

    def test_small_pivots_keep_their_sign(self, solver: Solver) -> None:
        """det = ±1e-12: a pivot "perturbed" to 1e-8 or 1e-13 of the norm would count both alike."""
        with factoriser(solver) as factorise:
            for sign, negative in ((1.0, 0), (-1.0, 1)):
                A = csr_array(np.array([[1.0, 1.0], [1.0, 1.0 + sign * 1e-12]]))
                assert factorise(A).negative_pivots() == negative

    def test_a_new_matrix_replaces_the_one_before(self, solver: Solver) -> None:
        b = np.ones(50)
        with factoriser(solver) as factorise:
            for A in (symmetric(50, 20.0), 3.0 * symmetric(50, 20.0), symmetric(50, 20.0, seed=4)):
                np.testing.assert_allclose(A @ factorise(csr_array(A)).solve(b), b, atol=1e-12)

    def test_same_bits_twice(self, solver: Solver) -> None:
        A, b = symmetric(2000, 300.0), np.random.default_rng(2).standard_normal(2000)
        bits = set()
        for _ in range(3):
            with factoriser(solver) as factorise:
                bits.add(factorise(A).solve(b).tobytes())
        assert len(bits) == 1

    def test_sizes(self, solver: Solver) -> None:
        with factoriser(solver) as factorise, pytest.raises((EigenError, ValueError)):
            factorise(symmetric(50, 20.0)).solve(np.ones(49))

    def test_singular(self, solver: Solver) -> None:
        A = csr_array(np.diag([1.0, 0.0, 2.0]))
        with factoriser(solver) as factorise, pytest.raises(EigenError, match="expected"):
            factorise(A)


class TestUnsureSigns:
    """A diagonal of 1e-18: pivots taken from it destroy all digits of what follows."""

    @staticmethod
    def matrix(seed: int) -> Floats:
        A = np.random.default_rng(seed).standard_normal((12, 12))
        A = A + A.T
        np.fill_diagonal(A, 1e-18)
        return A

    @pytest.mark.parametrize("seed", range(3))
    def test_superlu_says_that_it_does_not_know(self, seed: int) -> None:
        A = self.matrix(seed)
        with factoriser("superlu") as factorise:
            factor = factorise(csr_array(A))
            assert factor.negative_pivots() is None
            assert isinstance(factor, SuperLU)
            assert np.sum(factor.lu.U.diagonal() < 0) != np.sum(
                np.linalg.eigvalsh(A) < 0
            )  # it would be wrong

    @pytest.mark.parametrize("seed", range(3))
    def test_pardiso_pivots(self, seed: int) -> None:
        pytest.importorskip("pypardiso")
        A = self.matrix(seed)
        with factoriser("pardiso") as factorise:
            assert factorise(csr_array(A)).negative_pivots() == np.sum(np.linalg.eigvalsh(A) < 0)

    def test_pivots_off_the_diagonal(self) -> None:
        with factoriser("superlu") as factorise:
            assert factorise(csr_array(np.array([[0.0, 1.0], [1.0, 0.0]]))).negative_pivots() is None


class TestChoice:
    def test_without_pardiso(self, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setitem(sys.modules, "pypardiso", None)  # as where it is not installed
        library.cache_clear()
        assert choose("auto") == "superlu"
        with pytest.raises(EigenError, match=r"modalfmu\[fast\]"):
            choose("pardiso")
        library.cache_clear()

    def test_unknown(self) -> None:
        with pytest.raises(EigenError, match='"superlu" or "pardiso"'):
            choose("mumps")  # type: ignore[arg-type]  # a typing mistake of the user's

    def test_auto_takes_pardiso(self) -> None:
        pytest.importorskip("pypardiso")
        assert choose("auto") == "pardiso"
