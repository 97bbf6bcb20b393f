"""Derivatives by time: of inputs, that a step is given, and of outputs, that it gives (section 4.2.1)."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from ctypes import c_double, c_int, c_uint

from .check import Check, needs_indices
from .description import Description
from .driver import Fmu, Refused, Slave
from .finding import Demand, Finding
from .runs import SMALL, difference, inputs_at, run, size_of

PARTS = 64  # steps in place of one; if each held its input, 1/128 of the ramp's effect would be lost
AGREE = 0.05  # of the effect
SHORT = 1 / 64  # of a step: over which outputs are differenced


def input_derivatives(order: int) -> Check:
    """One step under a ramp, of order 2 one that bends back, is what many short steps come to that are each
    given their part of it as a ramp.
    """

    def check(fmu: Fmu) -> Iterator[Finding]:
        ramps = {v: SMALL * size_of(v) / fmu.h for v in fmu.description.real_inputs}
        bends = {v: -ramp / fmu.h if order == 2 else 0.0 for v, ramp in ramps.items()}
        outputs = fmu.description.real_outputs
        ends = []
        for way in ("less", "given", "parts"):
            slave = fmu.slave().initialise(fmu.start)
            run(fmu, slave, 0, 3)
            base = {v: float(x) for v, x in inputs_at(fmu, 2).items() if v in ramps}
            slave.set(base)
            if way == "given" and order == 2:
                try:
                    slave.set_rates(ramps, bends)
                except Refused:  # it may: no flag tells up to which order inputs are interpolated
                    return
            elif way == "given" or (way == "less" and order == 2):
                slave.set_rates(ramps)
            parts = PARTS if way == "parts" else 1
            h = fmu.h / parts
            for k in range(parts):
                if way == "parts":
                    t = k * h
                    slave.set({v: base[v] + ramps[v] * t + bends[v] * t * t / 2 for v in ramps})
                    slave.set_rates({v: ramps[v] + bends[v] * (t + h / 2) for v in ramps})  # to the next one
                slave.step(fmu.point(3) + k * h, h)
            ends.append({v: float(x) for v, x in slave.get(outputs).items()})
            slave.free()
        less, given, in_parts = ends
        for v in outputs:
            effect = in_parts[v] - less[v]
            if abs(given[v] - in_parts[v]) > AGREE * abs(effect) + 1e-9 * abs(less[v]):
                yield Finding(
                    "input-derivative",
                    f"of order {order} of the inputs move {v.name} by {given[v] - less[v]:.6g} in one step, "
                    f"by {effect:.6g} in {PARTS}",
                )
                return

    name = "input-derivative" if order == 1 else f"input-derivative of order {order}"
    return Check(name, check, lambda d: _interpolates(d) or _short_steps(d))


def input_derivatives_end(fmu: Fmu) -> Iterator[Finding]:
    """The derivatives are those of one step: the next one, with inputs alone, holds them."""
    ramps = {v: SMALL * size_of(v) / fmu.h for v in fmu.description.real_inputs}
    ends = []
    for again in (False, True):
        slave = fmu.slave().initialise(fmu.start)
        run(fmu, slave, 0, 3)
        slave.set_rates(ramps)
        slave.step(fmu.point(3), fmu.h)
        slave.set(inputs_at(fmu, 4))
        if again:
            slave.set_rates(dict.fromkeys(ramps, 0.0))
        slave.step(fmu.point(4), fmu.h)
        ends.append(slave.get(fmu.description.real_outputs))
        slave.free()
    apart = difference(ends[1:], ends[:1])
    if apart:
        yield Finding(
            "input-derivative-kept", f"compared with derivatives set to 0 for a second step: {apart}"
        )


def states_derivatives(fmu: Fmu) -> Iterator[Finding]:
    """What is declared as the derivative of a variable against the change of that over short steps."""
    variables = fmu.description.variables
    pairs = [(variables[i], v) for v in variables if (i := v.derivative) is not None]
    both = [v for pair in pairs for v in pair]

    def read(slave: Slave) -> tuple[list[float], list[float]]:
        got = slave.get(both)
        return [float(got[rate]) for _, rate in pairs], [float(got[whole]) for whole, _ in pairs]

    rates, levels, h = _three_points(fmu, read)
    for k, (whole, rate) in enumerate(pairs):
        wrong = _disagree([row[k] for row in rates], [row[k] for row in levels], h)
        if wrong:
            yield Finding("derivative", f"{rate.name}, the derivative of {whole.name}: {wrong}")
            return


def _three_points(
    fmu: Fmu, read: Callable[[Slave], tuple[list[float], list[float]]]
) -> tuple[list[list[float]], list[list[float]], float]:
    """Rates and levels after each of three steps with held inputs, and the size of the steps in s.

    Short ones; whole ones where the FMU's own solver does not move in short ones.
    """
    for h in (fmu.h * SHORT, fmu.h):
        slave = fmu.slave().initialise(fmu.start)
        run(fmu, slave, 0, 4)
        slave.set(inputs_at(fmu, 3))  # nothing jumps
        rates, levels = [], []
        for k in range(3):
            slave.step(fmu.point(4) + k * h, h)
            rate, level = read(slave)
            rates.append(rate)
            levels.append(level)
        slave.free()
        if levels[0] != levels[1]:
            break
    return rates, levels, h


def _disagree(rates: Sequence[float], levels: Sequence[float], h: float) -> str | None:
    """The rate in the middle of three points against the central difference; what it may be off by is
    its own change meanwhile, and the rounding of the levels.
    """
    got, found = rates[1], (levels[2] - levels[0]) / (2 * h)
    bend = abs(rates[2] - rates[0])
    noise = 1e4 * 2.2e-16 * max(map(abs, levels)) / h
    if abs(got - found) <= AGREE * max(abs(got), abs(found)) + bend + noise:
        return None
    return f"{got:.6g}, by differences {found:.6g}"


def order_zero(fmu: Fmu) -> Iterator[Finding]:
    """The order 0 of a derivative is not allowed."""
    slave = fmu.slave().initialise(fmu.start)
    run(fmu, slave, 0, 1)
    reference = (c_uint * 1)(fmu.description.real_inputs[0].reference)
    if slave.unnoticed("SetRealInputDerivatives", reference, 1, (c_int * 1)(0), (c_double * 1)(0.0)):
        yield Finding("derivative-order-zero", "fmi2SetRealInputDerivatives of order 0 gave fmi2OK")
    slave.free()


def output_derivatives(order: int) -> Check:
    """The derivatives of all continuous outputs against the change over a short step with held inputs."""

    def check(fmu: Fmu) -> Iterator[Finding]:
        outputs = fmu.description.real_outputs
        references = [v.reference for v in outputs]

        def read(slave: Slave) -> tuple[list[float], list[float]]:
            rates = slave.output_rates(references, order)
            if order > 1:
                return rates, slave.output_rates(references, order - 1)
            return rates, [float(x) for x in slave.get(outputs).values()]

        try:
            rates, levels, h = _three_points(fmu, read)
        except Refused as refused:
            yield Finding("output-derivative", f"of order {order}: {refused}")
            return
        for k, v in enumerate(outputs):
            wrong = _disagree([row[k] for row in rates], [row[k] for row in levels], h)
            if wrong:
                yield Finding("output-derivative", f"of order {order} of {v.name}: {wrong}")
                return

    def hindrance(description: Description) -> str | None:
        if description.output_order < order:
            return f"maxOutputDerivativeOrder is {description.output_order}"
        return _short_steps(description)

    return Check(f"output-derivative of order {order}", check, hindrance)


def _short_steps(description: Description) -> str | None:
    if not description.real_outputs:
        return "no continuous Real outputs"
    flag = "canHandleVariableCommunicationStepSize"
    return (
        None
        if description.can(flag)
        else f"{flag} is not declared, so there are no short steps to compare with"
    )


def _interpolates(description: Description) -> str | None:
    if not description.can("canInterpolateInputs"):
        return "canInterpolateInputs is not declared"
    return None if description.real_inputs else "no continuous Real inputs"


def _derivatives(description: Description) -> str | None:
    if all(v.derivative is None for v in description.variables):
        return "no variable is a derivative"
    return _short_steps(description) or needs_indices(description)


DEMANDS: Mapping[str, Demand] = {
    "input-derivative": Demand(
        "error",
        "4.2.1",
        "with canInterpolateInputs the derivatives of the inputs have their effect on the next step",
        "let the inputs follow the polynomial from the beginning of the step",
    ),
    "input-derivative-kept": Demand(
        "warning",
        "4.2.1",
        "derivatives of inputs are set for the beginning of one step",
        "forget them when the step is made",
    ),
    "derivative": Demand(
        "error",
        "2.2.7",
        "a variable with the attribute derivative is that derivative",
        "compute it at the same time",
    ),
    "derivative-order-zero": Demand("warning", "4.2.1", "orders begin at 1", "return fmi2Error"),
    "output-derivative": Demand(
        "error",
        "4.2.1",
        "derivatives of outputs, up to maxOutputDerivativeOrder, are those at the end of the step",
        "derive the outputs, or declare a lower order",
    ),
}
CHECKS = (
    input_derivatives(1),
    input_derivatives(2),
    Check("derivative-order-zero", order_zero, _interpolates),
    Check("input-derivative-kept", input_derivatives_end, _interpolates),
    output_derivatives(1),
    output_derivatives(2),
    output_derivatives(3),
    Check("derivative", states_derivatives, _derivatives),
)
