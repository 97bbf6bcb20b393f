"""Effective masses against the mass of the part and the closed form of a rod."""

import numpy as np
from boxes import box
from systems import chain, system_of

from precompute.effective_mass import effective_mass, total_mass
from precompute.eigen import solve_modes

NONE = np.zeros(0, dtype=np.int64)


def test_all_modes_of_a_free_body_carry_its_mass() -> None:
    mesh = box("hex8", (2, 1, 1), (0.2, 0.1, 0.1))
    system = system_of(mesh)
    modes = solve_modes(system, NONE, count=system.K.shape[0])
    m = effective_mass(system, modes.Phi)
    assert m.shape == (3, system.K.shape[0])
    mass = 7850.0 * 0.2 * 0.1 * 0.1
    np.testing.assert_allclose(m.sum(axis=1), mass, rtol=1e-12)  # rounding
    # a free body: its translations carry all of it
    np.testing.assert_allclose(m[:, :3], mass * np.eye(3), atol=1e-12 * mass)


def test_a_rod_held_at_one_end() -> None:
    """Mode k of a rod fixed at one end is sin((2k − 1)πx/2L): (∫φ)²/∫φ² is 8/((2k − 1)²π²) of its length."""
    n = 1000
    system = chain(n, ground=1.0)
    m = effective_mass(system, solve_modes(system, NONE, count=3).Phi)
    k = np.arange(1, 4)
    # n masses against a continuous rod: an error of 1/n
    np.testing.assert_allclose(m[0] / n, 8 / ((2 * k - 1) ** 2 * np.pi**2), rtol=2 / n)
    assert not m[1:].any()


def test_a_beam_held_at_one_end_lacks_what_the_support_carries() -> None:
    """Σ m_k = gᵀ M_ff⁻¹ g with g = (M e)_f, over all modes; less than the mass, but not by half."""
    mesh = box("hex8", (4, 1, 1), (4.0, 1.0, 1.0))
    system = system_of(mesh)
    fixed = np.flatnonzero(np.repeat(mesh.points[:, 0] == 0, 3))
    free = np.setdiff1d(np.arange(system.K.shape[0]), fixed)
    modes = solve_modes(system, fixed, count=len(free))
    M = system.M.toarray()
    for k, total in enumerate(effective_mass(system, modes.Phi).sum(axis=1)):
        g = (M @ system.rigid[:, k])[free]
        expected = g @ np.linalg.solve(M[np.ix_(free, free)], g)
        np.testing.assert_allclose(total, expected, rtol=1e-10)  # 48 modes of a well-conditioned M
        assert 0.5 * total_mass(system) < total < total_mass(system)
