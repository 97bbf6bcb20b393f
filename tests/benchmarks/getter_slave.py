"""The same part as pythonfmu slaves are usually written: one getter or setter for each variable."""

from pathlib import Path

import numpy as np
from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real


class GetterPart(Fmi2Slave):
    """[q, v] over a step by coefficients made beforehand, y = C q or C v."""

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        data = np.load(Path(self.resources) / "getter_part.npz")
        self.E11, self.E12, self.E21, self.E22, self.G0 = data["coefficients"]
        self.B, self.C, self.moving = data["B"], data["C"], data["moving"]
        self.q, self.v = np.zeros((2, len(self.E11)))
        self.u, self.y = np.zeros(self.B.shape[1]), np.zeros(len(self.C))
        for j in range(len(self.u)):
            self._register(f"u[{j}]", self.u, j, Fmi2Causality.input)
        for i in range(len(self.y)):
            self._register(f"y[{i}]", self.y, i, Fmi2Causality.output)

    def _register(self, name, values, place, causality):
        variable = Real(
            name,
            causality=causality,
            variability=Fmi2Variability.continuous,
            getter=lambda: float(values[place]),
            setter=lambda value: values.__setitem__(place, value),
        )
        self.register_variable(variable)

    def do_step(self, current_time, step_size):
        q, v, f = self.q, self.v, self.B @ self.u
        self.q = self.E11 * q + self.E12 * v + self.G0 * f
        self.v = self.E21 * q + self.E22 * v + self.E12 * f
        self.y[:] = np.where(self.moving, self.C @ self.v, self.C @ self.q)
        return True
