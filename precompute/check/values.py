"""Values of variables: start values, what is set, what may not be set, ranges (sections 2.1.7, 2.2.7)."""

import ctypes
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from ctypes import c_int, c_size_t, c_void_p

from .check import Check
from .description import Description, Value, Variable
from .driver import Fmu, Slave, arrays
from .finding import Demand, Finding
from .instances import several
from .library import DISCARD, OK, WARNING
from .runs import difference, inputs_at, moved, run, shown, tuned

SIX_DIGITS = 1e-6  # relative: what some exporters write of a start value
MOST = 5  # variables that are named in one finding
MANY = 200  # variables that are set at once


def differs(variable: Variable, got: Value, expected: Value) -> bool:
    """Reals to six digits, all else exactly."""
    if isinstance(got, float) and isinstance(expected, int | float):
        return not abs(got - expected) <= SIX_DIGITS * abs(expected)
    return bool(got) != expected if variable.type == "Boolean" else got != expected


def start_values(fmu: Fmu) -> Iterator[Finding]:
    """Initialised with nothing set, exact variables and inputs have their start values."""
    slave = fmu.slave().initialise(fmu.start)
    known = [
        v
        for v in fmu.description.variables
        if v.start is not None and (v.initial == "exact" or v.causality == "input")
    ]
    got = slave.get(known)
    wrong = [v for v in known if v.start is not None and differs(v, got[v], v.start)]
    for v in wrong[:MOST]:
        yield Finding("start-values", f"{v.name} is {shown(got[v])}, declared start={shown(v.start or 0)}")
    slave.free()


def kept(fmu: Fmu) -> Iterator[Finding]:
    """Inputs and tunable parameters have, after a step, the value that was set before it."""
    slave = fmu.slave().initialise(fmu.start)
    run(fmu, slave, 0, 2)
    given = {**inputs_at(fmu, 2), **tuned(fmu.description)}
    slave.set(given)
    slave.step(fmu.point(2), fmu.h)
    got = slave.get(given)
    wrong = [v for v in given if differs(v, got[v], given[v])]
    for v in wrong[:MOST]:
        yield Finding(
            "set-lost", f"{v.name} was set to {shown(given[v])}, after a step it is {shown(got[v])}"
        )
    slave.free()


def not_settable(name: str, said: str, causality: str, variability: str) -> Check:
    """Setting what the FMU computes, or what never changes."""

    def chosen(description: Description) -> list[Variable]:
        return [
            v
            for v in description.variables
            if v.type == "Real"
            and (v.causality == causality or not causality)
            and v.variability == variability
        ]

    def check(fmu: Fmu) -> Iterator[Finding]:
        v = chosen(fmu.description)[0]
        slave = fmu.slave().initialise(fmu.start)
        run(fmu, slave, 0, 2)
        before = float(slave.get([v])[v])
        if slave.unnoticed("SetReal", *arrays("Real", [v.reference], [before + 1.0])):
            yield Finding(name, f"fmi2SetReal of the {said} {v.name} gave fmi2OK")
        slave.free()

    def hindrance(description: Description) -> str | None:
        return None if chosen(description) else f"there is no Real {said}"

    return Check(name, check, hindrance, crash=name)


def finite(fmu: Fmu) -> Iterator[Finding]:
    """What steps of fmi2OK give are numbers, within the declared min and max."""
    slave = fmu.slave().initialise(fmu.start)
    told: set[str] = set()
    for k, row in enumerate(run(fmu, slave, 0, fmu.steps)):
        for v, value in row.items():
            if v.type != "Real" or not isinstance(value, float) or v.name in told:
                continue
            after = f"{v.name} is {shown(value)} after step {k + 1}"
            if not math.isfinite(value):
                told.add(v.name)
                yield Finding("not-finite", after)
            low = -math.inf if v.minimum is None else v.minimum
            high = math.inf if v.maximum is None else v.maximum
            slack = SIX_DIGITS * max(abs(value), 1e-300)
            if value < low - slack or value > high + slack:
                told.add(v.name)
                yield Finding("out-of-range", f"{after}, declared min={low:g}, max={high:g}")
    slave.free()


