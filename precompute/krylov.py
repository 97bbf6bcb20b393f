"""A subspace that matches the moments of the frequency response about one frequency."""

from collections.abc import Callable

import numpy as np

from .arrays import Floats
from .errors import EigenError
from .factor import Solver, factoriser
from .notice import notice
from .orthonormal import extended
from .statics import StaticSolver

NEW = 1e-8  # of a vector must be M-orthogonal to those before it; less is their rounding
NEAR = 1e-8  # |λ − ω²|/ω²: nearer to a resonance its mode drowns all that else answers


def krylov(b: Floats, count: int, frequency: float, solve: StaticSolver, solver: Solver = "auto") -> Floats:
    """span of the rigid modes and (A⁻¹M)ʲ A⁻¹ b, j = 0, 1, …, A = K − ω²M, ω = 2πf: (n, count).

    b: (n, m) loads; at f = 0 A⁻¹ is K⁺, with inertia relief. The response bᵀ(K + s²M)⁻¹b of a Galerkin model
    of q whole blocks matches 2q terms of its series in s² about −ω². Rigid modes are kept even beyond
    `count`; a space that is exhausted gives fewer vectors, with a notice.
    Raises EigenError: no load, or f is a resonance.
    Source: Su & Craig, J. Guidance 14 (1991); Antoulas, Approximation of Large-Scale Dynamical Systems, 11.
    """
    b = b[:, solve.deforms(b)]
    if b.shape[1] == 0:
        raise EigenError(
            'basis: kind = "krylov" starts from the inputs, got none that deforms the part; add one'
        )
    if frequency == 0:
        return _blocks(b, count, solve, solve)
    omega2 = (2 * np.pi * frequency) ** 2
    free = np.flatnonzero(~solve.held)
    A = (solve.system.K - omega2 * solve.system.M)[free][:, free]
    with factoriser(solver) as factorise:
        factor = factorise(A)

        def at_frequency(load: Floats) -> Floats:
            x = np.zeros(load.shape)
            x[free] = factor.solve(load[free])
            inertia = omega2 * np.linalg.norm(solve.system.M @ x, axis=0)
            if np.any(np.linalg.norm(load, axis=0) < NEAR * inertia):
                raise EigenError(
                    f"basis: frequency {frequency:g} Hz is a resonance, expected one off it; move it a little"
                )
            return x

        return _blocks(b, count, solve, at_frequency)


def _blocks(b: Floats, count: int, solve: StaticSolver, inverse: Callable[[Floats], Floats]) -> Floats:
    M = solve.system.M
    V = solve.rigid
    block = b
    while V.shape[1] < count:
        known = V.shape[1]
        V = extended(V, inverse(block), M, NEW)[:, :count]
        if V.shape[1] == known:
            notice(f"basis: {known} vectors span all that the inputs reach; count asked for {count}")
            break
        block = M @ V[:, known:]
    return V
