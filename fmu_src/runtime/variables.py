"""The variables of the FMU, all from the model: one list for the description and for the slave.

The value reference of a Real is its place among the Reals; the one Integer has value reference 0.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from .kinds import inputs_of, outputs_of
from .model import Floats, Port, ReducedModel


@dataclass(frozen=True)
class Variable:
    """One ScalarVariable of FMI 2.0; `derivative` is the place (0-based) of the state it differentiates."""

    name: str
    type: Literal["Real", "Integer"]
    causality: Literal["input", "output", "parameter", "calculatedParameter", "local"]
    variability: Literal["continuous", "tunable", "constant"]
    initial: Literal["exact", "calculated"] | None
    description: str
    unit: str | None = None
    start: float | int | None = None
    minimum: float | int | None = None
    maximum: float | int | None = None
    nominal: float | None = None
    derivative: int | None = None


@dataclass(frozen=True)
class Layout:
    """Where each group of Reals stands in the vector of all Reals."""

    inputs: slice
    outputs: slice
    alpha: int
    beta: int
    frequency: slice
    damping_ratio: slice
    q: slice
    v: slice
    q_dot: slice
    v_dot: slice
    size: int


def layout(model: ReducedModel) -> Layout:
    """inputs, outputs, α, β, frequencies, damping ratios, q, v, q̇, v̇ in this order."""
    m, p, r = len(model.inputs), len(model.outputs), len(model.lam)
    modal = m + p + 2
    frequency, ratio, q, v, q_dot, v_dot = (slice(modal + k * r, modal + (k + 1) * r) for k in range(6))
    return Layout(
        slice(0, m), slice(m, m + p), m + p, m + p + 1, frequency, ratio, q, v, q_dot, v_dot, modal + 6 * r
    )


def variables(model: ReducedModel) -> tuple[Variable, ...]:
    """All Reals in the order of `layout`, then the Integer `modes.active`."""
    place = layout(model)
    r = len(model.lam)
    omega = np.sqrt(model.lam)
    q_nominal, v_nominal = _nominal(model, omega)
    static = model.initial == "static"
    reals = [
        *(_input(port, key) for port in model.ports for key in port.inputs),
        *(_output(port, key) for port in model.ports for key in port.outputs),
        _parameter("damping.alpha", model.alpha, "1/s", "mass-proportional damping, d = alpha + beta*lambda"),
        _parameter(
            "damping.beta", model.beta, "s", "stiffness-proportional damping, d = alpha + beta*lambda"
        ),
    ]
    for i, f in enumerate(model.frequency, start=1):
        reals.append(
            Variable(
                f"modes.frequency[{i}]",
                "Real",
                "local",
                "constant",
                "exact",
                f"undamped natural frequency of mode {i}",
                unit="Hz",
                start=float(f),
            )
        )
    reals += [
        Variable(
            f"modes.damping_ratio[{i}]",
            "Real",
            "calculatedParameter",
            "tunable",
            "calculated",
            f"damping ratio of mode {i}, 0 for a rigid mode",
        )
        for i in range(1, r + 1)
    ]
    reals += [_state(f"modes.amplitude[{i + 1}]", "amplitude", q_nominal[i], not static) for i in range(r)]
    reals += [_state(f"modes.velocity[{i + 1}]", "velocity", v_nominal[i], True) for i in range(r)]
    for states, word in ((place.q, "amplitude"), (place.v, "velocity")):
        reals += [
            Variable(
                f"der(modes.{word}[{i}])",
                "Real",
                "local",
                "continuous",
                "calculated",
                f"time derivative of the {word} of mode {i}",
                derivative=states.start + i - 1,
            )
            for i in range(1, r + 1)
        ]
    active = Variable(
        "modes.active",
        "Integer",
        "parameter",
        "tunable",
        "exact",
        "level of detail: how many modes move, the lowest first; a mode switched off returns to rest",
        start=r,
        minimum=0,
        maximum=r,
    )
    return (*reals, active)


def _input(port: Port, key: str) -> Variable:
    about = inputs_of(port.name)[key]
    text = about.text.format(port=port.name)
    return Variable(
        f"{port.name}.{key}", "Real", "input", "continuous", None, text, unit=about.unit, start=0.0
    )


def _output(port: Port, key: str) -> Variable:
    about = outputs_of(port.name)[key]
    text = about.text.format(port=port.name)
    return Variable(f"{port.name}.{key}", "Real", "output", "continuous", "calculated", text, unit=about.unit)


def _parameter(name: str, start: float, unit: str, text: str) -> Variable:
    return Variable(name, "Real", "parameter", "tunable", "exact", text, unit=unit, start=start, minimum=0.0)


def _state(name: str, word: str, nominal: float, exact: bool) -> Variable:
    return Variable(
        name,
        "Real",
        "local",
        "continuous",
        "exact" if exact else "calculated",
        f"modal {word}, mass-normalised",
        start=0.0 if exact else None,
        nominal=float(nominal),
    )


def _nominal(model: ReducedModel, omega: Floats) -> tuple[Floats, Floats]:
    """|Bᵢ|/λᵢ and |Bᵢ|/ωᵢ: what a force of 1 N gives, and 1 where that is no usable number."""
    force = np.abs(model.B).max(axis=1, initial=0.0)
    usable = (omega > 1e-100) & (omega < 1e100) & (force > 1e-100) & (force < 1e100)
    omega = np.where(usable, omega, 1.0)
    force = np.where(usable, force, 1.0)
    return force / omega**2, force / omega
