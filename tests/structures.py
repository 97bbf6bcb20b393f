"""Models whose structure differs, what modelDescription.xml says of it, and instances to vary knowns in."""

from collections.abc import Callable, Mapping
from itertools import chain

import numpy as np
from examples import everything, two_ports
from native_fmu import CO_SIMULATION, MODEL_EXCHANGE, OK, Instance, NativeFmu
from ready_parts import reduction

from fmu_src.runtime.model import ReducedModel

ELASTIC = (3.0, 7.0, 30.0, 30.0, 400.0, 9000.0)


def static() -> ReducedModel:
    """Every entry of B and C is there; starts in equilibrium."""
    return two_ports(lam=np.array(ELASTIC), initial="static")


def gaps(initial: str) -> ReducedModel:
    """Scattered zeros, and whole ones: a mode that nothing drives or shows, a dead input, a dead output."""
    full = two_ports()
    B, C = full.B.copy(), full.C.copy()
    B[[0, 3], 0] = B[2, :] = B[:, 1] = 0.0
    C[1, 3:] = C[2, :2] = C[3, :] = C[:, 4] = 0.0
    lam = np.array(ELASTIC)
    if initial == "rest":
        lam[:2] = 0.0
    return two_ports(lam=lam, B=B, C=C, initial=initial)


def gaps_at_rest() -> ReducedModel:
    return gaps("rest")


def gaps_static() -> ReducedModel:
    return gaps("static")


def everything_static() -> ReducedModel:
    """Every law, feed-through, and coupled modes, from equilibrium."""
    return everything(lam=np.array([*ELASTIC, 2e4]), initial="static")


def cantilever() -> ReducedModel:
    return reduction("cantilever").model


MODELS: Mapping[str, Callable[[], ReducedModel]] = {
    "two_ports": two_ports,
    "static": static,
    "gaps": gaps_at_rest,
    "gaps static": gaps_static,
    "everything": everything,
    "everything static": everything_static,
    "cantilever": cantilever,
}


def declared(fmu: NativeFmu, *groups: str) -> dict[str, set[str]]:
    """Names of the unknowns of ModelStructure's groups → names of their knowns.

    groups: "outputs", "derivatives", "initialUnknowns".
    """
    unknowns = chain.from_iterable(getattr(fmu.description, group) for group in groups)
    return {u.variable.name: {known.name for known in u.dependencies} for u in unknowns}


def names(fmu: NativeFmu, beginning: str) -> list[str]:
    return [name for name in fmu.reference if name.startswith(beginning)]


def inputs(fmu: NativeFmu) -> list[str]:
    return [v.name for v in fmu.description.modelVariables if v.causality == "input"]


def states(fmu: NativeFmu) -> list[str]:
    """Amplitudes, then velocities: the order of the continuous states."""
    return names(fmu, "modes.amplitude[") + names(fmu, "modes.velocity[")


def settable_states(fmu: NativeFmu) -> list[str]:
    """Those that have start values: not the amplitudes of a static start."""
    exact = {v.name for v in fmu.description.modelVariables if v.initial == "exact"}
    return [name for name in states(fmu) if name in exact]


def set_states(part: Instance, values: Mapping[str, float]) -> None:
    """Some of the continuous states, in continuous-time mode."""
    x, order = part.get_states(), states(part.fmu)
    for name, value in values.items():
        x[order.index(name)] = value
    assert part.set_states(x) == OK


def initialising(fmu: NativeFmu, values: Mapping[str, float]) -> Instance:
    """In initialization mode."""
    part = fmu.instance(CO_SIMULATION)
    part.must("SetupExperiment", 0, 0.0, 0.0, 0, 0.0)
    part.must("EnterInitializationMode")
    assert part.set(values) == OK
    return part


def stepping(fmu: NativeFmu, values: Mapping[str, float]) -> Instance:
    """At a communication point; of the states those with start values.

    With inputs given, a static start is that of other inputs.
    """
    start = dict.fromkeys(inputs(fmu), 0.7) if values.keys() & {*inputs(fmu)} else {}
    part = initialising(fmu, {**values, **start})
    part.must("ExitInitializationMode")
    assert part.set({k: v for k, v in values.items() if k in inputs(fmu)}) == OK
    return part


def integrating(fmu: NativeFmu, values: Mapping[str, float]) -> Instance:
    """In continuous-time mode of model exchange."""
    own = states(fmu)
    part = fmu.instance(MODEL_EXCHANGE).initialise({k: v for k, v in values.items() if k not in own})
    part.must("EnterContinuousTimeMode")
    set_states(part, {k: v for k, v in values.items() if k in own})
    return part


def at_event(fmu: NativeFmu, values: Mapping[str, float]) -> Instance:
    """In event mode of model exchange."""
    part = integrating(fmu, values)
    part.must("EnterEventMode")
    return part
