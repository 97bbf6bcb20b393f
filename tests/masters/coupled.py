"""A coupled system: parts, and the law that gives their inputs from their outputs."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate, pairwise
from typing import Protocol

import numpy as np
from part import Part

from fmu_src.runtime.model import Floats


class Law(Protocol):
    """u = g(t, y): what the outputs y (p,) of all parts make of all inputs u (m,)."""

    def __call__(self, t: float, y: Floats) -> Floats:
        """u (m,)."""

    def rate(self, order: int, t: float, Y: Floats) -> Floats:
        """The derivative of u of order 1, 2 along y, ẏ, ÿ = Y (order + 1, p); for input derivatives only."""

    def slope(self, t: float, y: Floats) -> Floats:
        """∂u/∂y (m, p); for Newton's method only."""


def nothing(t: float, order: int) -> float:
    """No external force."""
    return 0.0


@dataclass(frozen=True, eq=False)
class Linear:
    """u = L y + e(t): L (m, p); e(t, k) the k-th derivative of the external forces, (m,)."""

    L: Floats
    e: Callable[[float, int], Floats | float] = nothing

    def __call__(self, t: float, y: Floats) -> Floats:
        return self.L @ y + self.e(t, 0)

    def rate(self, order: int, t: float, Y: Floats) -> Floats:
        return self.L @ Y[order] + self.e(t, order)

    def slope(self, t: float, y: Floats) -> Floats:
        return self.L


@dataclass(frozen=True, eq=False)
class Coupled:
    """The parts in the order of their inputs in u and of their outputs in y."""

    parts: tuple[Part, ...]
    law: Law

    @cached_property
    def inputs(self) -> Sequence[slice]:
        """Where the inputs of each part are in u."""
        return _blocks([part.sizes[0] for part in self.parts])

    @cached_property
    def outputs(self) -> Sequence[slice]:
        """Where the outputs of each part are in y."""
        return _blocks([part.sizes[1] for part in self.parts])

    def set(self, U: Floats) -> None:
        """u, u̇, ü of all parts, (1 … 3, m)."""
        for part, own in zip(self.parts, self.inputs, strict=True):
            part.set(U[:, own])

    def y(self) -> Floats:
        """The outputs of all parts, (p,)."""
        return np.concatenate([part.outputs() for part in self.parts])

    def rates(self, order: int) -> Floats:
        """Their derivatives."""
        return np.concatenate([part.rates(order) for part in self.parts])

    def stepped(self, t: float, h: float, U: Floats) -> Floats:
        """The outputs after a step of all parts under the inputs u + u̇ s + ü s²/2."""
        self.set(U)
        for part in self.parts:
            part.step(t, h)
        return self.y()

    @contextmanager
    def saved(self) -> Iterator[Callable[[], None]]:
        """Gives what rolls all parts back to here."""
        states = [part.save() for part in self.parts]

        def roll_back() -> None:
            for part, state in zip(self.parts, states, strict=True):
                part.restore(state)

        try:
            yield roll_back
        finally:
            for part, state in zip(self.parts, states, strict=True):
                part.free(state)


def _blocks(sizes: Sequence[int]) -> Sequence[slice]:
    return [slice(*ends) for ends in pairwise(accumulate(sizes, initial=0))]
