"""One instance of the FMU: its inputs, parameters and modal state, and the vector of all Reals.

No FMI here and no formulas: it keeps the values between calls of the maths.
"""

import hashlib
from collections.abc import Mapping
from functools import lru_cache
from typing import Any

import numpy as np

from .coupled import CoupledPropagator, coupled_propagator
from .model import Floats, ReducedModel
from .outputs import feedthrough, outputs, rows_by_law
from .propagator import Propagator, propagator
from .step import State, acceleration, at_rest, coupled_step, keep_modes, static_solution, step
from .variables import layout

KEPT_STEP_SIZES = 16  # masters form h as a difference of times, which jitters over a few values
SAME_POINT = 1e-9  # relative to max(1, |t|): a step that starts this near to the last one's end starts there


class Instance:
    """Values of one instance; every change goes through a method, nothing else is shared."""

    def __init__(self, model: ReducedModel) -> None:
        self.model = model
        self.layout = layout(model)
        self.initialising = True
        self.time = 0.0
        self.alpha, self.beta = model.alpha, model.beta
        self.active = model.r
        self.start = np.zeros(2 * model.k)  # of s and ṡ
        self.u = np.zeros(len(model.inputs))
        self.state = at_rest(len(model.lam))
        self._reals = np.zeros(self.layout.size)
        self._reals[self.layout.frequency] = model.frequency
        self._see_through()
        self._damp()

    @property
    def _moving(self) -> int:
        """How many coordinates move: the prescribed ones always do."""
        return self.model.k + self.active

    def _see_through(self) -> None:
        """Take up which modes are active in what the inputs move at once."""
        through = feedthrough(self.model, self._moving)
        self._rows, self._R_in = rows_by_law(self.model, through.R), through.R_in

    def _damp(self) -> None:
        """Take up α, β and which modes are coupled: the step coefficients of earlier ones no longer hold."""
        place, y = self.layout, self._reals
        y[place.alpha], y[place.beta] = self.alpha, self.beta
        with np.errstate(all="ignore"):  # the host may have made numpy's warnings errors
            y[place.damping_ratio] = self.model.damping_ratio(self.alpha, self.beta)
            lam, d = self.model.lam, self.model.damping(self.alpha, self.beta)
        group = self.model.coupled[self.model.coupled < self._moving]
        D = self.model.D_rest[np.ix_(group, group)]
        np.fill_diagonal(D, d[group])

        @lru_cache(maxsize=KEPT_STEP_SIZES)
        def coefficients(h: float) -> tuple[Propagator, CoupledPropagator | None]:
            return propagator(lam, d, h), coupled_propagator(lam[group], D, h) if len(group) else None

        self._d, self._group, self._propagators = d, group, coefficients
        N = self.model.drag(self.alpha)
        self._N = N if N.any() else None
        self._D_off = None
        if len(group):
            self._D_off = np.zeros_like(self.model.D_rest)
            self._D_off[np.ix_(group, group)] = D - np.diag(np.diag(D))
        self._stale = True

    def _force(self) -> list[Floats]:
        """B u + N ṡ and, where that changes over a step with u held, its rate N a."""
        forces: list[Floats] = [self.model.B @ self.u]
        if self._N is not None:
            s_dot, a = self.state.v[: self.model.k], self.u[self.model.motions]
            forces = [forces[0] + self._N @ s_dot, self._N @ a]
        for f in forces:
            f[self._moving :] = 0.0
        return forces

    def _settle(self) -> None:
        """A static start follows the inputs until initialisation ends."""
        if self.initialising and self.model.initial == "static":
            with np.errstate(all="ignore"):  # an input may be infinite
                k, q = self.model.k, self.state.q.copy()
                q[k:] = static_solution(self.model.lam[k:], self._force()[0][k:]).q
            self.state = State(q, self.state.v)
        self._stale = True

    def advance(self, time: float, h: float) -> str | None:
        """Move the state over one step, the inputs held constant; or say why not, and change nothing."""
        if not (np.isfinite(h) and h > 0.0):
            return f"communicationStepSize is {h}, expected a finite number > 0"
        if not abs(time - self.time) <= min(SAME_POINT * max(1.0, abs(self.time)), h / 2):
            return f"currentCommunicationPoint is {time}, expected {self.time}, where the last step ended"
        if not np.isfinite(self.u).all():
            bad = int(np.flatnonzero(~np.isfinite(self.u))[0])
            return f"{self.model.inputs[bad]} is {self.u[bad]}, expected a finite number"
        with np.errstate(all="ignore"):
            state = self._moved(h, self._force())
            if not np.isfinite(state.q @ state.q + state.v @ state.v):
                return f"the motion over communicationStepSize = {h} is beyond the range of numbers"
        self.state, self.time = state, time + h
        self._stale = True
        return None

    def _moved(self, h: float, forces: list[Floats]) -> State:
        """The state after a step: modes on their own, and those that damping couples together."""
        alone, together = self._propagators(h)
        state = step(alone, self.state, *forces)
        if together is not None:
            group = self._group
            before = State(self.state.q[group], self.state.v[group])
            moved = coupled_step(together, before, *(f[group] for f in forces))
            state.q[group], state.v[group] = moved.q, moved.v
        return state

    def set_damping(self, alpha: float, beta: float) -> None:
        """New α, β from here on; the state stays."""
        if (alpha, beta) != (self.alpha, self.beta):
            self.alpha, self.beta = alpha, beta
            self._damp()
            self._settle()

    def set_active(self, active: int) -> None:
        """Keep the first modes; those switched off go to rest, those switched on start from rest."""
        if active != self.active:
            self.active = active
            self._see_through()
            if len(self.model.coupled):
                self._damp()
        self.state = keep_modes(self.state, self._moving)
        self._settle()

    def set_inputs(self, places: Any, values: Any) -> None:
        """Inputs by their places, as numpy indexes."""
        self.u[places] = values
        self._settle()

    def set_state(self, values: Mapping[int, float]) -> None:
        """Initial q, v by their places in the vector of all Reals."""
        state = np.concatenate([self.state.q, self.state.v])
        for place, value in values.items():
            state[place - self.layout.q.start] = value
        q, v = np.split(state, 2)
        self.state = keep_modes(State(q, v), self._moving)
        self._stale = True

    def set_start(self, values: Mapping[int, float]) -> None:
        """Initial s, ṡ by their places in the vector of all Reals."""
        for place, value in values.items():
            self.start[place - self.layout.start.start] = value
        k, state = self.model.k, self.state
        s, s_dot = np.split(self.start, 2)
        self.state = State(np.concatenate([s, state.q[k:]]), np.concatenate([s_dot, state.v[k:]]))
        self._settle()

    def reals(self) -> Floats:
        """The vector of all Reals, up to date; it is the instance's own."""
        if self._stale:
            place, y = self.layout, self._reals
            with np.errstate(all="ignore"):  # an input may be infinite, and then outputs are
                model, state, damping = self.model, self.state, (self.alpha, self.beta)
                a = acceleration(model.lam, self._d, self._D_off, state, self._force()[0])
                y[place.outputs] = outputs(model, self._rows, self._R_in, damping, state, a, self.u)
            y[place.inputs], y[place.start] = self.u, self.start
            y[place.q], y[place.v] = self.state.q, self.state.v
            y[place.q_dot], y[place.v_dot] = self.state.v, a
            self._stale = False
        return self._reals

    def save(self) -> dict[str, Any]:
        """Everything that a replay needs, in types that JSON keeps exactly."""
        return {
            "model": self._digest(),
            "initialising": self.initialising,
            "time": self.time,
            "alpha": self.alpha,
            "beta": self.beta,
            "active": self.active,
            "u": self.u.tolist(),
            "start": self.start.tolist(),
            "q": self.state.q.tolist(),
            "v": self.state.v.tolist(),
        }

    def restore(self, saved: Mapping[str, Any]) -> None:
        """Go back to what `save` gave.

        Raises KeyError, TypeError, ValueError or ArithmeticError where it is not, and changes nothing.
        """
        if saved["model"] != self._digest():
            raise ValueError("it was saved by another model")
        u, start, q, v = (np.array(saved[key], dtype=float) for key in ("u", "start", "q", "v"))
        time, alpha, beta = (float(saved[key]) for key in ("time", "alpha", "beta"))
        initialising, active = bool(saved["initialising"]), int(saved["active"])
        numbers = np.concatenate([start, q, v, [time, alpha, beta]])
        own = (self.u, self.start, self.state.q, self.state.v)
        if [array.shape for array in (u, start, q, v)] != [array.shape for array in own]:
            raise ValueError("its vectors have other lengths")
        if not (np.isfinite(numbers).all() and min(alpha, beta) >= 0 and 0 <= active <= self.model.r):
            raise ValueError("its values are out of range")
        self.initialising, self.time, self.u, self.start = initialising, time, u, start
        self.set_active(active)
        self.set_damping(alpha, beta)
        self.state = State(q, v)
        self._stale = True

    def _digest(self) -> str:
        model = self.model
        used = (model.lam, model.D_rest, model.B, model.C, model.R, model.M_s, model.K_s)
        arrays = b"".join(array.tobytes() for array in used)
        return hashlib.sha256(arrays).hexdigest()[:16]