def not_a_number(name: str, chosen: Callable[[Description], Sequence[Variable]]) -> Check:
    """NaN is refused, by the setter or the step; and a reset brings the instance back."""

    def check(fmu: Fmu) -> Iterator[Finding]:
        slave = fmu.slave().initialise(fmu.start)
        run(fmu, slave, 0, 1)
        v = chosen(fmu.description)[0]
        before = len(slave.host.log)
        status = slave.call("SetReal", *arrays("Real", [v.reference], [math.nan]))
        status = max(status, slave.call("DoStep", fmu.point(1), fmu.h, 1))
        told = any(message.status >= DISCARD for message in slave.host.log[before:])
        if status == OK and not told:
            yield Finding("nan-accepted", f"a step with {v.name} = NaN gave fmi2OK, and nothing was logged")
        slave.must("Reset")
        slave.initialise(fmu.start)
        fresh = fmu.slave("fresh").initialise(fmu.start)
        apart = difference(run(fmu, fresh, 0, 3), run(fmu, slave, 0, 3))
        if apart:
            yield Finding("reset", f"reset after a step with {v.name} = NaN, {apart}")
        fresh.free()
        slave.free()

    def hindrance(description: Description) -> str | None:
        return several(description) or (None if chosen(description) else f"there is no such {name}")

    return Check(f"NaN in a {name}", check, hindrance)


def strings_copied(fmu: Fmu) -> Iterator[Finding]:
    """A text that was set is the FMU's own from then on."""
    v = _settable_strings(fmu.description)[0]
    slave: Slave = fmu.slave()
    text = ctypes.create_string_buffer(b"a text of the host")
    values = (c_void_p * 1)(ctypes.addressof(text))
    slave.must("SetString", (c_int * 1)(v.reference), c_size_t(1), values)
    ctypes.memset(text, ord("x"), len(text) - 1)
    slave.initialise(fmu.start)
    run(fmu, slave, 0, 1)
    got = slave.get([v])[v]
    if got != "a text of the host":
        yield Finding("string-kept", f"{v.name} was set to 'a text of the host', overwritten it is {got!r}")
    slave.free()


def _settable_strings(description: Description) -> list[Variable]:
    return [
        v
        for v in description.variables
        if v.type == "String" and v.initial == "exact" and v.variability != "constant"
    ]


def _no_strings(description: Description) -> str | None:
    return None if _settable_strings(description) else "no String can be set before initialisation"


def set_early(fmu: Fmu) -> Iterator[Finding]:
    """What has a start value can be set before and during initialization mode, and has its effect."""
    exact = [
        v
        for v in fmu.description.variables
        if v.type == "Real"
        and v.initial == "exact"
        and v.variability != "constant"
        and v.causality != "output"
    ]
    given = {v: moved(v, 0.5) for v in exact[:MANY]}
    ends = []
    for mode in ("before fmi2EnterInitializationMode", "in initialization mode"):
        slave = fmu.slave()
        slave.setup(fmu.start)
        if mode == "in initialization mode":
            slave.must("EnterInitializationMode")
        slave.set(given)
        if mode != "in initialization mode":
            slave.must("EnterInitializationMode")
        slave.must("ExitInitializationMode")
        got = slave.get(given)
        wrong = [v for v in given if differs(v, got[v], given[v])]
        for v in wrong[:MOST]:
            yield Finding("set-lost", f"{v.name} was set to {shown(given[v])} {mode}, it is {shown(got[v])}")
        ends.append(run(fmu, slave, 0, 2))
        slave.free()
    apart = difference(ends[0], ends[1])
    if apart:
        yield Finding("set-lost", f"start values set in initialization mode instead of before it: {apart}")


