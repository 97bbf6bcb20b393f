"""The FMI glue of the Python twin: calls of pythonfmu become calls of `Instance`.

An exception that leaves a method is fatal in pythonfmu and tears the instance down; an error status
cannot be returned. So a call that is not legal is logged with its reason and changes nothing, and a
step that cannot be made is discarded (fmi2Discard).
"""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
from pythonfmu import Fmi2Slave
from pythonfmu.enums import Fmi2Status

from .host import release_interpreter
from .instance import Instance
from .resources import read_model


class ModalSlave(Fmi2Slave):  # type: ignore[misc]  # pythonfmu carries no types
    """A reduced model that pythonfmu runs; the description is written by the packaging, not by it."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        model = read_model(Path(self.resources) / "model")
        self.modelName = model.name
        release_interpreter(Path(self.resources), model.name)
        self._instance = Instance(model)
        self._asked: list[int] = []
        self._places = np.zeros(0, dtype=np.intp)
        place = self._instance.layout
        self._read_only = {*range(place.outputs.start, place.outputs.stop)}
        self._read_only |= {*range(place.frequency.start, place.damping_ratio.stop)}
        self._read_only |= {*range(place.q_dot.start, place.size)}
        if model.initial == "static":
            self._read_only |= {*range(place.q.start, place.q.stop)}

    def _refuse(self, reason: str) -> None:
        self.log(reason, Fmi2Status.error)

    def setup_experiment(self, start_time: float, stop_time: float | None, tolerance: float | None) -> None:
        """Begin at start_time; a stop time and a tolerance mean nothing to an exact step."""
        if math.isfinite(start_time):
            self._instance.start(start_time)
        else:
            self._refuse(f"fmi2SetupExperiment: startTime is {start_time}, expected a finite number")

    def exit_initialization_mode(self) -> None:
        """The initial state is fixed from here on."""
        self._instance.finish_initialising()

    def do_step(self, current_time: float, step_size: float) -> bool:
        """One exact step, or none: then the reason is in the log and nothing has changed."""
        instance = self._instance
        reason = instance.refusal(current_time, step_size)
        if instance.initialising:
            reason = "called before fmi2ExitInitializationMode"
        if reason is not None:
            self._refuse(f"fmi2DoStep: {reason}; nothing was changed")
            return False
        instance.advance(current_time, step_size)
        return True

    def get_real(self, vrs: list[int]) -> list[float]:
        """Values of Reals by one gather; NaN for an unknown reference."""
        reals = self._instance.reals()
        if vrs != self._asked:  # a master asks for the same variables at every step
            if vrs and max(vrs) >= len(reals):
                self._refuse(f"fmi2GetReal: got value reference {max(vrs)}, expected less than {len(reals)}")
                return [float(reals[vr]) if vr < len(reals) else math.nan for vr in vrs]
            self._asked, self._places = vrs, np.array(vrs, dtype=np.intp)
        values: list[float] = reals[self._places].tolist()
        return values

    def set_real(self, vrs: list[int], values: list[float]) -> None:
        """Inputs at any time, damping too, the modal state before initialisation ends."""
        instance = self._instance
        if vrs and max(vrs) < instance.layout.inputs.stop:
            instance.set_inputs(vrs, values)
            return
        for vr, value in zip(vrs, values, strict=True):
            self._set_one(vr, value)

    def _set_one(self, vr: int, value: float) -> None:
        instance, place = self._instance, self._instance.layout
        if vr < place.inputs.stop:
            instance.set_inputs([vr], [value])
        elif vr >= place.size:
            self._refuse(f"fmi2SetReal: got value reference {vr}, expected less than {place.size}")
        elif vr in self._read_only:
            self._refuse(f"fmi2SetReal: value reference {vr} is calculated; it cannot be set")
        elif vr in (place.alpha, place.beta):
            if 0.0 <= value < math.inf:
                alpha, beta = instance.alpha, instance.beta
                instance.set_damping(*((value, beta) if vr == place.alpha else (alpha, value)))
            else:
                self._refuse(f"fmi2SetReal: got a damping parameter of {value}, expected a finite number ≥ 0")
        elif not instance.initialising:
            self._refuse("fmi2SetReal: the modal state can be set before fmi2ExitInitializationMode only")
        elif math.isfinite(value):
            instance.set_state([vr], [value])
        else:
            self._refuse(f"fmi2SetReal: got a modal state of {value}, expected a finite number")

    def get_integer(self, vrs: list[int]) -> list[int]:
        """modes.active, the one Integer."""
        if any(vrs):
            self._refuse(f"fmi2GetInteger: got value reference {max(vrs)}, expected 0 (modes.active)")
        return [self._instance.active] * len(vrs)

    def set_integer(self, vrs: list[int], values: list[int]) -> None:
        """modes.active, the one Integer."""
        r = len(self._instance.model.lam)
        for vr, value in zip(vrs, values, strict=True):
            if vr != 0:
                self._refuse(f"fmi2SetInteger: got value reference {vr}, expected 0 (modes.active)")
            elif not 0 <= value <= r:
                self._refuse(f"fmi2SetInteger: got modes.active = {value}, expected 0 … {r}")
            else:
                self._instance.set_active(value)

    def _get_fmu_state(self) -> dict[str, Any]:
        return self._instance.save()

    def _set_fmu_state(self, state: dict[str, Any] | None) -> None:
        try:
            self._instance.restore(state or {})
        except (KeyError, TypeError, ValueError) as error:
            self._refuse(f"fmi2SetFMUstate: not a state of this FMU ({error}); nothing was changed")

    @staticmethod
    def _fmu_state_from_bytes(state: bytes) -> dict[str, Any] | None:
        try:
            saved = json.loads(state.rstrip(b"\0"))
        except ValueError:
            return None  # refused, with its reason, when it is set
        return saved if isinstance(saved, dict) else None
