"""None missed: the count below s, gaps, and what happens when a mode is dropped."""

import numpy as np
import pytest
from scipy.sparse import csr_array, diags
from systems import SOLVERS, chain, chain_free, chain_held, copies

from precompute.arrays import Floats
from precompute.errors import EigenError
from precompute.factor import Solver, factoriser
from precompute.lanczos import check_memory, extend, residuals
from precompute.pencil import Pairs, Pencil, nothing
from precompute.rounding import eigenvalue_noise
from precompute.sturm import count_below, gap_above, lowest_modes
from precompute.system import System


def pencil_of(system: System, rigid: Floats | None = None) -> Pencil:
    none = np.zeros((system.K.shape[0], 0))
    noise = eigenvalue_noise(system.K, system.M, system.rigid[:, :3])
    return Pencil(system.K, system.M, none if rigid is None else rigid, noise)


class TestGap:
    @pytest.mark.parametrize(
        ("wanted", "ceiling", "expected"),
        [
            (1, 0.0, (1, 2.0)),
            (2, 0.0, (3, 4.0)),  # 3, 3 is a pair: not cut
            (1, 3.5, (3, 3.5)),  # all below the ceiling, and the ceiling itself where it is clear
            (3, 4.5, (3, 4.5)),
            (1, 3.0, (3, 4.0)),  # not in a cluster
            (1, 5.0 * (1 - 1e-9), (4, 6.0)),  # nor too near the next one
            (4, 0.0, (4, 6.0)),
        ],
    )
    def test_place(self, wanted: int, ceiling: float, expected: tuple[int, float]) -> None:
        assert gap_above(np.array([1.0, 3.0, 3.0, 5.0, 7.0]), wanted, ceiling, noise=1e-12) == expected

    def test_a_cluster_at_the_end_needs_more(self) -> None:
        assert gap_above(np.array([1.0, 3.0, 3.0 * (1 + 1e-9)]), 2, 0.0, noise=1e-12) is None

    def test_a_gap_within_rounding_is_none(self) -> None:
        lam = np.array([1.0, 1.1])
        assert gap_above(lam, 1, 0.0, noise=1e-12) is not None
        assert gap_above(lam, 1, 0.0, noise=1e-2) is None


@pytest.mark.parametrize("solver", SOLVERS)
class TestCount:
    def test_closed_form(self, solver: Solver) -> None:
        lam = chain_held(700, 700)
        pencil = pencil_of(chain(700, ground=1.0))
        with factoriser(solver) as factorise:
            for j in (1, 20, 350):
                assert count_below(pencil, factorise, 0.5 * (lam[j - 1] + lam[j])) == j

    def test_rigid_modes_are_not_counted(self, solver: Solver) -> None:
        n = 700
        lam = chain_free(n, 10)
        pencil = pencil_of(chain(n), np.full((n, 1), n**-0.5))
        with factoriser(solver) as factorise:
            assert count_below(pencil, factorise, 0.5 * (lam[4] + lam[5])) == 4

    @pytest.mark.parametrize("drop", [0, 3, 7])
    @pytest.mark.parametrize("counts", [True, False])  # without a count a second search must find it
    def test_a_dropped_mode_is_found(self, solver: Solver, drop: int, counts: bool) -> None:
        pencil = pencil_of(chain(700, ground=1.0))
        searches = []

        with factoriser(solver) as factorise:

            def forgetful(known: Pairs, k: int) -> Pairs:
                pairs = extend(pencil, factorise(pencil.shifted(pencil.sigma)), known, k)
                searches.append(k)
                if len(searches) > 1:
                    return pairs
                keep = np.arange(len(pairs.lam)) != drop
                return Pairs(pairs.lam[keep], pairs.Phi[:, keep], pairs.solver)

            def count(s: float) -> int | None:
                return count_below(pencil, factorise, s) if counts else None

            pairs = lowest_modes(pencil, forgetful, count, wanted=10)
        assert len(searches) > 1  # it was noticed
        np.testing.assert_allclose(pairs.lam[:10], chain_held(700, 10), rtol=1e-10)  # ε λ_max/λ₁ = 2e-10

    def test_a_mode_that_cannot_be_found_is_an_error(self, solver: Solver) -> None:
        pencil = pencil_of(chain(700, ground=1.0))
        with factoriser(solver) as factorise:

            def blind(known: Pairs, k: int) -> Pairs:
                pairs = extend(pencil, factorise(pencil.shifted(pencil.sigma)), known, k)
                return Pairs(pairs.lam[1:], pairs.Phi[:, 1:], pairs.solver)

            with pytest.raises(EigenError, match=r"were found below .* counts"):
                lowest_modes(pencil, blind, lambda s: count_below(pencil, factorise, s), wanted=4)


