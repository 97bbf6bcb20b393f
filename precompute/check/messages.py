"""What the FMU tells the logger (sections 2.1.5, 2.2.4)."""

import ctypes
from collections.abc import Iterator, Mapping

from .check import Check
from .description import Description
from .driver import Fmu
from .finding import Demand, Finding
from .host import Host, Message
from .instances import several
from .library import OK
from .runs import run

NUMBER = 0x5EED  # an address that the FMU must hand back and never follow


def messages(fmu: Fmu) -> Iterator[Finding]:
    """Category, instance name and environment of each message."""
    host = Host()
    slave = fmu.slave("the one", host=host, callbacks=host.callbacks(environment=NUMBER))
    slave.initialise(fmu.start)
    run(fmu, slave, 0, 3)
    slave.call("DoStep", fmu.point(3), -fmu.h, 1)  # not legal: something to log
    slave.free()
    declared = fmu.description.categories
    for message in host.log:
        if message.category not in declared and (declared or message.category is not None):
            expected = ", ".join(declared) or "NULL, for none is declared"
            yield Finding("logger-category", f"logged as {message.category!r}, expected {expected}")
        if message.instance != "the one":
            yield Finding("logger-instance", f"logged by {message.instance!r}, expected 'the one'")
        if message.environment != NUMBER:
            yield Finding("logger-environment", f"got {message.environment}, expected {NUMBER}")
        if message.text.endswith("\n"):
            yield Finding("logger-line", f"the message {message.text.strip()!r} ends with a line break")


def silence(fmu: Fmu) -> Iterator[Finding]:
    """With loggingOn = fmi2False a run in which all is well says nothing."""
    host = Host()
    slave = fmu.slave(host=host, logging=False).initialise(fmu.start)
    run(fmu, slave, 0, fmu.steps)
    slave.free()
    chatter = [message.text for message in host.log if message.status == 0]
    if chatter:
        yield Finding(
            "logger-off", f"{len(chatter)} messages with loggingOn = fmi2False, such as {chatter[0]!r}"
        )


def categories(fmu: Fmu) -> Iterator[Finding]:
    """fmi2SetDebugLogging of each declared category, on and off."""
    slave = fmu.slave()
    for category in fmu.description.categories:
        names = (ctypes.c_char_p * 1)(category.encode())
        for on in (1, 0):
            status = slave.call("SetDebugLogging", on, 1, names)
            if status > 1:
                yield Finding("debug-logging", f"fmi2SetDebugLogging of {category!r} was refused")
                break
    if slave.call("SetDebugLogging", 1, 0, None) > 1:
        yield Finding("debug-logging", "fmi2SetDebugLogging of all categories (0, NULL) was refused")
    slave.free()


def one_category(fmu: Fmu) -> Iterator[Finding]:
    """With one category switched on its messages are told, and no debug messages of others."""
    declared = {*fmu.description.categories} - {"logAll"}
    for category in sorted({m.category for m in _said(fmu, None) if m.category in declared} - {None}):
        told = _said(fmu, category)
        others = [m for m in told if m.category != category and m.status == OK]
        if all(m.category != category for m in told):
            yield Finding(
                "debug-category", f"with {category!r} alone switched on none of its messages is told"
            )
        elif others:
            yield Finding(
                "debug-category",
                f"with {category!r} alone switched on there are those of {others[0].category!r}",
            )


def _said(fmu: Fmu, category: str | None) -> list[Message]:
    """What is told of a few steps, and of one that is not legal; None: with everything switched on."""
    slave = fmu.slave(logging=category is None)
    if category is not None:
        slave.call("SetDebugLogging", 1, 1, (ctypes.c_char_p * 1)(category.encode()))
    before = len(slave.host.log)
    slave.initialise(fmu.start)
    run(fmu, slave, 0, 3)
    slave.call("DoStep", fmu.point(3), -fmu.h, 1)
    slave.free()
    return slave.host.log[before:]


def _no_categories(description: Description) -> str | None:
    return None if description.categories else "no LogCategories are declared"


DEMANDS: Mapping[str, Demand] = {
    "logger-category": Demand(
        "error",
        "2.1.5",
        "messages have a category of LogCategories, NULL where there are none",
        "declare what is used",
    ),
    "logger-instance": Demand(
        "error", "2.1.5", "messages carry the name of the instance that sends them", "keep a copy of the name"
    ),
    "logger-environment": Demand(
        "error", "2.1.5", "the logger gets componentEnvironment as its first argument", "pass it on"
    ),
    "logger-line": Demand("note", "2.1.5", "messages have no trailing line break", "leave it out"),
    "logger-off": Demand(
        "warning", "2.1.5", "with loggingOn = fmi2False there is no debug logging", "ask before each message"
    ),
    "debug-logging": Demand(
        "error",
        "2.1.5",
        "fmi2SetDebugLogging takes the declared categories",
        "know them, or do not declare them",
    ),
    "debug-category": Demand(
        "warning",
        "2.1.5",
        "with categories given only debug messages of these are told",
        "compare the category of each message with those that are switched on",
    ),
}
CHECKS = (
    Check("logger-messages", messages),
    Check("logger-off", silence),
    Check("debug-logging", categories, _no_categories),
    Check("debug-category", one_category, lambda d: several(d) or _no_categories(d)),
)
