"""A part that is an FMU, through FMPy."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave

from fmu_src.runtime.model import Floats


class Fmu:
    """An instance of the FMU at `path`: the inputs and outputs a master uses, by their names.

    `start`: values for its initialisation, parameters and modes.amplitude[i] among them. One instance may be
    started again by `restart`. FMPy raises FMICallException where a call fails.
    """

    def __init__(
        self,
        path: Path,
        inputs: Sequence[str],
        outputs: Sequence[str],
        start: Mapping[str, float] | None = None,
    ) -> None:
        description = read_model_description(str(path))
        self.reference = {v.name: v.valueReference for v in description.modelVariables}
        self.inputs = [self.reference[name] for name in inputs]
        self._outputs = [self.reference[name] for name in outputs]
        self._folder = TemporaryDirectory(ignore_cleanup_errors=True)  # as long as the instance
        self.slave = FMU2Slave(
            guid=description.guid,
            unzipDirectory=extract(str(path), self._folder.name),
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName=path.stem,
        )
        self.slave.instantiate()
        self._begin(start or {})

    @property
    def sizes(self) -> tuple[int, int]:
        return len(self.inputs), len(self._outputs)

    def restart(self, start: Mapping[str, float] | None = None) -> None:
        """At time 0 again, with other start values."""
        self.slave.reset()
        self._begin(start or {})

    def _begin(self, start: Mapping[str, float]) -> None:
        self.slave.setupExperiment(startTime=0.0)
        self.slave.enterInitializationMode()
        self.slave.setReal([self.reference[name] for name in start], [*start.values()])
        self.slave.exitInitializationMode()

    def set(self, U: Floats) -> None:
        """u, u̇, ü (1 … 3, m). Rates are for one step: fmi2DoStep clears them."""
        self.slave.setReal(self.inputs, U[0].tolist())
        rows, m = U.shape
        if rows > 1:
            orders = np.repeat(np.arange(1, rows), m).tolist()
            # by value references: the input derivatives of simulate_fmu work with exactly nine inputs only
            self.slave.setRealInputDerivatives(self.inputs * (rows - 1), orders, U[1:].ravel().tolist())

    def outputs(self) -> Floats:
        return np.array(self.slave.getReal(self._outputs))

    def rates(self, order: int) -> Floats:
        return np.array(self.slave.getRealOutputDerivatives(self._outputs, [order] * len(self._outputs)))

    def get(self, *names: str) -> Floats:
        """Any other variables."""
        return np.array(self.slave.getReal([self.reference[name] for name in names]))

    def step(self, t: float, h: float) -> None:
        self.slave.doStep(currentCommunicationPoint=t, communicationStepSize=h)

    def save(self) -> Any:
        return self.slave.getFMUState()

    def restore(self, state: Any) -> None:
        self.slave.setFMUState(state)

    def free(self, state: Any) -> None:
        self.slave.freeFMUState(state)
