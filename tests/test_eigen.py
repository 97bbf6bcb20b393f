"""K φ = λ M φ: closed forms, planted multiplicities, rigid bodies, requests that cannot be met."""

import logging

import numpy as np
import pytest
from boxes import box
from scipy.linalg import eigh
from scipy.sparse import csr_array, diags
from systems import (
    SOLVERS,
    chain,
    chain_free,
    chain_held,
    copies,
    dofs_where,
    hollow_sphere,
    ring,
    system_of,
)

from precompute.arrays import Ints
from precompute.canonical import clusters
from precompute.eigen import Modes, solve_modes
from precompute.errors import EigenError
from precompute.factor import Solver
from precompute.system import System

NONE = np.zeros(0, dtype=np.int64)


def check(system: System, fixed: Ints, modes: Modes) -> None:
    """ΦᵀMΦ = I, ΦᵀKΦ = Λ, zero at the supports, rigid ones exactly 0."""
    r = len(modes.lam)
    np.testing.assert_allclose(
        modes.Phi.T @ (system.M @ modes.Phi), np.eye(r), atol=1e-12
    )  # rounding, twice done
    KPhi = modes.Phi.T @ (system.K @ modes.Phi)
    # clusters are mixed within 1e-8 of λ
    np.testing.assert_allclose(KPhi, np.diag(modes.lam), atol=2e-8 * modes.lam[-1])
    assert not modes.Phi[fixed].any()
    assert not modes.lam[: modes.rigid].any()
    assert np.all(np.diff(modes.lam[modes.rigid :]) >= 0)
    assert np.all(modes.lam[modes.rigid :] > 0)


@pytest.mark.parametrize("solver", SOLVERS)
class TestClosedForms:
    def test_free_chain(self, solver: Solver) -> None:
        modes = solve_modes(chain(900), NONE, count=12, solver=solver)
        assert modes.rigid == 1
        check(chain(900), NONE, modes)
        np.testing.assert_allclose(modes.lam, chain_free(900, 12), rtol=1e-10)  # ε λ_max/λ₁ = 7e-11
        np.testing.assert_allclose(np.abs(modes.Phi[:, 0]), 900**-0.5, rtol=1e-13)

    def test_held_chain(self, solver: Solver) -> None:
        """A fixed first mass is a spring to ground for the 899 others."""
        modes = solve_modes(chain(900), np.array([0]), count=12, solver=solver)
        check(chain(900), np.array([0]), modes)
        np.testing.assert_allclose(modes.lam, chain_held(899, 12), rtol=3e-10)  # ε λ_max/λ₁ = 3e-10

    @pytest.mark.parametrize("n", [1, 2, 7, 700])
    def test_all_modes(self, solver: Solver, n: int) -> None:
        system = (
            System(csr_array([[2.0]]), csr_array([[8.0]]), np.ones((1, 6)))
            if n == 1
            else chain(n, ground=1.0)
        )
        modes = solve_modes(system, NONE, count=n, solver=solver)
        check(system, NONE, modes)
        np.testing.assert_allclose(modes.lam, [4.0] if n == 1 else chain_held(n, n), rtol=1e-9)  # ε λ_max/λ₁

    def test_ring(self, solver: Solver) -> None:
        """Thin ring, n waves: pairs, in its plane ω² = EI/(ρAR⁴) n²(n² − 1)²/(n² + 1) (Love)."""
        R, t = 1.0, 0.1
        modes = solve_modes(system_of(ring(48, R, t, t)), NONE, count=14, solver=solver)
        f = modes.frequencies[6:]
        np.testing.assert_allclose(f[0::2], f[1::2], rtol=1e-9)  # symmetric under a quarter turn
        thin = 6 / np.sqrt(5) * np.sqrt(210e9 * t**2 / 12 / 7850.0) / (2 * np.pi * R**2)
        assert f[2] == pytest.approx(thin, rel=0.005)  # shear and rotary inertia are of order (t/R)²/4

    def test_sides_of_the_two_ways(self, solver: Solver) -> None:
        """Lanczos and LAPACK, on the same system."""
        system = system_of(box("hex8", (6, 5, 4)))
        some = solve_modes(system, NONE, count=20, solver=solver)
        every = solve_modes(system, NONE, count=system.K.shape[0], solver=solver)
        assert some.solver.startswith("Lanczos")
        assert every.solver.startswith("dense")
        check(system, NONE, every)
        np.testing.assert_allclose(some.lam, every.lam[:20], rtol=1e-9)
        np.testing.assert_allclose(some.Phi, every.Phi[:, :20], atol=1e-6 * np.max(np.abs(some.Phi)))