def bounds(fmu: Fmu) -> Iterator[Finding]:
    """Parameters and inputs can be set to the min and the max that are declared for them, each by itself."""
    slave: Slave | None = None
    named = 0
    for v in fmu.description.variables:
        if v.type not in ("Real", "Integer") or v.causality not in ("parameter", "input"):
            continue
        for bound, value in (("min", v.minimum), ("max", v.maximum)):
            if value is None or named >= MOST:
                continue
            slave = slave or _initialising(fmu)
            given = int(value) if v.type == "Integer" else value
            status = slave.call(f"Set{v.type}", *arrays(v.type, [v.reference], [given]))
            if status not in (OK, WARNING):
                named += 1
                yield Finding("bound-refused", f"{v.name} cannot be set to its {bound}={value:g}")
                slave.free()
                slave = None
    if slave:
        slave.free()


def _initialising(fmu: Fmu) -> Slave:
    slave = fmu.slave()
    slave.setup(fmu.start)
    slave.must("EnterInitializationMode")
    return slave


def reading(fmu: Fmu) -> Iterator[Finding]:
    """Reading does not change anything, and writes no more than it is asked for."""
    rows = []
    for times in (0, 3):
        slave = fmu.slave().initialise(fmu.start)
        for k in range(8):
            slave.set(inputs_at(fmu, k))
            slave.step(fmu.point(k), fmu.h)
            for _ in range(times):
                slave.get(fmu.description.variables)
        rows.append(slave.get(fmu.description.variables))
        overrun = slave.overrun
        slave.free()
    apart = difference(rows[:1], rows[1:])
    if apart:
        yield Finding("reading-changes", f"with all variables read three times after each step, {apart}")
    if overrun:
        yield Finding("array-overrun", overrun)


DEMANDS: Mapping[str, Demand] = {
    "start-values": Demand(
        "error",
        "2.2.7",
        "variables with initial=exact and inputs begin with their start values",
        "take the start values of model description and code from one source",
    ),
    "set-lost": Demand(
        "error", "2.1.7", "what is set stays until it is set again", "store it, and give it back when asked"
    ),
    "set-constant": Demand("warning", "2.2.7", "constants cannot be set", "return fmi2Error"),
    "set-output": Demand("warning", "4.2.4", "between steps outputs cannot be set", "return fmi2Error"),
    "set-fixed": Demand(
        "warning",
        "4.2.4",
        "fixed parameters cannot be set after initialisation",
        "return fmi2Error, or declare it tunable",
    ),
    "not-finite": Demand(
        "error", "2.1.3", "a step of fmi2OK gives numbers", "return fmi2Discard or fmi2Error with the reason"
    ),
    "out-of-range": Demand(
        "warning", "2.2.7", "values keep to their min and max", "widen the range that is declared"
    ),
    "nan-accepted": Demand(
        "note",
        "4.2.2",
        "a step that cannot be made with its inputs or parameters is fmi2Error or fmi2Discard",
        "refuse values that are no numbers",
    ),
    "bound-refused": Demand(
        "warning", "2.2.7", "values from min to max can be set", "narrow the range that is declared"
    ),
    "reading-changes": Demand(
        "error", "2.1.7", "fmi2GetXXX changes nothing", "compute what is read, and leave the state alone"
    ),
    "array-overrun": Demand("error", "2.1.7", "fmi2GetXXX writes nvr values", "count them"),
    "string-kept": Demand("error", "2.1.7", "fmi2SetString copies the texts", "copy them"),
}
CHECKS = (
    Check("start-values", start_values),
    Check("set-early", set_early),
    Check("set-lost", kept),
    Check("bounds", bounds),
    Check("reading", reading),
    not_settable("set-constant", "constant", "", "constant"),
    not_settable("set-output", "output", "output", "continuous"),
    not_settable("set-fixed", "fixed parameter after initialisation", "parameter", "fixed"),
    Check("not-finite", finite),
    not_a_number("continuous input", lambda d: d.real_inputs),
    not_a_number("tunable parameter", lambda d: [*tuned(d)]),
    Check("string-kept", strings_copied, _no_strings, crash="string-kept"),
)
