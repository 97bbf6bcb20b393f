"""Experiments with their results: what an FMU of the reduced model must give, computed by the Python twin."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fmu_src.description import default_experiment
from fmu_src.runtime.instance import Instance
from fmu_src.runtime.kinds import outputs_of
from fmu_src.runtime.model import ReducedModel

from .arrays import Floats
from .signals import signals_of

TOLERANCE = (
    1e-9  # of the peak: the twins agree to 1e-12, results are kept to 12 digits, h of a master jitters
)
STEPS = (100, 50, 20)  # the first that keeps to
CELLS = 20_000  # numbers in one table: some 200 kB
OUTPUTS = 400  # of more, evenly chosen ones
CYCLES = 5  # periods of the slowest signal over the experiment


@dataclass(frozen=True)
class Experiment:
    """Inputs over time, each held over the step that begins at its row, and what the outputs are then.

    stimuli, references: structured arrays with a field `time` (s) and one per input, per output (SI). A row
    of references is of the end of the step that leads there; the first one is of the initialised model.
    tolerance: of the differences from the references, as `difference` measures them.
    """

    name: str
    description: str
    start: float
    stop: float
    step: float
    tolerance: float
    stimuli: NDArray[Any]
    references: NDArray[Any]

    @property
    def inputs(self) -> list[str]:
        """Names of the inputs that have stimuli."""
        return [name for name in self.stimuli.dtype.names or () if name != "time"]

    @property
    def outputs(self) -> list[str]:
        """Names of the outputs that have references."""
        return [name for name in self.references.dtype.names or () if name != "time"]


def difference(experiment: Experiment, result: NDArray[Any], units: Mapping[str, str]) -> dict[str, float]:
    """max |y − y_ref| of each output over the experiment, as a part of the largest |y_ref| of its unit.

    An output that is only rounding beside others of its unit has no digits of its own to compare. result: as
    references, a row at each of their times; units: name → unit. NaN counts as infinite.
    """
    peak: dict[str, float] = {}
    for name in experiment.outputs:
        unit = units.get(name, "")
        peak[unit] = max(peak.get(unit, 0.0), float(np.abs(experiment.references[name]).max()))
    found = {}
    for name in experiment.outputs:
        apart = float(np.abs(result[name] - experiment.references[name]).max())
        scale = peak[units.get(name, "")]
        part = apart / scale if scale > 0 else apart
        found[name] = math.inf if math.isnan(part) else part
    return found


def reference_experiments(model: ReducedModel) -> tuple[Experiment, ...]:
    """A step of all inputs, and signals of different frequencies; none for a part without inputs or outputs.

    Both last as long as the default experiment. Inputs have sizes, powers of ten, with which they move the
    modes about as much as each other, so that none is lost beside another. A static start is in equilibrium
    with a step and never moves: it has the signals only.
    """
    if not (model.inputs and model.outputs):
        return ()
    stop, _ = default_experiment(model)
    kept = list(range(0, len(model.outputs), -(-len(model.outputs) // OUTPUTS)))
    columns = len(model.inputs) + len(kept)
    n = next((n for n in STEPS if n * columns <= CELLS), STEPS[-1])
    size = _sizes(model.B[model.k :])
    more = max(n / 4 - CYCLES, 0.0)  # four steps in the shortest period
    cycles = CYCLES + more * np.arange(len(size)) / max(len(size), 2)
    held = np.cos(2 * np.pi * np.arange(n + 1)[:, None] / n * cycles)
    jump = ("step", "All inputs jump at the start and stay as they are.", np.ones_like(held))
    signals = ("signals", "Each input is a cosine of its own frequency, held over each step.", held)
    about = (signals,) if model.initial == "static" else (jump, signals)
    found = (_experiment(model, name, text, stop, kept, u * size) for name, text, u in about)
    return tuple(experiment for experiment in found if experiment.outputs)


def _sizes(B: Floats) -> Floats:
    """(m,) 10ᵏ with |size·b| within a factor of √10 of the largest column |b| of B."""
    length = np.linalg.norm(B, axis=0)
    ratio = np.divide(length.max(), length, out=np.ones_like(length), where=length > 0)
    sizes: Floats = 10.0 ** np.clip(np.round(np.log10(ratio)), 0, 12)
    return sizes


def _experiment(
    model: ReducedModel, name: str, text: str, stop: float, kept: list[int], u: Floats
) -> Experiment:
    """u: (n + 1, m), held from row to row; kept: which outputs."""
    u = np.array([[float(f"{x:.6g}") for x in row] for row in u])  # as it is written
    n = len(u) - 1
    h, time = stop / n, np.array([stop * k / n for k in range(n + 1)])
    stimuli = signals_of(["time", *model.inputs], np.column_stack([time, u]))

    def with_results(y: Floats, kept: list[int]) -> Experiment:
        names = ["time", *(model.outputs[k] for k in kept)]
        references = signals_of(names, np.column_stack([time, y[:, kept]]))
        return Experiment(name, text, 0.0, stop, h, TOLERANCE, stimuli, references)

    units = {f"{p.name}.{key}": outputs_of(p.name)[key].unit for p in model.ports for key in p.outputs}
    y = _outputs(model, h, u)
    nudged = with_results(_outputs(_nudged(model), h, u), kept)
    doubt = difference(with_results(y, kept), nudged.references, units)
    return with_results(y, [k for k in kept if doubt[model.outputs[k]] <= TOLERANCE / 10])


def _outputs(model: ReducedModel, h: float, u: Floats) -> Floats:
    """(n + 1, p): at the start, initialised with the first row of u, and after each of n steps of h."""
    instance = Instance(model)
    instance.set_inputs(slice(None), u[0])
    y = [instance.reals()[instance.layout.outputs].copy()]
    instance.initialising = False
    for row in u[:-1]:
        instance.set_inputs(slice(None), row)
        refused = instance.advance(instance.time, h)
        assert refused is None, refused  # finite inputs, and times of the motion's own
        y.append(instance.reals()[instance.layout.outputs].copy())
    return np.array(y)


def _nudged(model: ReducedModel) -> ReducedModel:
    """The model with B, C, R off by roundings.

    An output that is then another is what the rounding of terms that cancel leaves, such as a rotation that
    symmetry forbids: it differs from one processor to the next.
    """
    rng = np.random.default_rng(0)

    def nudge(A: Floats) -> Floats:
        return A * (1.0 + 1e-14 * rng.uniform(-1.0, 1.0, A.shape))

    k = model.k  # rows of prescribed motions, which are as they are
    B = np.concatenate([model.B[:k], nudge(model.B[k:])])
    return replace(model, B=B, C=nudge(model.C), R=nudge(model.R))
