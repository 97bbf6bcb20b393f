"""What a master asks of a part: inputs with their rates in, outputs with their rates out, steps, states."""

from typing import Any, Protocol

from fmu_src.runtime.model import Floats


class Part(Protocol):
    """A member of a coupled system; m inputs, p outputs."""

    @property
    def sizes(self) -> tuple[int, int]:
        """m, p."""

    def set(self, U: Floats) -> None:
        """U = u, u̇, ü here, (1 … 3, m): over the next step the inputs are u + u̇ s + ü s²/2."""

    def outputs(self) -> Floats:
        """y (p,) here."""

    def rates(self, order: int) -> Floats:
        """The derivative of y of order 1 or 2 here, (p,), under the inputs and rates that are set."""

    def step(self, t: float, h: float) -> None:
        """From t to t + h."""

    def save(self) -> Any:
        """The state here, to be given back by `free`."""

    def restore(self, state: Any) -> None:
        """Back to where it was saved."""

    def free(self, state: Any) -> None:
        """The state is not needed any more."""
