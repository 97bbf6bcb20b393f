"""The checks, by the groups that have a process of their own."""

from collections.abc import Mapping

from . import arguments, begin, instances, state
from .check import Check

FIRST = "begin"  # without it nothing else can be asked
GROUPS: Mapping[str, tuple[Check, ...]] = {
    FIRST: begin.CHECKS,
    "instances": instances.CHECKS,
    "arguments": arguments.CHECKS,
    "state": state.CHECKS,
}
