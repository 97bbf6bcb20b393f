"""two_ports in motion under inputs that are polynomials in time, and where it is by the exponential."""

import numpy as np
from examples import two_ports
from native_fmu import OK, Instance, native_fmu
from scipy.linalg import expm

from fmu_src.runtime.model import Floats, ReducedModel

FORCES = [0, 1, 2]  # value references of the inputs of two_ports
START = {f"modes.{kind}[{i}]": 0.3 * i - 1.0 for kind in ("amplitude", "velocity") for i in range(1, 7)}
U = np.array([[1.0, -2.0, 0.5], [30.0, 10.0, -20.0], [-400.0, 300.0, 200.0]])  # u, u̇, ü


def started() -> Instance:
    """two_ports in motion, at t = 0."""
    return native_fmu(two_ports).instance().initialise(START)


def give(part: Instance, rows: Floats) -> None:
    """u and as many of its derivatives as there are rows."""
    part.must("SetReal", np.array(FORCES, np.uint32), 3, np.array(rows[0], float))
    orders = range(1, len(rows))
    assert part.set_rates(FORCES * len(orders), np.repeat([*orders], 3), np.ravel(rows[1:])) == OK


def outputs(part: Instance) -> Floats:
    return part.get_real(part.fmu.outputs)


def polynomial(rows: Floats, t: float) -> Floats:
    """u and its derivatives at t."""
    u, u_dot, u_ddot = np.vstack([rows, np.zeros((3 - len(rows), 3))])
    return np.array([u + u_dot * t + u_ddot * t**2 / 2, u_dot + u_ddot * t, u_ddot])


def augmented(model: ReducedModel) -> Floats:
    """ẋ = A x for x = q, q̇, u, u̇, ü: the part and its polynomial inputs as one linear system."""
    r, m = model.B.shape
    A = np.zeros((2 * r + 3 * m, 2 * r + 3 * m))
    A[:r, r : 2 * r] = np.eye(r)
    A[r : 2 * r, :r] = -np.diag(model.lam)
    A[r : 2 * r, r : 2 * r] = -np.diag(model.damping(model.alpha, model.beta))
    A[r : 2 * r, 2 * r : 2 * r + m] = model.B
    A[2 * r : 2 * r + 2 * m, 2 * r + m :] = np.eye(2 * m)
    return A


def exact_outputs(rows: Floats, h: float) -> list[Floats]:
    """y, ẏ, ÿ after h from START by the exponential of the augmented matrix."""
    model = two_ports()
    A = augmented(model)
    start = [START[f"modes.{kind}[{i}]"] for kind in ("amplitude", "velocity") for i in range(1, 7)]
    x = expm(A * h) @ np.concatenate([start, np.ravel(polynomial(rows, 0.0))])
    orders = [("position", "velocity", "acceleration").index(law) for law in model.laws]
    C = np.hstack([model.C, np.zeros((5, 15))])
    powers = [np.linalg.matrix_power(A, k) for k in range(5)]
    return [np.array([C[row] @ powers[n + k] @ x for row, n in enumerate(orders)]) for k in range(3)]


def close(found: Floats, reference: Floats, tolerance: float) -> bool:
    return bool((np.abs(found - reference) <= tolerance * np.abs(reference).max()).all())
