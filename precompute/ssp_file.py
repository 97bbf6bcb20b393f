"""What the user asks for: a system of FMUs, by its system file."""

from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Self

from pydantic import AfterValidator, Field, model_validator

from .errors import SspError
from .part_rules import own_names
from .ssp_tables import (
    Component,
    Connection,
    Experiment,
    SpringDamper,
    SystemHeading,
    SystemInput,
    SystemOutput,
)
from .toml_file import read_toml
from .toml_table import Table, mistake, nearest, not_empty, shown, validated

SYSTEM_FILE = "system.toml"

Place = tuple[str | int, ...]


class SystemFile(Table):
    """The whole of a system file; paths are absolute. Keys as in TOML."""

    system: SystemHeading = Field(
        description="one table [system] with a name", examples=['[system], name = "two_beams"']
    )
    component: Annotated[tuple[Component, ...], AfterValidator(not_empty)] = Field(
        description="one or more tables [[component]] (two brackets)",
        examples=['[[component]], name = "left", part = "left"'],
    )
    spring_damper: tuple[SpringDamper, ...] = Field(
        default=(),
        description="tables [[spring_damper]] (two brackets)",
        examples=['[[spring_damper]], name = "mount", stiffness = { z = 1e5 }'],
    )
    connection: tuple[Connection, ...] = Field(
        default=(),
        description="tables [[connection]] (two brackets) with from and to",
        examples=['[[connection]], from = "left.tip.displacement.z", to = "controller.position"'],
    )
    input: tuple[SystemInput, ...] = Field(
        default=(),
        description="tables [[input]] (two brackets)",
        examples=['[[input]], name = "load", to = ["left.tip.force.z"]'],
    )
    output: tuple[SystemOutput, ...] = Field(
        default=(),
        description="tables [[output]] (two brackets)",
        examples=['[[output]], name = "deflection", from = "left.tip.displacement.z"'],
    )
    experiment: Experiment = Field(
        default=Experiment(),
        description="one table [experiment] with stop and step",
        examples=["[experiment], stop = 1.0, step = 1e-4"],
    )

    @model_validator(mode="after")
    def _together(self) -> Self:
        self._check_names()
        known = [one.name for one in self.component] + [joint.name for joint in self.spring_damper]
        for text, place in self._references():
            name = text.partition(".")[0]
            if name not in known:
                words = f"got {shown(text)}, but there is no component {shown(name)}"
                raise mistake(f"{words}; did you mean {nearest(name, known)}?", *place)
        return self

    def _check_names(self) -> None:
        """Components have names of their own, and so have the connectors of the system."""
        components = [
            *(("component", k, item.name) for k, item in enumerate(self.component)),
            *(("spring_damper", k, item.name) for k, item in enumerate(self.spring_damper)),
        ]
        own_names(components)
        files: dict[str, str] = {}
        for table, k, name in components:
            other = files.setdefault(name.lower(), name)
            if other != name:
                words = f"got {shown(name)} beside {shown(other)}, expected more than another case"
                raise mistake(
                    f"{words}: on Windows their FMUs are one file; rename one of them", table, k, "name"
                )
        own_names(
            [
                *(("input", k, item.name) for k, item in enumerate(self.input)),
                *(("output", k, item.name) for k, item in enumerate(self.output)),
            ]
        )

    def _references(self) -> Iterator[tuple[str, Place]]:
        """Every name of a variable or port, and the place where it is named."""
        for k, joint in enumerate(self.spring_damper):
            yield from ((text, ("spring_damper", k, "ports", i)) for i, text in enumerate(joint.ports or ()))
        for k, connection in enumerate(self.connection):
            yield connection.source, ("connection", k, "from")
            yield connection.target, ("connection", k, "to")
        for k, entry in enumerate(self.input):
            yield from ((text, ("input", k, "to", i)) for i, text in enumerate(entry.to))
        for k, exit_ in enumerate(self.output):
            yield exit_.source, ("output", k, "from")


def read_system_file(path: Path) -> tuple[SystemFile, Path]:
    """The system that the file `path`, or system.toml in the folder `path`, describes; and the file's path.

    Raises SspError or PartError, one line that names the file, the key (arrays counted from 1), what was got,
    what was expected and how to mend it. No other file is opened here.
    """
    source = path / SYSTEM_FILE if path.is_dir() else path
    if not source.is_file():
        got = f"a folder without {SYSTEM_FILE}" if path.is_dir() else "no such file"
        raise SspError(f"{path}: got {got}, expected a system file or its folder; check the path")
    return validated(SystemFile, read_toml(source), source), source
