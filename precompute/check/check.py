"""A check: a function from the FMU that is driven to what it finds."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from .description import Description
from .driver import Fmu
from .finding import Finding

Run = Callable[[Fmu], Iterator[Finding]]


def always(_: Description) -> str | None:
    """The check can be made of every FMU."""
    return None


def needs(flag: str) -> Callable[[Description], str | None]:
    """The check needs a capability."""
    return lambda description: None if description.can(flag) else f"{flag} is not declared"


def needs_indices(description: Description) -> str | None:
    """The check follows the indices of ModelStructure and of derivatives."""
    return None if description.indexed else "the description has indices of no variables"


def needs_inputs(description: Description) -> str | None:
    """The check needs continuous inputs."""
    return None if description.real_inputs else "no continuous Real inputs"


@dataclass(frozen=True)
class Check:
    """run: the findings; hindrance: why it cannot be made of this FMU, or None.

    crash: the name of the finding where the FMU crashes or hangs in it.
    """

    name: str
    run: Run
    hindrance: Callable[[Description], str | None] = always
    crash: str = "crash"
