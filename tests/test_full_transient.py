"""The reduced model with all modes is the full model M ü + D u̇ + K u = F, by its matrix exponential."""

import numpy as np
import pytest
from boxes import box, steel
from interfaces import interface_at
from scipy.linalg import expm, sqrtm

from fmu_src.runtime.model import Port
from fmu_src.runtime.propagator import propagator
from fmu_src.runtime.step import at_rest, step
from precompute.arrays import Floats
from precompute.assembly import assemble
from precompute.damping import Damping, modal_ratio, rayleigh
from precompute.eigen import Modes, solve_modes
from precompute.ports import port_nodes
from precompute.reduction import reduce
from precompute.system import System

MESH = box("hex8", (3, 1, 1), (0.3, 0.1, 0.08))
FIXED = np.flatnonzero(np.repeat(MESH.points[:, 0] < 1e-9, 3))
FREE = np.setdiff1d(np.arange(3 * len(MESH.points)), FIXED)
TIP = np.flatnonzero(MESH.points[:, 0] > 0.3 - 1e-9)
ALPHA, BETA, RATIO = 40.0, 2e-6, 0.03
STEPS = 60


@pytest.fixture(scope="module")
def system() -> System:
    return assemble(MESH, steel(MESH))


@pytest.fixture(scope="module")
def modes(system: System) -> Modes:
    return solve_modes(system, FIXED, count=len(FREE))


def full_damping(M: Floats, K: Floats, form: str) -> Floats:
    """αM + βK, or D of one ratio without any modes: D = 2ζ M √(M⁻¹K), whose square root is the ωᵢ."""
    if form == "Rayleigh":
        return ALPHA * M + BETA * K
    return np.asarray(2 * RATIO * M @ sqrtm(np.linalg.solve(M, K)).real)


def full_response(system: System, form: str, h: float) -> Floats:
    """The tip's mean u_z after each step of e^{Ah}, 1 N held there: state [u, v/ω, 1], a typical ω."""
    M, K = (A.toarray()[np.ix_(FREE, FREE)] for A in (system.M, system.K))
    D = full_damping(M, K, form)
    n, omega = len(FREE), np.sqrt(np.linalg.norm(K) / np.linalg.norm(M))
    mean = np.isin(FREE, 3 * TIP + 2) / len(TIP)
    A = np.zeros((2 * n + 1, 2 * n + 1))
    A[:n, n : 2 * n] = omega * np.eye(n)
    A[n : 2 * n, :n] = -np.linalg.solve(M, K) / omega
    A[n : 2 * n, n : 2 * n] = -np.linalg.solve(M, D)
    A[n : 2 * n, -1] = np.linalg.solve(M, mean) / omega
    E = expm(A * h)
    state, u = np.eye(2 * n + 1)[-1], []
    for _ in range(STEPS):
        state = E @ state
        u.append(mean @ state[:n])
    return np.array(u)


def reduced_response(modes: Modes, damping: Damping, h: float, keep: int) -> Floats:
    """The same by the first `keep` modal oscillators."""
    tip = (Port("tip", ("force.z",), ("displacement.z",)), port_nodes(MESH, TIP, "equal", "tip"))
    model = reduce("bar", "", modes.lam, modes.Phi, damping, interface_at(MESH, [tip]))
    P = propagator(model.lam, model.damping(model.alpha, model.beta), h)
    kept = np.arange(len(model.lam)) < keep
    state, u = at_rest(len(model.lam)), []
    for _ in range(STEPS):
        state = step(P, state, np.where(kept, model.B[:, 0], 0.0))
        u.append(model.C[0] @ state.q)
    return np.array(u)


@pytest.mark.parametrize("form", ["Rayleigh", "one ratio"])
def test_all_modes_are_the_full_model(system: System, modes: Modes, form: str) -> None:
    """A step of force over a period of the first mode.

    2e-11: rounding of 2e-16 in E, times λ_max/λ₁ = 3·10³, over 60 steps.
    """
    damping = modal_ratio(modes.lam, RATIO) if form == "one ratio" else rayleigh(modes.lam, ALPHA, BETA)
    h = 2 * np.pi / np.sqrt(modes.lam[0]) / STEPS
    full = full_response(system, form, h)
    bound = 2e-11 * np.abs(full).max()
    assert np.abs(reduced_response(modes, damping, h, len(FREE)) - full).max() < bound
    # half of the modes are not enough, nor is a step longer by a part in 10⁷
    assert np.abs(reduced_response(modes, damping, h, len(FREE) // 2) - full).max() > 100 * bound
    assert np.abs(reduced_response(modes, damping, h * (1 + 1e-7), len(FREE)) - full).max() > 100 * bound
