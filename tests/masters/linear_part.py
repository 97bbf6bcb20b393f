"""A linear part by matrices: ẋ = A x + B u, y = C x + D u, stepped by the matrix exponential.

The oracle of the FMU: nothing of its step is used. x may have several columns, for as many runs side by side.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.linalg import expm

from fmu_src.runtime.model import Floats, ReducedModel, row_starts


@dataclass(frozen=True, eq=False)
class StateSpace:
    """A: (n, n), B: (n, m), C: (p, n), D: (p, m)."""

    A: Floats
    B: Floats
    C: Floats
    D: Floats


def state_space(model: ReducedModel, inputs: list[str], outputs: list[str]) -> StateSpace:
    """[x, ẋ] of the model between these inputs and outputs, which are no stresses and no energies.

    s̈ = a and q̈ + D̃ q̇ + Λ q = B u + N ṡ; reactions are C₁(ẍ + αẋ) + C₂ẋ + C₃(x + βẋ) + R u.
    """
    n, columns = len(model.lam), [model.inputs.index(name) for name in inputs]
    B, braking = model.B[:, columns], np.diag(model.alpha + model.beta * model.lam) + model.D_rest
    braking[: model.k] = 0.0
    braking[model.k :, : model.k] = -model.drag(model.alpha)[model.k :]
    x, v, a = np.eye(n, 2 * n), np.eye(n, 2 * n, n), np.hstack([-np.diag(model.lam), -braking])
    starts, rows, through = row_starts(model.laws), [], []
    for place in (model.outputs.index(name) for name in outputs):
        C, R = (A[starts[place] : starts[place + 1]] for A in (model.C, model.R[:, columns]))
        match model.laws[place]:
            case "position":
                rows.append(C[0] @ x)
                through.append(R[0])
            case "velocity":
                rows.append(C[0] @ v)
                through.append(np.zeros(len(columns)))
            case "acceleration":
                rows.append(C[0] @ a)
                through.append(C[0] @ B + R[0])
            case "reaction":
                rows.append(C[0] @ (a + model.alpha * v) + C[1] @ v + C[2] @ (x + model.beta * v))
                through.append(C[0] @ B + R[0])
    return StateSpace(np.vstack([v, a]), np.vstack([0 * B, B]), np.array(rows), np.array(through))


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
