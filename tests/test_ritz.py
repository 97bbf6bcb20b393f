"""Modes within a subspace: from above, rigid motions exactly, whatever the vectors are."""

import logging

import numpy as np
import pytest
from bodies import BAR, SUPPORTS, N, dense
from scipy.sparse import csr_array
from systems import along_x, chain, chain_free, chain_held

from precompute.eigen import solve_modes
from precompute.errors import EigenError, ZeroEnergyError
from precompute.orthonormal import orthonormal
from precompute.rigid import rigid_modes
from precompute.ritz import reduced_modes
from precompute.system import System

RNG = np.random.default_rng(3)
NO_RIGID = np.zeros((N, 0))


class TestOrthonormal:
    def test_same_span_whatever_the_scales(self) -> None:
        V = RNG.standard_normal((N, 8)) * 10.0 ** np.arange(-20, 20, 5)
        Q = orthonormal(V, BAR.M)
        np.testing.assert_allclose(Q.T @ (BAR.M @ Q), np.eye(8), atol=1e-13)  # rounding
        outside = V - Q @ (Q.T @ (BAR.M @ V))
        np.testing.assert_array_less(np.linalg.norm(outside, axis=0), 1e-12 * np.linalg.norm(V, axis=0))

    @pytest.mark.parametrize(("part", "rank"), [(0.0, 5), (1e-9, 5), (1e-4, 6)])  # below and above 3e-7
    def test_what_depends_on_others_is_left_out(self, part: float, rank: int) -> None:
        V = RNG.standard_normal((N, 6))
        V[:, 5] = V[:, :5].sum(axis=1) + part * V[:, 5]
        Q = orthonormal(V, BAR.M)
        assert Q.shape[1] == rank
        np.testing.assert_allclose(Q.T @ (BAR.M @ Q), np.eye(rank), atol=1e-13)

    def test_vectors_without_mass_are_left_out(self) -> None:
        system = chain(4)
        M = system.M.copy()
        M[0, 0] = 0.0
        assert orthonormal(np.eye(4), M).shape == (4, 3)


class TestModes:
    @pytest.mark.parametrize(("ground", "rigid"), [(0.0, 1), (1.0, 0)])
    def test_all_vectors_give_all_modes(self, ground: float, rigid: int) -> None:
        system = chain(12, ground)
        R = rigid_modes(system, np.zeros(0, dtype=np.int64))
        modes = reduced_modes(RNG.standard_normal((12, 12)), system, R, "")
        assert modes.rigid == rigid
        np.testing.assert_allclose(
            modes.lam, (chain_held if ground else chain_free)(12, 12), rtol=1e-12, atol=0
        )  # rounding; the rigid one is exactly 0

    def test_what_has_no_mass_follows_statically(self) -> None:
        """Two springs of 2 N/m with a massless point between them are one of 1 N/m, in any vectors."""
        n = 6
        K = 2 * chain(2 * n - 1).K
        M = np.zeros(2 * n - 1)
        M[::2] = 1.0
        system = System(csr_array(np.diag(M)), csr_array(K), along_x(2 * n - 1))
        V = RNG.standard_normal((2 * n - 1, 2 * n - 1))
        modes = reduced_modes(V, system, rigid_modes(system, np.zeros(0, dtype=np.int64)), "")
        assert modes.rigid == 1
        np.testing.assert_allclose(modes.lam[1:], chain_free(n, n)[1:], rtol=1e-11)  # κ(V) ε
        between = (modes.Phi[:-1:2] + modes.Phi[2::2]) / 2
        np.testing.assert_allclose(modes.Phi[1::2], between, atol=1e-11)

    def test_from_above_and_never_rising(self) -> None:
        fixed = SUPPORTS["clamped"]
        V = RNG.standard_normal((N, 40))
        V[fixed] = 0.0
        full = dense(BAR, fixed).modes()[0]
        before = np.full(10, np.inf)
        for k in (10, 20, 40):
            lam = reduced_modes(V[:, :k], BAR, NO_RIGID, "").lam
            assert np.all(lam[:10] < before)
            assert np.all(lam > full[:k])
            before = lam[:10]

    def test_the_vectors_may_be_mixed_and_scaled(self) -> None:
        modes = solve_modes(BAR, SUPPORTS["hinge"], count=8)
        R = rigid_modes(BAR, SUPPORTS["hinge"])
        mixed = modes.Phi @ RNG.standard_normal((8, 8)) * 10.0 ** np.arange(-4, 4)
        again = reduced_modes(mixed, BAR, R, "")
        np.testing.assert_allclose(again.lam, modes.lam, rtol=1e-8, atol=0)  # κ² ε of the random mixture
        np.testing.assert_allclose(again.Phi, modes.Phi, atol=1e-6 * np.abs(modes.Phi).max())


class TestRigidMotions:
    R = rigid_modes(BAR, SUPPORTS["free"])
    elastic = solve_modes(BAR, SUPPORTS["free"], count=9).Phi[:, 6:]

    def test_are_exact_where_the_vectors_contain_them(self) -> None:
        V = np.column_stack([self.elastic, self.R]) @ RNG.standard_normal((9, 9))
        modes = reduced_modes(V, BAR, self.R, "")
        np.testing.assert_array_equal(modes.Phi[:, :6], self.R)
        np.testing.assert_array_equal(modes.lam[:6], 0)
        assert modes.lam[6] > 0

    def test_some_of_them(self, caplog: pytest.LogCaptureFixture) -> None:
        V = np.column_stack([self.elastic, self.R[:, 0] + self.R[:, 1], self.R[:, 2]])
        modes = reduced_modes(V, BAR, self.R, "")
        assert modes.rigid == 2
        inside = self.R.T @ (BAR.M @ modes.Phi[:, :2])
        np.testing.assert_allclose(inside[3:], 0, atol=1e-12)
        np.testing.assert_allclose(inside[0], inside[1], atol=1e-12)
        assert "lacks 4 of the 6 rigid motions" in caplog.text

    def test_near_ones_are_not_taken_for_rigid(self) -> None:
        V = self.R + 1e-3 * self.elastic @ RNG.standard_normal((3, 6))
        modes = reduced_modes(V, BAR, self.R, "")
        assert modes.rigid == 3  # 6 motions less 3 directions in which they bend
        assert np.all(modes.lam[3:] > 0)


class TestRefusedAndSaid:
    def test_dependent_vectors(self, caplog: pytest.LogCaptureFixture) -> None:
        V = RNG.standard_normal((N, 3))
        with caplog.at_level(logging.INFO):
            modes = reduced_modes(np.column_stack([V, V, 0 * V]), BAR, NO_RIGID, "")
        assert len(modes.lam) == 3
        assert "6 of 9 vectors depend on the others" in caplog.text

    def test_nothing(self) -> None:
        with pytest.raises(EigenError, match="no motion that has mass"):
            reduced_modes(np.zeros((N, 2)), BAR, NO_RIGID, "")

    def test_not_finite(self) -> None:
        with pytest.raises(EigenError, match="not finite"):
            reduced_modes(np.full((N, 1), np.nan), BAR, NO_RIGID, "")

    def test_an_elastic_motion_without_energy(self) -> None:
        """A basis that moves one of two pieces against the other."""
        K = BAR.K.copy()
        K.data[:] = 0.0
        with pytest.raises(ZeroEnergyError, match="beyond the 0 rigid ones"):
            reduced_modes(RNG.standard_normal((N, 1)), System(BAR.M, K, BAR.rigid), NO_RIGID, "")
