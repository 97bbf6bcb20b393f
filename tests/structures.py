"""Models whose structure differs, what modelDescription.xml says of it, and instances to vary knowns in."""

from collections.abc import Callable, Mapping
from itertools import chain

import numpy as np
from driven import driven, part, reduced
from examples import everything, two_ports
from native_fmu import CO_SIMULATION, MODEL_EXCHANGE, OK, Instance, NativeFmu
from ready_parts import reduction

from fmu_src.runtime.kinds import ROWS, STATIC_LAWS
from fmu_src.runtime.model import ReducedModel, row_starts

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


def moved() -> ReducedModel:
    """Ports driven in three directions, every law, modes coupled by dashpots that drag them."""
    return driven()


def moved_static() -> ReducedModel:
    """The same from equilibrium, and what is off follows statically."""
    return reduced(part(), initial="static", **residual(driven()))


def residual(model: ReducedModel) -> dict[str, object]:
    """Feed-through of every input to what has one."""
    rng = np.random.default_rng(14)
    m, rows = len(model.inputs), [ROWS[law] * [law in STATIC_LAWS] for law in model.laws]
    S = rng.standard_normal((m, m))
    R = model.R + 1e-3 * rng.standard_normal(model.R.shape) * np.concatenate(rows)[:, None]
    return {"R": R, "R_in": 1e-3 * (S @ S.T), "residual": True}


def moved_gaps(initial: str) -> ReducedModel:
    """Scattered zeros: modes that nothing drags, or α alone, or dashpots alone; a dead motion."""
    full = driven()
    B, C, D_rest, K_s = (getattr(full, key).copy() for key in ("B", "C", "D_rest", "K_s"))
    k, laws = full.k, full.laws
    B[k, full.motions] = B[k + 1, full.motions[1:]] = B[k + 2 :, full.motions[2]] = 0.0
    D_rest[k:, k:] *= np.eye(full.r)
    for mode, motions in ((k, [0, 1, 2]), (k + 1, [0, 2]), (k + 3, [1])):
        D_rest[mode, motions] = D_rest[motions, mode] = 0.0
    D_rest[k + 4 :, :k] = D_rest[:k, k + 4 :] = 0.0
    K_s[2] = K_s[:, 2] = 0.0
    first = row_starts(laws)[full.outputs.index("left.reaction.y")]
    C[first, :3] = C[first, k + 1 :] = C[first + 1] = C[first + 2, 1:] = 0.0
    last = row_starts(laws)[full.outputs.index("clamp.reaction.z")]
    C[last, : k + 3] = C[last + 2] = 0.0
    through = residual(full) if initial == "static" else {}
    return reduced(part(), B=B, C=C, D_rest=D_rest, K_s=K_s, initial=initial, **through)


def moved_gaps_at_rest() -> ReducedModel:
    return moved_gaps("rest")


def moved_gaps_static() -> ReducedModel:
    return moved_gaps("static")


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
    "moved": moved,
    "moved static": moved_static,
    "moved gaps": moved_gaps_at_rest,
    "moved gaps static": moved_gaps_static,
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
    """The continuous states in their order: what the derivatives of ModelStructure are derivatives of."""
    return [unknown.variable.derivative.name for unknown in fmu.description.derivatives]


def settable_states(fmu: NativeFmu) -> list[str]:
    """Those that have start values: not the amplitudes of a static start, nor prescribed motions."""
    exact = {v.name for v in fmu.description.modelVariables if v.initial == "exact"}
    return [name for name in states(fmu) if name in exact]


def starts(fmu: NativeFmu) -> list[str]:
    """The parameters with which prescribed motions start."""
    return [v.name for v in fmu.description.modelVariables if v.variability == "fixed"]


def start_of(fmu: NativeFmu) -> dict[str, str]:
    """State → the parameter that it starts from, of prescribed motions."""
    return {name.replace(".start_", ".prescribed_"): name for name in starts(fmu)}


def static_start(fmu: NativeFmu) -> bool:
    """Whether amplitudes follow from inputs, and from the velocities of prescribed motions."""
    return len(settable_states(fmu)) + len(start_of(fmu)) < len(states(fmu))


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
    """At a communication point; of the states those with start values, of the others what starts them.

    With inputs given, a static start is that of other inputs.
    """
    start = dict.fromkeys(inputs(fmu), 0.7) if values.keys() & {*inputs(fmu)} else {}
    begins = start_of(fmu)
    part = initialising(fmu, {**{begins.get(name, name): value for name, value in values.items()}, **start})
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
