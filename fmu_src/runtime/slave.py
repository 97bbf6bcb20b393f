"""The FMI glue of the Python twin: calls of pythonfmu become calls of `Instance`.

An exception that leaves a method is fatal in pythonfmu and tears the instance down, and an error status
cannot be returned. So a call that is not legal is logged with its reason and changes nothing, and a
step that cannot be made is discarded (fmi2Discard).
"""

import json
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from pythonfmu import Fmi2Slave
from pythonfmu.enums import Fmi2Status

from .host import release_interpreter
from .instance import SAME_POINT, Instance
from .resources import read_model

MODES = {
    "instantiated": "called before fmi2EnterInitializationMode",
    "initialising": "called before fmi2ExitInitializationMode",
    "stepping": "called after fmi2ExitInitializationMode",
    "terminated": "called after fmi2Terminate",
}
READABLE = ("initialising", "stepping", "terminated")
SETTABLE = ("instantiated", "initialising", "stepping")


class ModalSlave(Fmi2Slave):  # type: ignore[misc]  # pythonfmu carries no types
    """A reduced model that pythonfmu runs; the description is written by the packaging, not by it."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        model = read_model(Path(self.resources) / "model")
        self.modelName = model.name
        release_interpreter(Path(self.resources), model.name)
        self._instance = Instance(model)
        self._mode, self._stop = "instantiated", math.inf
        self._asked: list[int] = []
        self._places = np.zeros(0, dtype=np.intp)

    def _refuse(self, reason: str) -> None:
        self.log(f"{reason}; nothing was changed", Fmi2Status.error)

    def setup_experiment(self, start_time: float, stop_time: float | None, tolerance: float | None) -> None:
        """Begin at start_time, never step past stop_time; a tolerance means nothing to an exact step."""
        if not self._legal("fmi2SetupExperiment", "instantiated"):
            return
        stop = math.inf if stop_time is None else stop_time
        if not (math.isfinite(start_time) and stop >= start_time):
            self._refuse(
                f"fmi2SetupExperiment: startTime is {start_time}, stopTime {stop}, "
                "expected a finite number and none before it"
            )
        else:
            self._instance.time, self._stop = start_time, stop

    def enter_initialization_mode(self) -> None:
        """From here on variables have values."""
        if self._legal("fmi2EnterInitializationMode", "instantiated"):
            self._mode = "initialising"

    def exit_initialization_mode(self) -> None:
        """The initial state is fixed from here on."""
        if self._legal("fmi2ExitInitializationMode", "initialising"):
            self._mode, self._instance.initialising = "stepping", False

    def terminate(self) -> None:
        """The last values can still be read."""
        if self._legal("fmi2Terminate", "stepping"):
            self._mode = "terminated"

    def _legal(self, call: str, *modes: str) -> bool:
        """Whether a call may be made now; where it may not, that is logged."""
        if self._mode not in modes:
            self._refuse(f"{call}: {MODES[self._mode]}")
        return self._mode in modes

    def do_step(self, current_time: float, step_size: float) -> bool:
        """One exact step, or none: then the reason is in the log and nothing has changed."""
        end = current_time + step_size
        reason: str | None
        if self._mode != "stepping":
            reason = MODES[self._mode]
        elif end > self._stop + SAME_POINT * max(1.0, abs(self._stop)):
            reason = f"the step ends at {end}, expected no later than stopTime = {self._stop}"
        else:
            reason = self._instance.advance(current_time, step_size)
        if reason is not None:
            self._refuse(f"fmi2DoStep: {reason}")
        return reason is None

    def get_real(self, vrs: list[int]) -> list[float]:
        """Values of Reals by one gather; NaN for an unknown reference."""
        self._legal("fmi2GetReal", *READABLE)
        reals = self._instance.reals()
        if vrs != self._asked:  # a master asks for the same variables at every step
            if unknown := _unknown(vrs, len(reals)):
                self._refuse(f"fmi2GetReal: {unknown}")
                return [float(reals[vr]) if 0 <= vr < len(reals) else math.nan for vr in vrs]
            self._asked, self._places = vrs, np.array(vrs, dtype=np.intp)
        values: list[float] = reals[self._places].tolist()
        return values

    def set_real(self, vrs: list[int], values: list[float]) -> None:
        """Inputs at any time, damping too, the modal state before initialisation ends."""
        instance, place = self._instance, self._instance.layout
        if not self._legal("fmi2SetReal", *SETTABLE):
            return
        if vrs and min(vrs) >= 0 and max(vrs) < place.inputs.stop:
            instance.set_inputs(vrs, values)
            return
        given = dict(zip(vrs, values, strict=True))
        reason = _unknown(vrs, place.size) or next(filter(None, map(self._hindrance, vrs, values)), None)
        if reason is not None:
            self._refuse(f"fmi2SetReal: {reason}")
            return
        inputs = {vr: value for vr, value in given.items() if vr < place.inputs.stop}
        starts = {vr: value for vr, value in given.items() if place.start.start <= vr < place.start.stop}
        states = {vr: value for vr, value in given.items() if vr >= place.q.start}
        if inputs:
            instance.set_inputs([*inputs], [*inputs.values()])
        if starts:
            instance.set_start(starts)
        if states:
            instance.set_state(states)
        instance.set_damping(given.get(place.alpha, instance.alpha), given.get(place.beta, instance.beta))

    def _hindrance(self, vr: int, value: float) -> str | None:
        """Why this Real cannot be set to this value now, or None."""
        instance, place = self._instance, self._instance.layout
        if vr < place.inputs.stop:
            return None  # a step is where an input must be finite
        if vr in (place.alpha, place.beta):
            good = 0.0 <= value < math.inf
            return None if good else f"got a damping parameter of {value}, expected a finite number ≥ 0"
        is_start = place.start.start <= vr < place.start.stop
        if not (is_start or place.q.start <= vr < place.v.stop) or self._follows(vr):
            return f"value reference {vr} is calculated; it cannot be set"
        what = "start of a prescribed motion" if is_start else "modal state"
        if not instance.initialising:
            return f"the {what} can be set before fmi2ExitInitializationMode only"
        return None if math.isfinite(value) else f"got a {what} of {value}, expected a finite number"

    def _follows(self, vr: int) -> bool:
        """Whether this state has no start value of its own: s, ṡ and in a static start q."""
        place, model = self._instance.layout, self._instance.model
        last = place.q.stop if model.initial == "static" else place.q.start + model.k
        return vr in range(place.q.start, last) or vr in range(place.v.start, place.v.start + model.k)

    def get_integer(self, vrs: list[int]) -> list[int]:
        """modes.active, the one Integer."""
        self._legal("fmi2GetInteger", *READABLE)
        if unknown := _unknown(vrs, 1):
            self._refuse(f"fmi2GetInteger: {unknown} (modes.active)")
        return [self._instance.active] * len(vrs)

    def set_integer(self, vrs: list[int], values: list[int]) -> None:
        """modes.active, the one Integer."""
        if not self._legal("fmi2SetInteger", *SETTABLE):
            return
        r = self._instance.model.r
        if unknown := _unknown(vrs, 1):
            self._refuse(f"fmi2SetInteger: {unknown} (modes.active)")
        elif bad := [value for value in values if not 0 <= value <= r]:
            self._refuse(f"fmi2SetInteger: got modes.active = {bad[0]}, expected 0 … {r}")
        elif values:
            self._instance.set_active(values[-1])

    def get_boolean(self, vrs: list[int]) -> list[bool]:
        """There is no Boolean."""
        self._refuse("fmi2GetBoolean: this FMU has no Boolean variable")
        return [False] * len(vrs)

    def set_boolean(self, vrs: list[int], values: list[bool]) -> None:
        """There is no Boolean."""
        self._refuse("fmi2SetBoolean: this FMU has no Boolean variable")

    def get_string(self, vrs: list[int]) -> list[str]:
        """There is no String."""
        self._refuse("fmi2GetString: this FMU has no String variable")
        return [""] * len(vrs)

    def set_string(self, vrs: list[int], values: list[str]) -> None:
        """There is no String."""
        self._refuse("fmi2SetString: this FMU has no String variable")

    def _get_fmu_state(self) -> dict[str, Any]:
        return {**self._instance.save(), "mode": self._mode, "stop": self._stop}

    def _set_fmu_state(self, state: dict[str, Any] | None) -> None:
        state = state or {}
        try:
            mode, stop = _saved_mode(state)
            self._instance.restore(state)
        except (KeyError, TypeError, ValueError, ArithmeticError) as error:
            self._refuse(f"fmi2SetFMUstate: not a state of this FMU ({error})")
        else:
            self._mode, self._stop = mode, stop

    @staticmethod
    def _fmu_state_from_bytes(state: bytes) -> dict[str, Any] | None:
        try:
            saved = json.loads(state.rstrip(b"\0"))
        except (ValueError, RecursionError):
            return None  # refused, with its reason, when it is set
        return saved if isinstance(saved, dict) else None


def _saved_mode(state: Mapping[str, Any]) -> tuple[str, float]:
    """The mode and the stop time of a saved state; raises what `Instance.restore` raises."""
    mode, stop = state["mode"], float(state["stop"])
    if mode not in MODES or math.isnan(stop) or (mode in SETTABLE[:2]) != state["initialising"]:
        raise ValueError("it is of no mode")
    return mode, stop


def _unknown(vrs: Sequence[int], size: int) -> str | None:
    """What is wrong with value references that must be below `size`; those from 2³¹ arrive negative."""
    bad = [vr for vr in vrs if not 0 <= vr < size]
    return f"got value reference {bad[0] % 2**32}, expected less than {size}" if bad else None
