"""A linear part by matrices: ẋ = A x + B u, y = C x + D u, stepped by the matrix exponential.

The oracle of the FMU: nothing of its step is used. x may have several columns, for as many runs side by side.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.linalg import expm

from fmu_src.runtime.model import Floats, ReducedModel


@dataclass(frozen=True, eq=False)
class StateSpace:
    """A: (n, n), B: (n, m), C: (p, n), D: (p, m)."""

    A: Floats
    B: Floats
    C: Floats
    D: Floats


def state_space(model: ReducedModel, inputs: list[str], outputs: list[str]) -> StateSpace:
    """x = [q, q̇] of the model's oscillators between these inputs and outputs: motions and accelerations."""
    r = len(model.lam)
    B = model.B[:, [model.inputs.index(name) for name in inputs]]
    D_tilde = np.diag(model.alpha + model.beta * model.lam) + model.D_rest
    moved = np.hstack([-np.diag(model.lam), -D_tilde])  # q̈ of x
    A = np.vstack([np.hstack([np.zeros((r, r)), np.eye(r)]), moved])
    rows, through = [], []
    for name in outputs:
        c = model.C[model.outputs.index(name)]
        law = model.laws[model.outputs.index(name)]
        zero = np.zeros(r)
        rows.append({"position": np.r_[c, zero], "velocity": np.r_[zero, c]}.get(law, c @ moved))
        through.append(c @ B if law == "acceleration" else np.zeros(B.shape[1]))
    return StateSpace(A, np.vstack([np.zeros_like(B), B]), np.array(rows), np.array(through))


class LinearPart:
    """A `Part` with the state x (n,) or (n, k) and the inputs and rates U (3, m) or (3, m, k) at its time."""

    def __init__(self, space: StateSpace, x: Floats) -> None:
        self.space, self.x = space, x
        self.U = np.zeros((3, space.B.shape[1], *x.shape[1:]))
        self._exponentials: dict[float, Floats] = {}

    @property
    def sizes(self) -> tuple[int, int]:
        p, m = self.space.D.shape
        return m, p

    def set(self, U: Floats) -> None:
        self.U = np.zeros_like(self.U)
        self.U[: len(U)] = U

    def outputs(self) -> Floats:
        return self.space.C @ self.x + self.space.D @ self.U[0]

    def rates(self, order: int) -> Floats:
        """y⁽ᵏ⁾ = C x⁽ᵏ⁾ + D u⁽ᵏ⁾ with x⁽ᵏ⁾ = A x⁽ᵏ⁻¹⁾ + B u⁽ᵏ⁻¹⁾."""
        x = self.x
        for k in range(order):
            x = self.space.A @ x + self.space.B @ self.U[k]
        return self.space.C @ x + self.space.D @ self.U[order]

    def step(self, t: float, h: float) -> None:
        """By the exponential of x, u, u̇, ü as one system."""
        if h not in self._exponentials:
            self._exponentials[h] = expm(h * _with_polynomials(self.space))
        n = len(self.x)
        z = self._exponentials[h] @ np.concatenate([self.x, *self.U])
        self.x, self.U = z[:n], z[n:].reshape(self.U.shape)

    def save(self) -> Any:
        return self.x, self.U

    def restore(self, state: Any) -> None:
        self.x, self.U = state

    def free(self, state: Any) -> None:
        pass


def _with_polynomials(space: StateSpace) -> Floats:
    n, m = space.B.shape
    Z = np.zeros((n + 3 * m, n + 3 * m))
    Z[:n, : n + m] = np.hstack([space.A, space.B])
    Z[n : n + 2 * m, n + m :] = np.eye(2 * m)
    return Z
