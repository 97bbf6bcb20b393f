"""Derivatives by time: of inputs, that a step is given, and of outputs, that it gives (section 4.2.1)."""

from collections.abc import Iterator
from ctypes import c_double, c_int, c_uint

from .check import Check
from .description import Description
from .driver import Fmu, Refused
from .finding import Finding
from .runs import SMALL, inputs_at, run, size_of

PARTS = 64  # steps in place of one; a ramp held in the middle of each leaves 1/PARTS² of its effect
AGREE = 0.05  # of the effect; a jump at the end, where the outputs hold the inputs at once, is 1/(2 PARTS)
SHORT = 1 / 64  # of a step: over which outputs are differenced


def input_derivatives(fmu: Fmu) -> Iterator[Finding]:
    """One step under a ramp is what many short steps with held inputs come to."""
    ramps = {v: SMALL * size_of(v) / fmu.h for v in fmu.description.real_inputs}
    outputs = fmu.description.real_outputs
    ends = []
    for way in ("held", "ramp", "stairs"):
        slave = fmu.slave().initialise(fmu.start)
        run(fmu, slave, 0, 3)
        base = {v: float(x) for v, x in inputs_at(fmu, 2).items() if v in ramps}
        slave.set(base)
        if way == "ramp":
            slave.set_rates(ramps)
        parts = PARTS if way == "stairs" else 1
        h = fmu.h / parts
        for k in range(parts):
            if way == "stairs":
                slave.set({v: base[v] + ramps[v] * (k + 0.5) * h for v in ramps})
            slave.step(fmu.point(3) + k * h, h)
        ends.append({v: float(x) for v, x in slave.get(outputs).items()})
        slave.free()
    held, ramp, stairs = ends
    for v in outputs:
        effect = stairs[v] - held[v]
        if abs(ramp[v] - stairs[v]) > AGREE * abs(effect) + 1e-9 * abs(held[v]):
            yield Finding(
                "input-derivative",
                f"a ramp of the inputs moves {v.name} by {ramp[v] - held[v]:.6g} in one step, "
                f"by {effect:.6g} in {PARTS}",
            )
            return


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
        slave = fmu.slave().initialise(fmu.start)
        run(fmu, slave, 0, 4)
        slave.set(inputs_at(fmu, 3))  # nothing jumps
        h = fmu.h * SHORT
        try:
            rates, levels = [], []
            for k in range(3):
                slave.step(fmu.point(4) + k * h, h)
                rates.append(slave.output_rates(references, order))
                low = (
                    list(slave.get(outputs).values())
                    if order == 1
                    else slave.output_rates(references, order - 1)
                )
                levels.append([float(x) for x in low])
        except Refused as refused:
            yield Finding("output-derivative", f"of order {order}: {refused}")
            return
        slave.free()
        for k, v in enumerate(outputs):
            got = rates[1][k]
            found = (levels[2][k] - levels[0][k]) / (2 * h)
            bend = abs(rates[2][k] - rates[0][k])  # how much the derivative itself changes meanwhile
            noise = 1e4 * 2.2e-16 * abs(levels[1][k]) / h
            if abs(got - found) > AGREE * max(abs(got), abs(found)) + bend + noise:
                yield Finding(
                    "output-derivative",
                    f"of order {order} of {v.name}: {got:.6g}, by differences {found:.6g}",
                )
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


CHECKS = (
    Check("input-derivative", input_derivatives, lambda d: _interpolates(d) or _short_steps(d)),
    Check("derivative-order-zero", order_zero, _interpolates),
    output_derivatives(1),
    output_derivatives(2),
)