@pytest.mark.parametrize("solver", SOLVERS)
class TestNoneMissed:
    def test_cube(self, solver: Solver) -> None:
        """The cube's symmetries make single, double and triple eigenvalues; LAPACK misses none."""
        system = system_of(box("hex8", (5, 5, 5)))
        modes = solve_modes(system, NONE, count=40, solver=solver)
        check(system, NONE, modes)
        dense = eigh(system.K.toarray(), system.M.toarray(), eigvals_only=True)[6:40]
        np.testing.assert_allclose(modes.lam[6:], dense, rtol=1e-8)  # dense: ε λ_max, 1e-10 of λ₁
        sizes = {c.stop - c.start for c in clusters(modes.lam[6:])}
        assert {1, 2, 3} <= sizes

    def test_hollow_sphere(self, solver: Solver) -> None:
        """Five-fold families, which the mesh (a cube's symmetry) splits by 1e-3 into two and three."""
        modes = solve_modes(system_of(hollow_sphere(3, 0.5, 1.0)), NONE, count=16, solver=solver)
        for family in (modes.lam[6:11], modes.lam[11:16]):
            assert np.ptp(family) < 2e-3 * family[0]
            assert sorted(c.stop - c.start for c in clusters(family)) == [2, 3]
        assert modes.lam[11] > 1.5 * modes.lam[10]

    @pytest.mark.parametrize("gap", [0.0, 1e-9, 1e-7, 1e-5])
    @pytest.mark.parametrize("count", [1, 7, 30, 45])
    def test_copies(self, solver: Solver, gap: float, count: int) -> None:
        """Thirty identical parts side by side; a Krylov space holds one vector of each eigenspace only."""
        system, lam = copies(30, 25, gap)
        modes = solve_modes(system, NONE, count=count, solver=solver)
        assert modes.solver.startswith("Lanczos")
        np.testing.assert_allclose(modes.lam, lam[:count], rtol=1e-12)  # ε λ_max/λ₁ = 2e-13

    def test_without_mass(self, solver: Solver) -> None:
        """DOFs without mass follow statically: two springs in series where one mass is 0."""
        system = chain(901, ground=1.0)
        M = system.M.tolil()
        M[450, 450] = 0.0
        massless = System(csr_array(M.tocsr()), system.K, system.rigid)
        few = solve_modes(massless, NONE, count=10, solver=solver)
        every = solve_modes(massless, NONE, count=900, solver=solver)
        np.testing.assert_allclose(few.lam, every.lam[:10], rtol=2e-9)  # dense: ε λ_max/λ₁ = 3e-10
        with pytest.raises(EigenError, match="got 901, the part has 900 free DOFs with mass"):
            solve_modes(massless, NONE, count=901, solver=solver)

    def test_few_masses(self, solver: Solver) -> None:
        """Two masses on a long row of springs: √(k/m) of two degrees of freedom in series."""
        n = 600  # springs of 1 N/m: n/2 of them to the first mass, n/2 on to the second
        M = np.zeros(n)
        M[[n // 2 - 1, n - 1]] = 1.0
        system = System(csr_array(diags([M], [0])), chain(n, ground=1.0).K, chain(n).rigid)
        modes = solve_modes(system, NONE, count=2, solver=solver)
        golden = np.array([3 - np.sqrt(5), 3 + np.sqrt(5)]) / 2
        np.testing.assert_allclose(modes.lam, golden * 2 / n, rtol=1e-10)  # ε times the condition of K, 1e5


@pytest.mark.parametrize("solver", SOLVERS)
def test_same_bits_twice(solver: Solver) -> None:
    mesh = box("tet10", (3, 3, 3))
    system, fixed = system_of(mesh), dofs_where(mesh, mesh.points[:, 2] == 0)
    first, second = (solve_modes(system, fixed, count=12, solver=solver) for _ in range(2))
    assert first.lam.tobytes() == second.lam.tobytes()
    assert first.Phi.tobytes() == second.Phi.tobytes()


@pytest.mark.parametrize("solver", SOLVERS)
def test_it_says_what_goes_on(solver: Solver, caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.INFO, logger="modalfmu")
    lines: list[str] = []
    modes = solve_modes(chain(700), NONE, count=12, solver=solver, progress=lines.append)
    assert modes.solver == {"superlu": "Lanczos, SuperLU", "pardiso": "Lanczos, PARDISO"}[solver]
    assert modes.solver in caplog.text
    assert "rigid modes: 1," in caplog.text
    assert lines[0] == "factorising"
    assert "Lanczos: 20 solves" in lines