@pytest.mark.parametrize("solver", SOLVERS)
class TestExtend:
    def test_only_new_ones(self, solver: Solver) -> None:
        system, lam = copies(10, 70, gap=0.0)  # ten of each
        pencil = pencil_of(system)
        with factoriser(solver) as factorise:
            factor = factorise(pencil.shifted(pencil.sigma))
            pairs = extend(pencil, factor, extend(pencil, factor, nothing(pencil), 4), 6)
        assert len(pairs.lam) == 10
        np.testing.assert_allclose(pairs.Phi.T @ (pencil.M @ pairs.Phi), np.eye(10), atol=1e-12)
        distance = np.min(np.abs(pairs.lam[:, None] / lam - 1), axis=1)
        np.testing.assert_array_less(distance, 1e-10)  # ε λ_max/λ₁ = 2e-12, with room

    def test_the_residual_measures_the_error(self, solver: Solver) -> None:
        """φ₁ + δφ₂ has the residual δ(λ₂ − λ₁)/(λ₂ − σ) in the norm of (K − σM)⁻¹, λ₁ and its δ² aside."""
        pencil, delta = pencil_of(chain(700, ground=1.0)), 1e-4
        with factoriser(solver) as factorise:
            factor = factorise(pencil.shifted(pencil.sigma))
            pairs = extend(pencil, factor, nothing(pencil), 3)
            bent = Pairs(pairs.lam[:1], pairs.Phi[:, :1] + delta * pairs.Phi[:, 1:2], "")
            exact = residuals(pencil, factor, pairs)
            assert np.max(exact) < 1e-8
            expected = delta * (pairs.lam[1] - pairs.lam[0]) / pairs.lam[1]
            np.testing.assert_allclose(residuals(pencil, factor, bent), expected, rtol=1e-3)

    def test_a_factor_of_another_matrix_is_noticed(self, solver: Solver) -> None:
        """Modes found with a factor that is off by a part in a thousand, unevenly, are not those of K."""
        pencil = pencil_of(chain(700, ground=1.0))
        uneven = diags(1e-3 * np.linspace(0, 1, 700) * pencil.K.diagonal())
        with factoriser(solver) as factorise:
            wrong = factorise(csr_array(pencil.shifted(pencil.sigma) + uneven))
            with pytest.raises(EigenError, match="residual"):
                extend(pencil, wrong, nothing(pencil), 3)

    def test_without_a_count_a_second_search_decides(self, solver: Solver) -> None:
        """The first search misses two modes, the second one of them; with no inertia known it goes on."""
        pencil = pencil_of(chain(700, ground=1.0))
        searches: list[int] = []
        with factoriser(solver) as factorise:

            def forgetful(known: Pairs, k: int) -> Pairs:
                searches.append(k)
                pairs = extend(pencil, factorise(pencil.shifted(pencil.sigma)), known, k)
                first = slice({1: 2, 2: 1}.get(len(searches), 0), None)
                return Pairs(pairs.lam[first], pairs.Phi[:, first], pairs.solver)

            pairs = lowest_modes(pencil, forgetful, lambda s: None, wanted=5)
        assert len(searches) > 2
        np.testing.assert_allclose(pairs.lam[:5], chain_held(700, 5), rtol=1e-10)  # ε λ_max/λ₁ = 2e-10


def test_memory() -> None:
    check_memory(7.9e9, 10, 100)
    with pytest.raises(EigenError, match=r"5000 of 300000 free DOFs would need 12\.5 GB"):
        check_memory(12.5e9, 5000, 300_000)
