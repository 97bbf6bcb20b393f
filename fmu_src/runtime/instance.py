"""One instance of the FMU: its inputs, parameters and modal state, and the vector of all Reals.

No FMI here and no formulas: it keeps the values between calls of the maths.
"""

from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import numpy as np

from .model import Floats, ReducedModel
from .propagator import Propagator, propagator
from .step import State, acceleration, at_rest, keep_modes, static_solution, step
from .variables import layout

KEPT_STEP_SIZES = 16  # masters form h as a difference of times, which jitters over a few values
SAME_POINT = 1e-9  # relative to max(1, |t|): a step that starts this near to the last one's end starts there


class Instance:
    """Values of one instance; every change goes through a method, nothing else is shared."""

    def __init__(self, model: ReducedModel) -> None:
        self.model = model
        self.layout = layout(model)
        self._rows = {
            kind: np.array(
                [i for i, name in enumerate(model.outputs) if name.split(".")[1] == kind], dtype=int
            )
            for kind in ("displacement", "velocity", "acceleration")
        }
        self._C = {kind: np.ascontiguousarray(model.C[rows]) for kind, rows in self._rows.items()}
        self.initialising = True
        self.time = 0.0
        self.alpha, self.beta = model.alpha, model.beta
        self.active = len(model.lam)
        self.u = np.zeros(len(model.inputs))
        self.state = at_rest(len(model.lam))
        self._reals = np.zeros(self.layout.size)
        self._reals[self.layout.frequency] = model.frequency
        self._stale = True
        self._damp()

    def _damp(self) -> None:
        """Take up new α, β: the step coefficients of earlier ones no longer hold."""
        place, y = self.layout, self._reals
        y[place.alpha], y[place.beta] = self.alpha, self.beta
        y[place.damping_ratio] = self.model.damping_ratio(self.alpha, self.beta)
        lam, d = self.model.lam, self.model.damping(self.alpha, self.beta)

        @lru_cache(maxsize=KEPT_STEP_SIZES)
        def coefficients(h: float) -> Propagator:
            return propagator(lam, d, h)

        self._d, self._propagator = d, coefficients

    def _modal_force(self) -> Floats:
        f: Floats = self.model.B @ self.u
        f[self.active :] = 0.0
        return f

    def refusal(self, time: float, h: float) -> str | None:
        """Why a step cannot be made, or None."""
        if not (np.isfinite(h) and h > 0.0):
            return f"communicationStepSize is {h}, expected a finite number > 0"
        if not abs(time - self.time) <= SAME_POINT * max(1.0, abs(self.time)):
            return f"currentCommunicationPoint is {time}, expected {self.time}, where the last step ended"
        if not np.isfinite(self.u).all():
            bad = int(np.flatnonzero(~np.isfinite(self.u))[0])
            return f"{self.model.inputs[bad]} is {self.u[bad]}, expected a finite number"
        return None

    def advance(self, time: float, h: float) -> None:
        """Move the state over one step under the inputs, held constant."""
        self.state = step(self._propagator(h), self.state, self._modal_force())
        self.time = time + h
        self._stale = True

    def start(self, time: float) -> None:
        """Begin at this time."""
        self.time = time

    def finish_initialising(self) -> None:
        """Fix the initial state: at rest as set, or in equilibrium with the inputs."""
        self.reals()
        self.initialising = False

    def set_damping(self, alpha: float, beta: float) -> None:
        """New α, β from here on; the state stays."""
        self.alpha, self.beta = alpha, beta
        self._damp()
        self._stale = True

    def set_active(self, active: int) -> None:
        """Keep the first modes; those switched off go to rest, those switched on start from rest."""
        self.active = active
        self.state = keep_modes(self.state, active)
        self._stale = True

    def set_inputs(self, places: Sequence[int], values: Sequence[float]) -> None:
        """Inputs by their places."""
        self.u[places] = values
        self._stale = True

    def set_state(self, places: Sequence[int], values: Sequence[float]) -> None:
        """Initial q, v by their places in the vector of all Reals."""
        state = np.concatenate([self.state.q, self.state.v])
        state[np.asarray(places) - self.layout.q.start] = values
        q, v = np.split(state, 2)
        self.state = keep_modes(State(q, v), self.active)
        self._stale = True

    def reals(self) -> Floats:
        """The vector of all Reals, up to date."""
        if self._stale:
            self._refresh()
        return self._reals

    def _refresh(self) -> None:
        model, place, y = self.model, self.layout, self._reals
        f = self._modal_force()
        if self.initialising and model.initial == "static":
            self.state = State(static_solution(model.lam, f).q, self.state.v)
            a = -self._d * self.state.v  # the forces are in equilibrium: exactly, not to rounding
        else:
            a = acceleration(model.lam, self._d, self.state, f)
        y[place.inputs] = self.u
        outputs = y[place.outputs]
        motions = (self.state.q, self.state.v, a)
        for (kind, rows), motion in zip(self._rows.items(), motions, strict=True):
            if len(rows):
                outputs[rows] = self._C[kind] @ motion
        y[place.q], y[place.v] = self.state.q, self.state.v
        y[place.q_dot], y[place.v_dot] = self.state.v, a
        self._stale = False

    def save(self) -> dict[str, Any]:
        """Everything that a replay needs, in types that JSON keeps exactly."""
        return {
            "initialising": self.initialising,
            "time": self.time,
            "alpha": self.alpha,
            "beta": self.beta,
            "active": self.active,
            "u": self.u.tolist(),
            "q": self.state.q.tolist(),
            "v": self.state.v.tolist(),
        }

    def restore(self, saved: dict[str, Any]) -> None:
        """Go back to what `save` gave; raises KeyError, TypeError or ValueError and changes nothing else."""
        u, q, v = (np.array(saved[key], dtype=float) for key in ("u", "q", "v"))
        if u.shape != self.u.shape or q.shape != self.state.q.shape or v.shape != q.shape:
            raise ValueError("the saved state is of another model")
        time, alpha, beta = (float(saved[key]) for key in ("time", "alpha", "beta"))
        initialising, active = bool(saved["initialising"]), int(saved["active"])
        self.initialising, self.time, self.active, self.u = initialising, time, active, u
        self.state = State(q, v)
        self.set_damping(alpha, beta)
