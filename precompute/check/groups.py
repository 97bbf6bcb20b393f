"""The checks, by the groups that have a process of their own."""

from collections.abc import Mapping

from . import (
    arguments,
    begin,
    calls,
    directional,
    elsewhere,
    growth,
    instances,
    messages,
    model_description,
    rates,
    references,
    state,
    steps,
    structure,
    units,
    values,
)
from .check import Check

MODULES = (
    model_description,
    units,
    begin,
    instances,
    arguments,
    state,
    elsewhere,
    calls,
    values,
    steps,
    messages,
    structure,
    directional,
    rates,
    growth,
    references,
)
ALONE = "description"  # needs no library
FIRST = "begin"  # without it nothing else can be asked
GROUPS: Mapping[str, tuple[Check, ...]] = {
    ALONE: (*model_description.CHECKS, *units.CHECKS),
    FIRST: begin.CHECKS,
    "instances": instances.CHECKS,
    "arguments": arguments.CHECKS,
    "state": (*state.CHECKS, *elsewhere.CHECKS),
    "calls": calls.CHECKS,
    "values": values.CHECKS,
    "steps": steps.CHECKS,
    "messages": messages.CHECKS,
    "structure": (*structure.CHECKS, *directional.CHECKS),
    "rates": rates.CHECKS,
    "growth": growth.CHECKS,
    "references": references.CHECKS,
}
