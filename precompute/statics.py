"""The static response of the elastic body, x = K⁺ b, with inertia relief where the body is free."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np
from scipy.linalg import qr
from scipy.sparse import csr_array

from .arrays import Bools, Floats, Ints
from .factor import Factor, Solver, factoriser
from .pencil import Pairs, Pencil
from .restraint import restrain
from .rounding import eigenvalue_noise
from .system import System
from .zero_energy import Where, refuse_mechanisms

BALANCED = 1e-12  # of a load: what rounding leaves where inertia balances it as it is


@dataclass(frozen=True)
class StaticSolver:
    """K x = (I − M R Rᵀ) b, RᵀM x = 0, x = 0 at the fixed DOFs; R the rigid modes that the supports leave.

    The rigid part of the load is taken up by the inertia of the body (inertia relief); what is left is in
    equilibrium, so that k DOFs may be pinned, statically determinate, without a reaction. The factor is of K
    less the rows and columns of the supports and pins: positive definite, and exact where a shifted one
    would need hundreds of corrections for a slender body.

    system: the full model; held: (n,), which DOFs the supports hold; rigid: (n, k) M-orthonormal, kg^-1/2;
    kept: DOFs neither held nor pinned; factor: of K between these.
    Source: Craig & Kurdila, Fundamentals of Structural Dynamics, 2nd ed., ch. 17 (inertia relief).
    """

    system: System
    held: Bools
    rigid: Floats
    kept: Ints
    factor: Factor

    def __call__(self, b: Floats) -> Floats:
        """x = K⁺ b for loads b (n,) or (n, m) in N: displacements of the same shape in m.

        One correction makes every row of K x fulfilled to its own rounding (Skeel, Math. Comp. 35, 1980).
        Loads that do not deform the body have exactly 0.
        """
        x = self.unrefined(b)
        x = x + self.unrefined(b - self.system.K @ x)
        return np.where(self.deforms(b), x, 0.0)

    def unrefined(self, b: Floats) -> Floats:
        """K⁺ b by one solve: linear, symmetric and positive, as a preconditioner must be."""
        x = np.zeros(b.shape)
        if x.size:  # there may be no load
            x[self.kept] = self.factor.solve(self.balanced(b)[self.kept])
        return np.asarray(x - self.rigid @ (self.rigid.T @ (self.system.M @ x)))

    def balanced(self, b: Floats) -> Floats:
        """(I − M R Rᵀ) b: the load with the inertia forces that balance it, 0 at the held DOFs."""
        load: Floats = b - self.system.M @ (self.rigid @ (self.rigid.T @ b))
        load[self.held] = 0.0
        return load

    def deforms(self, b: Floats) -> Bools:
        """Which loads b (n, m) deform the body: (m,); gravity does not where it is free."""
        left, whole = (np.linalg.norm(load[~self.held], axis=0) for load in (self.balanced(b), b))
        deforming: Bools = left > BALANCED * whole
        return deforming


@contextmanager
def static_solver(
    system: System, fixed: Ints, *, solver: Solver = "auto", where: Where = "DOF {}".format
) -> Iterator[StaticSolver]:
    """The solver of K x = b for one set of supports; it holds the factor until the end of the block.

        with static_solver(system, fixed) as solve:
            X = solve(b)

    fixed: the DOFs held; where: DOF → its place, for messages.
    Raises EigenError: K or M unusable, nothing free, memory; ZeroEnergyError: motions without strain energy
    beyond the rigid ones of the whole body.
    """
    restraint = restrain(system, fixed, where)
    kept = np.setdiff1d(restraint.free, _pins(system.K, restraint.rigid))
    with factoriser(solver) as factorise:
        factor = factorise(csr_array(system.K[kept][:, kept]))
        solve = StaticSolver(system, restraint.held, restraint.rigid, kept, factor)
        _refuse_mechanisms(solve, where)
        yield solve


def _pins(K: csr_array, R: Floats) -> Ints:
    """As many DOFs as there are rigid modes, each mode moving them: pivots of √K_ii R, where K holds best."""
    if R.shape[1] == 0:
        return np.zeros(0, dtype=np.int64)
    _, order = qr((np.sqrt(K.diagonal())[:, None] * R).T, mode="r", pivoting=True)
    return np.asarray(order[: R.shape[1]], dtype=np.int64)


def _refuse_mechanisms(solve: StaticSolver, where: Where) -> None:
    """Inverse iteration: a motion without strain energy outgrows all others in two steps."""
    M, K = solve.system.M, solve.system.K
    n = K.shape[0]
    x = solve.unrefined(M @ np.random.default_rng(0).standard_normal(n))
    x = solve.unrefined(M @ x)
    precision = solve.system.precision
    noise = eigenvalue_noise(K, M, solve.system.rigid[:, :3], precision)
    pencil = Pencil(K, M, solve.rigid, noise, precision)
    refuse_mechanisms(pencil, Pairs(np.zeros(1), x[:, None], solve.factor.name), np.arange(n), where)
