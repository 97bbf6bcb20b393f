"""The monolithic solution: everything that is coupled as one ẋ = A x, solved by the matrix exponential.

What drives the system is part of x: a signal that solves a linear differential equation of its own.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from body import Body
from scipy.linalg import block_diag, expm
from scipy.optimize import brentq

from precompute.arrays import Floats

SCAN_TO_EVENT = 1e-14  # s, of the root of an event function


@dataclass(frozen=True, eq=False)  # arrays have no one truth value
class Monolith:
    """ẋ = A x + Σ b u, y = c x; x starts at x0.

    A: (n, n) 1/s; x0: (n,); inputs: b (n,), outputs: c (n,), both under the names that an FMU gives them.
    """

    A: Floats
    x0: Floats
    inputs: Mapping[str, Floats]
    outputs: Mapping[str, Floats]


@dataclass(frozen=True, eq=False)
class Signal:
    """s = c z with ż = S z, z(0) = z0: a force in time."""

    S: Floats
    z0: Floats
    c: Floats


def polynomial(*rates: float) -> Signal:
    """s = r₀ + r₁ t + r₂ t²/2 + … : its value and its derivatives at t = 0."""
    n = len(rates)
    return Signal(np.diag(np.ones(n - 1), 1), np.array(rates, float), np.eye(n)[0])


def sine(amplitude: float, omega: float, phase: float = 0.0) -> Signal:
    """s = a sin(ωt + φ), ω in rad/s."""
    turn = np.array([[0.0, omega], [-omega, 0.0]])
    return Signal(turn, amplitude * np.array([np.sin(phase), np.cos(phase)]), np.array([1.0, 0.0]))


def monolith(body: Body) -> Monolith:
    """x = (S u, u̇) with S = diag √(Kᵢᵢ/Mᵢᵢ), so that no entry of A is larger than a frequency.

    A = [0 S; −M⁻¹K S⁻¹ −M⁻¹D]; inputs force or moment, outputs displacement and velocity, or rotation and
    angular velocity, of each port.
    """
    n = len(body.M)
    S = np.sqrt(np.maximum(np.diag(body.K), 0.0) / np.diag(body.M))
    S[S == 0] = 1.0  # 1/s: a rigid motion, whose Kᵢᵢ may be rounding of either sign
    solved = np.linalg.solve(body.M, np.hstack([body.K / S, body.D]))
    A = np.block([[np.zeros((n, n)), np.diag(S)], [-solved[:, :n], -solved[:, n:]]])
    inputs, outputs = {}, {}
    for name, w in body.ports.items():
        port, axis = name.rsplit(".", 1)
        force, position = ("moment", "rotation") if axis[0] == "r" else ("force", "displacement")
        rate = "angular_" if axis[0] == "r" else ""
        inputs[f"{port}.{force}.{axis[-1]}"] = np.r_[np.zeros(n), np.linalg.solve(body.M, w)]
        outputs[f"{port}.{position}.{axis[-1]}"] = np.r_[w / S, np.zeros(n)]
        outputs[f"{port}.{rate}velocity.{axis[-1]}"] = np.r_[np.zeros(n), w]
    return Monolith(A, np.zeros(2 * n), inputs, outputs)


def beside(first: Monolith, second: Monolith) -> Monolith:
    """Both, not connected; their names differ."""
    n, m = len(first.A), len(second.A)

    def wide(one: Mapping[str, Floats], other: Mapping[str, Floats]) -> Mapping[str, Floats]:
        before = {name: np.pad(v, (0, m)) for name, v in one.items()}
        return before | {name: np.pad(v, (n, 0)) for name, v in other.items()}

    return Monolith(
        block_diag(first.A, second.A),
        np.r_[first.x0, second.x0],
        wide(first.inputs, second.inputs),
        wide(first.outputs, second.outputs),
    )


def fed_back(system: Monolith, name: str, row: Floats) -> Monolith:
    """The input u = row x, such as −k times the row of a displacement."""
    return replace(system, A=system.A + np.outer(system.inputs[name], row))


def driven(system: Monolith, signals: Mapping[str, Signal]) -> Monolith:
    """The inputs follow these signals, whose states join x."""
    for name, signal in signals.items():
        source = Monolith(signal.S, signal.z0, {}, {"signal": signal.c})
        system = beside(system, source)
        system = fed_back(system, name, system.outputs["signal"])
    return system


def after(system: Monolith, t: float, x: Floats | None = None) -> Floats:
    """x(t) = e^{At} x0, from x in place of x0 where it is given."""
    found: Floats = expm(system.A * t) @ (system.x0 if x is None else x)
    return found


def trajectory(system: Monolith, h: float, count: int) -> Floats:
    """x at 0, h, 2h, …: (count + 1, n)."""
    E, x = expm(system.A * h), [system.x0]
    for _ in range(count):
        x.append(E @ x[-1])
    return np.array(x)


def output(system: Monolith, x: Floats, name: str) -> Floats:
    """y = c x of one state (n,) or many (k, n)."""
    return np.asarray(x @ system.outputs[name])


def rate(system: Monolith, name: str) -> Floats:
    """The row of ẏ = c A x; of a velocity that is the acceleration, whatever is fed back."""
    return np.asarray(system.outputs[name] @ system.A)


def crossing(system: Monolith, x: Floats, row: Floats, scan: float, stop: float) -> tuple[float, Floats]:
    """The first time t in (0, stop] at which row·x, from x at t = 0, comes to 0 from below, and x there.

    It is looked for in steps of `scan` (s), then as a root of the exponential. (∞, x) where there is none.
    """
    E, t = expm(system.A * scan), 0.0
    while t < stop:
        end = E @ x
        if row @ x < 0 <= row @ end:
            root = brentq(lambda s, x=x: row @ after(system, s, x), 0.0, scan, xtol=SCAN_TO_EVENT)
            return t + root, after(system, root, x)
        t, x = t + scan, end
    return np.inf, x
