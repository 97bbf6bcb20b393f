"""The modes of a part whose interface does not move: K φ + W μ = λ M φ with Wᵀφ = 0."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np
from scipy.linalg import eigh, lu_factor, lu_solve
from scipy.sparse import csr_array

from .arrays import Floats, Ints
from .canonical import EQUAL, canonical
from .eigen import DENSE, SHARE
from .errors import EigenError
from .factor import Factor, Solver, factoriser
from .lanczos import check_memory, extend
from .pencil import Pairs, Pencil, rayleigh_ritz
from .rounding import eigenvalue_noise
from .statics import StaticSolver
from .sturm import lowest_modes

MOVES = 1e-6  # rigid motions that move the interface less than this, relative, are left by it
FINITE = 1e-12  # of the largest 1/λ: less belongs to motions without mass
ARRAYS = 8  # n × n, of all modes at once


@dataclass(frozen=True)
class InterfaceHeld:
    """u = G f: the static response with Wᵀu = 0, G = K⁺ − J Z⁻¹ Jᵀ, J = [K⁺W, R_h], Z = JᵀKJ + [0 A; Aᵀ 0].

    From K u + W μ = f, u = K⁺(f − Wμ) − R_h a, Wᵀu = 0 and R_hᵀ(f − Wμ) = 0. R_h: the rigid modes that the
    interface holds, A = WᵀR_h; left: (n, l), those that it leaves; W: (n, k).
    """

    solver: StaticSolver
    W: Floats
    left: Floats
    J: Floats
    Z: tuple[Floats, Ints]

    @property
    def name(self) -> str:
        """What factorised K."""
        return self.solver.factor.name

    def solve(self, f: Floats) -> Floats:
        """u = G f for f (n,) or (n, m), G symmetric ≥ 0.

        K⁺ sees f − Wμ only, and what rounding left of Wᵀu is taken out: else the rounding of motions that are
        much softer than those with the interface held would remain in u.
        """
        k = self.W.shape[1]
        reaction = lu_solve(self.Z, self.J.T @ f)
        u = self.solver(f - self.W @ reaction[:k]) - self.J[:, k:] @ reaction[k:]
        moved = self.W.T @ u
        return np.asarray(u - self.J @ lu_solve(self.Z, np.concatenate([moved, np.zeros_like(reaction[k:])])))

    def negative_pivots(self) -> int | None:
        """None of the eigenvalues of G is negative."""
        return 0


def hold_interface(W: Floats, solve: StaticSolver) -> InterfaceHeld:
    """W: (n, k), orthonormal and 0 at the held DOFs; scaled here to wᵀK⁺w = 1, and R_h alike."""
    _, s, Y = np.linalg.svd(W.T @ solve.rigid)
    moved = int(np.sum(s > MOVES * s.max(initial=0.0)))
    F = solve(W)
    size = np.sqrt(np.sum(W * F, axis=0))
    size[size == 0] = 1.0
    W, F = W / size, F / size
    R_h = solve.rigid @ Y[:moved].T
    A = W.T @ R_h
    scale = np.linalg.norm(A, axis=0)
    R_h, A = R_h / scale, A / scale
    Z = np.block([[W.T @ F, A], [A.T, np.zeros((moved, moved))]])
    return InterfaceHeld(solve, W, solve.rigid @ Y[moved:].T, np.column_stack([F, R_h]), lu_factor(Z))


def fixed_interface_modes(
    held: InterfaceHeld,
    count: int | None,
    max_frequency: float | None,
    solver: Solver = "auto",
    say: Callable[[str], None] = lambda line: None,
) -> Pairs:
    """The lowest modes with Wᵀφ = 0, none missed, beyond the rigid motions that the interface leaves.

    count: how many, rigid motions left included; or max_frequency in Hz: all with f ≤ max_frequency.
    Raises EigenError: more than there are, no convergence, memory.
    """
    system = held.solver.system
    noise = eigenvalue_noise(system.K, system.M, system.rigid[:, :3], system.precision)
    pencil = Pencil(system.K, system.M, held.left, noise, system.precision)
    there = int(np.count_nonzero(system.M.diagonal()[~held.solver.held])) - held.W.shape[1]
    left = held.left.shape[1]
    if count is not None and count > there:
        raise EigenError(f"count: got {count}, the part has {there} free DOFs with mass behind its interface")
    wanted = 0 if count is None else max(count - left, 0)
    ceiling = 0.0 if max_frequency is None else (2 * np.pi * max_frequency) ** 2
    if wanted == 0 and not ceiling:
        return Pairs(np.zeros(0), np.zeros((len(held.W), 0)), held.name)
    n = int(np.sum(~held.solver.held))
    if n <= DENSE or SHARE * wanted > there:
        found = _all_at_once(pencil, held)
    else:
        with factoriser(solver) as factorise:

            @cache
            def below(s: float) -> int | None:
                say("counting the fixed-interface modes below")
                return _count_below(held, factorise, s)

            def search(known: Pairs, k: int) -> Pairs:
                return extend(pencil, held, known, k, say)

            if ceiling:
                wanted = below(ceiling) or 1
            found = lowest_modes(pencil, search, below, wanted, ceiling)
    found = canonical(found)
    return found.first(wanted if count else int(np.sum(found.lam <= ceiling * (1 + EQUAL))))


def _count_below(held: InterfaceHeld, factorise: Callable[[csr_array], Factor], s: float) -> int | None:
    """How many λ < s with the interface held: negative pivots of A = K − sM, less those of WᵀA⁻¹W.

    The inertia of [A W; Wᵀ 0] is that of A and −WᵀA⁻¹W (Haynsworth), and that of A where Wᵀφ = 0 and k of
    either sign.
    """
    free = ~held.solver.held
    system = held.solver.system
    try:
        factor = factorise(csr_array((system.K - s * system.M)[free][:, free]))
    except EigenError:  # a zero pivot
        return None
    negative = factor.negative_pivots()
    if negative is None:
        return None
    S = held.W[free].T @ factor.solve(held.W[free])
    swapped = int(np.sum(np.linalg.eigvalsh((S + S.T) / 2) < 0))
    return negative - swapped - int(held.left.shape[1])


def _all_at_once(pencil: Pencil, held: InterfaceHeld) -> Pairs:
    """(SᵀGS) y = 1/λ y, M = S Sᵀ, φ = G S y: motions without mass have 1/λ = 0."""
    free = np.flatnonzero(~held.solver.held)
    n = len(free)
    check_memory(8 * ARRAYS * len(held.W) * n, n, n)
    m, U = eigh(pencil.M[free][:, free].toarray())
    S = np.zeros((len(held.W), n))
    S[free] = U * np.sqrt(np.maximum(m, 0.0))
    GS = held.solve(S)
    nu, Y = eigh(S.T @ GS)
    finite = nu > FINITE * nu[-1]
    return rayleigh_ritz(pencil, GS @ Y[:, finite][:, ::-1], f"dense, {held.name}")
