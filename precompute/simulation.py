"""One FMU run by FMPy: inputs over time in, outputs over time out."""

import math
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import fmpy
import numpy as np
from numpy.typing import NDArray

from .arrays import Floats
from .errors import ModalFmuError
from .fmu_face import Face
from .interrupt import deferred_interrupt
from .notice import notice, warning
from .signals import signals_of

MANY = 20_000  # steps that a run takes unasked
LIMIT = 10_000_000  # steps whose results still fit into memory
STATUS_WARNING, STATUS_ERROR = 1, 3  # fmi2Warning, fmi2Error


@dataclass(frozen=True)
class Simulation:
    """Recorded values, each (n,), at the n times; inputs are those held over the step that ends there.

    result: structured array with the field `time` (s); q: (n, r) modal amplitudes, r = 0 if not recorded.
    """

    face: Face
    result: NDArray[Any]
    q: Floats

    @property
    def time(self) -> Floats:
        """(n,) s."""
        return np.asarray(self.result["time"])


def simulate(
    face: Face,
    signals: NDArray[Any] | None = None,
    start_values: Mapping[str, float] | None = None,
    stop: float | None = None,
    step: float | None = None,
    *,
    record_modes: bool = False,
    progress: Callable[[str, float | None], None] = lambda stage, fraction: None,
) -> Simulation:
    """FMPy advances the FMU from its start time to `stop` in steps of `step` (s; None: DefaultExperiment).

    signals: as of `read_signals`, linear in between; the FMU holds an input over each step. Inputs without a
    signal keep their value of `start_values`, or their start value. What the FMU logs becomes warnings.
    Raises ModalFmuError with the FMU's own words where it refuses a step.
    """
    stop, step = _experiment(face, stop, step)
    values = dict(start_values or {})
    if signals is not None and signals["time"][-1] > stop * (1 + 1e-9):
        notice(f"the input goes on until {signals['time'][-1]:g} s, the simulation ends at {stop:g} s")
    log: list[tuple[int, str]] = []
    reached = face.start

    def logged(_: object, __: object, status: int, ___: object, message: bytes) -> None:
        log.append((status, message.decode(errors="replace")))

    def step_finished(time: float, _: object) -> bool:
        nonlocal reached
        check_interrupt()
        if time <= reached:
            raise ModalFmuError(_refusal(face, reached, log, "the step was discarded"))
        reached = time
        progress("simulating", (time - face.start) / (stop - face.start))
        return True

    amplitudes = face.amplitudes if record_modes else []
    with (
        tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder,
        deferred_interrupt() as check_interrupt,
    ):
        try:
            fmpy.extract(str(face.path), folder)
            result = fmpy.simulate_fmu(
                folder,
                validate=False,
                model_description=face.description,
                start_time=face.start,
                stop_time=stop,
                output_interval=step,
                fmi_type="CoSimulation",
                start_values=_typed(values, face),
                input=None if signals is None else _complete(signals, face, values),
                output=[*face.inputs, *face.outputs, *amplitudes],
                debug_logging=True,
                logger=logged,
                step_finished=step_finished,
            )
        except ModalFmuError:
            raise
        except Exception as error:  # noqa: BLE001  FMPy raises bare Exception
            raise ModalFmuError(_refusal(face, reached, log, str(error))) from None
    if reached < stop and not math.isclose(reached, stop):
        raise ModalFmuError(_refusal(face, reached, log, "the FMU asked to stop"))
    for message in dict.fromkeys(text for status, text in log if status >= STATUS_WARNING):
        warning(f"{face.path.name}: {message}")
    q = np.array([result[name] for name in amplitudes]).reshape(len(amplitudes), len(result)).T
    return Simulation(face, np.asarray(result[["time", *face.inputs, *face.outputs]]), q)


def _experiment(face: Face, stop: float | None, step: float | None) -> tuple[float, float]:
    """Stop time and step size in s, the FMU's own where none is given."""
    end = stop if stop is not None else face.stop if face.stop is not None else face.start + 1.0
    if not (math.isfinite(end) and end > face.start):
        raise ModalFmuError(f"--stop-time: got {end:g} s, expected a finite time after {face.start:g} s")
    h = step if step is not None else min(face.step or (end - face.start) / 1000, end - face.start)
    if not (math.isfinite(h) and h > 0):
        raise ModalFmuError(f"--step: got {h:g} s, expected a finite step size > 0")
    steps = (end - face.start) / h
    if step is not None and steps > LIMIT:
        raise ModalFmuError(
            f"--step: got {h:g} s, {steps:.3g} steps, expected at most {LIMIT:.0e}; take longer ones"
        )
    if step is None and steps > MANY:
        h *= math.ceil(steps / MANY)
        notice(
            f"the FMU suggests {steps:.3g} steps; to keep to {MANY} they are {h:g} s long, or as --step says"
        )
    return end, h


def _complete(signals: NDArray[Any], face: Face, values: Mapping[str, float]) -> NDArray[Any]:
    """With a column for every input: FMPy prints a line for each that has none.

    One row is held for ever; FMPy wants two.
    """
    if len(signals) == 1:
        signals = np.concatenate([signals, signals])
        signals["time"][1] += 1.0
    given = list(signals.dtype.names or ())
    rest = [name for name in face.inputs if name not in given]
    columns = [signals[name] for name in given]
    columns += [np.full(len(signals), values.get(name, _start(face, name))) for name in rest]
    return signals_of([*given, *rest], np.stack(columns, axis=1))


def _start(face: Face, name: str) -> float:
    start = face.variables[name].start
    return {"true": 1.0, "false": 0.0}.get(str(start)) or float(start or 0.0)


def _typed(values: Mapping[str, float], face: Face) -> dict[str, Any]:
    return {name: bool(x) if face.variables[name].type == "Boolean" else x for name, x in values.items()}


def _refusal(face: Face, time: float, log: Sequence[tuple[int, str]], otherwise: str) -> str:
    said = [text for status, text in log if status >= STATUS_ERROR] or [text for _, text in log]
    return f"{face.path.name}: stopped at {time:g} s: {said[-1] if said else otherwise}"
