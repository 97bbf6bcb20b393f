"""The variables of the FMU, all from the model: one list for the description and for the slave.

The value reference of a Real is its place among the Reals; the one Integer has value reference 0.
"""

from dataclasses import dataclass
from itertools import accumulate, pairwise
from typing import Literal

import numpy as np

from .kinds import Output, inputs_of, outputs_of
from .model import Floats, Port, ReducedModel

RATES = {"m": "m/s", "m/s": "m/s2", "rad": "rad/s", "rad/s": "rad/s2"}


@dataclass(frozen=True)
class Variable:
    """One ScalarVariable of FMI 2.0; `derivative` is the place (0-based) of the state it differentiates."""

    name: str
    type: Literal["Real", "Integer"]
    causality: Literal["input", "output", "parameter", "calculatedParameter", "local"]
    variability: Literal["continuous", "tunable", "fixed", "constant"]
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
    """Where each group of Reals stands in the vector of all Reals.

    start: of s, then of ṡ; q and v, the states, are all of x = [s; q] and of ẋ, q_dot and v_dot their rates.
    """

    inputs: slice
    outputs: slice
    alpha: int
    beta: int
    start: slice
    frequency: slice
    damping_ratio: slice
    q: slice
    v: slice
    q_dot: slice
    v_dot: slice
    size: int


def layout(model: ReducedModel) -> Layout:
    """inputs, outputs, α, β, starts, frequencies, damping ratios, x, ẋ, their rates in this order."""
    m, p, n = len(model.inputs), len(model.outputs), len(model.lam)
    ends = [0, *accumulate([m, p, 1, 1, 2 * model.k, model.r, model.r, n, n, n, n])]
    inputs, outputs, alpha, beta, start, frequency, ratio, *x = (slice(a, b) for a, b in pairwise(ends))
    q, v, q_dot, v_dot = x
    return Layout(
        inputs, outputs, alpha.start, beta.start, start, frequency, ratio, q, v, q_dot, v_dot, ends[-1]
    )


def variables(model: ReducedModel) -> tuple[Variable, ...]:
    """All Reals in the order of `layout`, then the Integer `modes.active`."""
    place, r = layout(model), model.r
    reals = [
        *(_input(port, key) for port in model.ports for key in port.inputs),
        *(_output(port, key) for port in model.ports for key in port.outputs),
        _parameter("damping.alpha", model.alpha, "1/s", "mass-proportional damping, d = alpha + beta*lambda"),
        _parameter(
            "damping.beta", model.beta, "s", "stiffness-proportional damping, d = alpha + beta*lambda"
        ),
    ]
    reals += _starts(model)
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
    states = _states(model)
    reals += states
    reals += [_rate(state, place.q.start + i) for i, state in enumerate(states)]
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


def _prescribed(model: ReducedModel, order: int) -> list[tuple[str, str, Output]]:
    """Port, key and kind of what s (order 0) or ṡ (order 1) are."""
    return [
        (port.name, prescribes[order], outputs_of(port.name)[prescribes[order]])
        for port in model.ports
        for key in port.inputs
        if (prescribes := inputs_of(port.name)[key].prescribes)
    ]


def _starts(model: ReducedModel) -> list[Variable]:
    """Where prescribed motions begin."""
    return [
        Variable(
            f"{port}.start_{key}",
            "Real",
            "parameter",
            "fixed",
            "exact",
            f"prescribed {about.text.format(port=port)} at the start",
            unit=about.unit,
            start=0.0,
        )
        for order in (0, 1)
        for port, key, about in _prescribed(model, order)
    ]


def _states(model: ReducedModel) -> list[Variable]:
    """s, q, then ṡ, q̇."""
    found: list[Variable] = []
    for order, word in enumerate(("amplitude", "velocity")):
        nominal = _nominal(model, order).tolist()
        found += [
            Variable(
                f"{port}.prescribed_{key}",
                "Real",
                "local",
                "continuous",
                "calculated",
                f"prescribed {about.text.format(port=port)}",
                unit=about.unit,
                nominal=scale,
            )
            for (port, key, about), scale in zip(_prescribed(model, order), nominal, strict=False)
        ]
        exact = not (order == 0 and model.initial == "static")
        found += [
            Variable(
                f"modes.{word}[{i}]",
                "Real",
                "local",
                "continuous",
                "exact" if exact else "calculated",
                f"modal {word}, mass-normalised",
                start=0.0 if exact else None,
                nominal=scale,
            )
            for i, scale in enumerate(nominal[model.k :], start=1)
        ]
    return found


def _rate(state: Variable, place: int) -> Variable:
    """The derivative by time of the state at this place."""
    unit = None if state.unit is None else RATES[state.unit]
    text = f"time derivative of {state.name}"
    return Variable(
        f"der({state.name})",
        "Real",
        "local",
        "continuous",
        "calculated",
        text,
        unit=unit,
        derivative=place,
    )


def _nominal(model: ReducedModel, order: int) -> Floats:
    """|Bᵢ|/λᵢ (order 0) or |Bᵢ|/ωᵢ: what a force of 1 N gives, and 1 where that is no usable number."""
    omega = np.sqrt(model.lam)
    force = np.abs(model.B).max(axis=1, initial=0.0)
    usable = (omega > 1e-100) & (omega < 1e100) & (force > 1e-100) & (force < 1e100)
    omega = np.where(usable, omega, 1.0)
    force = np.where(usable, force, 1.0)
    nominal: Floats = force / (omega**2 if order == 0 else omega)
    return nominal
