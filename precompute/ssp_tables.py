"""The tables of a system file: its components, what joins them, and how long it runs."""

from collections.abc import Mapping
from typing import Annotated, Any, Self

from pydantic import AfterValidator, BeforeValidator, Field, model_validator

from .part_values import Direction, FilePath, Identifier, NotNegative, Number, Seconds, Text, distinct
from .toml_table import Table, exactly_one, mistake, not_empty

_NAME = "a C identifier: letters, digits and _, no digit first"
_VARIABLE = "COMPONENT.VARIABLE, the name of a component and of a variable of its FMU"
# What masters make files and variables of.
_Variable = Annotated[str, Field(pattern=r"^[A-Za-z_][A-Za-z0-9_]*\.[^\p{Cc}]+$")]


def _flat(values: Any) -> Any:
    """{a: {b: 1}} → {"a.b": 1}: TOML takes a.b = 1 for a table; true and false become 1 and 0."""
    if not isinstance(values, Mapping):
        return values
    flat: dict[str, Any] = {}
    for key, value in values.items():
        inner = (
            {f"{key}.{rest}": one for rest, one in _flat(value).items()}
            if isinstance(value, Mapping)
            else {key: value}
        )
        for name, one in inner.items():
            if name in flat:  # "a.b" = 1 beside a.b = 2
                raise ValueError(name)
            flat[name] = float(one) if isinstance(one, bool) else one
    return flat


class SystemHeading(Table):
    """[system]"""

    name: Identifier = Field(description=_NAME, examples=['name = "two_beams"'])
    description: Text | None = Field(
        default=None, description="one line of text", examples=['description = "two beams and a spring"']
    )


class Component(Table):
    """[[component]]: an FMU of the system, built from a part or found as it is."""

    name: Identifier = Field(description=_NAME, examples=['name = "left"'])
    part: FilePath | None = Field(
        default=None,
        description="a part file or its folder, relative to the system file",
        examples=['part = "left"'],
    )
    fmu: FilePath | None = Field(
        default=None,
        description="the path of an FMU, relative to the system file",
        examples=['fmu = "controller.fmu"'],
    )
    start: Annotated[dict[str, Number], BeforeValidator(_flat)] = Field(
        default={},
        description="a table of variables with start values, finite numbers, true or false",
        examples=["start = { damping.alpha = 2.0 }"],
    )

    @model_validator(mode="after")
    def _one_source(self) -> Self:
        exactly_one([key for key in ("part", "fmu") if getattr(self, key) is not None], "part, fmu")
        return self


class SpringDamper(Table):
    """[[spring_damper]]: a component that joins two ports, with the connections that this takes."""

    name: Identifier = Field(description=_NAME, examples=['name = "mount"'])
    ports: Annotated[tuple[_Variable, _Variable], AfterValidator(distinct)] | None = Field(
        default=None,
        description="two different ports, each COMPONENT.PORT",
        examples=['ports = ["left.tip", "right.root"]'],
    )
    stiffness: dict[Direction, NotNegative] = Field(
        default={},
        description="a table of numbers ≥ 0 by direction: x, y, z in N/m, rx, ry, rz in N·m/rad",
        examples=["stiffness = { z = 1e5 }"],
    )
    damping: dict[Direction, NotNegative] = Field(
        default={},
        description="a table of numbers ≥ 0 by direction: x, y, z in N·s/m, rx, ry, rz in N·m·s/rad",
        examples=["damping = { z = 30.0 }"],
    )

    @model_validator(mode="after")
    def _joins(self) -> Self:
        if not any([*self.stiffness.values(), *self.damping.values()]):
            words = "got neither stiffness nor damping, expected one number > 0 at least"
            raise mistake(f"{words}; write e.g. stiffness = {{ z = 1e5 }}", "stiffness")
        return self


class Connection(Table):
    """[[connection]]: to = factor · from + offset."""

    source: _Variable = Field(
        alias="from", description=f"{_VARIABLE}, an output", examples=['from = "left.tip.displacement.z"']
    )
    target: _Variable = Field(
        alias="to", description=f"{_VARIABLE}, an input", examples=['to = "controller.position"']
    )
    factor: Number = Field(default=1.0, description="a finite number", examples=["factor = -1.0"])
    offset: Number = Field(
        default=0.0, description="a finite number in the unit of `to`", examples=["offset = 0.0"]
    )


class SystemInput(Table):
    """[[input]]: a connector of the whole system that goes to inputs of its components."""

    name: Identifier = Field(description=_NAME, examples=['name = "load"'])
    to: Annotated[tuple[_Variable, ...], AfterValidator(not_empty), AfterValidator(distinct)] = Field(
        description=f"a list of one or more of {_VARIABLE}, inputs, none twice",
        examples=['to = ["left.tip.force.z"]'],
    )


class SystemOutput(Table):
    """[[output]]: a connector of the whole system that comes from an output of a component."""

    name: Identifier = Field(description=_NAME, examples=['name = "deflection"'])
    source: _Variable = Field(
        alias="from", description=f"{_VARIABLE}, an output", examples=['from = "left.tip.displacement.z"']
    )


class Experiment(Table):
    """[experiment]: for masters that ask."""

    stop: Seconds | None = Field(
        default=None, description="the time of the end in s, a finite number > 0", examples=["stop = 1.0"]
    )
    step: Seconds | None = Field(
        default=None, description="the step size in s, a finite number > 0", examples=["step = 1e-4"]
    )
