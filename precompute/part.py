"""What the user asks for: one deformable part, by its part file."""

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, TypeAlias

from pydantic import AfterValidator, Field

from .errors import PartError
from .part_tables import DampingForm, Heading, LengthUnit, Material, ModeChoice, Port, Support
from .toml_file import read_toml
from .toml_table import Table, mistake, not_empty, shown, validated

PART_FILE = "part.toml"


@dataclass(frozen=True)
class Part:
    """A part file, read and checked; its attributes mirror the file's tables.

    `mesh` and `source` (the part file) are absolute; coordinates are in `length_unit`, all else in SI.
    """

    name: str
    description: str | None
    mesh: Path
    length_unit: LengthUnit
    materials: tuple[Material, ...]
    supports: tuple[Support, ...]
    ports: tuple[Port, ...]
    modes: ModeChoice
    damping: DampingForm
    source: Path


def read_part(path: Path) -> Part:
    """The part that the file `path`, or part.toml in the folder `path`, describes.

    Raises PartError, one line that names the file, the key (arrays counted from 1), what was got, what
    was expected and how to mend it. The mesh is not opened here.
    """
    source = _part_file(path)
    file = validated(_PartFile, read_toml(source), source)
    folder = source.absolute().parent
    return Part(
        name=file.part.name,
        description=file.part.description,
        mesh=folder / file.part.mesh,
        length_unit=file.part.length_unit,
        materials=file.material,
        supports=file.support,
        ports=file.port,
        modes=file.modes,
        damping=file.damping,
        source=folder / source.name,
    )


def _part_file(path: Path) -> Path:
    # os.path: False where Path.is_dir would raise, for a name too long or a folder that is closed to us.
    if not os.path.isdir(path):
        return path
    if not os.path.isfile(path / PART_FILE):
        raise PartError(f"{path}: got a folder without {PART_FILE}; add it, or name the part file")
    return path / PART_FILE


def _own_names(items: tuple[Material | Port, ...]) -> None:
    not_empty(items)
    seen: dict[str, int] = {}
    for k, item in enumerate(items):
        if item.name in seen:
            words = (
                f"got {shown(item.name)}, the name of number {seen[item.name] + 1} too, expected a new one"
            )
            raise mistake(f"{words}; rename one of them", k, "name")
        seen[item.name] = k


def _materials(materials: tuple[Material, ...]) -> tuple[Material, ...]:
    _own_names(materials)
    rest = [k for k, material in enumerate(materials) if material.cells is None]
    if len(rest) > 1:
        words = f"missing here and in material[{rest[0] + 1}], expected it in all materials but one"
        raise mistake(f'{words}; add e.g. cells = "body"', rest[1], "cells")
    return materials


def _ports(ports: tuple[Port, ...]) -> tuple[Port, ...]:
    _own_names(ports)
    return ports


Materials: TypeAlias = Annotated[tuple[Material, ...], AfterValidator(_materials)]
Ports: TypeAlias = Annotated[tuple[Port, ...], AfterValidator(_ports)]


class _PartFile(Table):
    """The whole file; keys as in TOML."""

    part: Heading = Field(
        description="one table [part] with name, mesh and length_unit",
        examples=['[part], name = "cantilever"'],
    )
    material: Materials = Field(
        description="one table [[material]] (two brackets) or more", examples=['[[material]], name = "steel"']
    )
    support: tuple[Support, ...] = Field(
        default=(),
        description="tables [[support]] (two brackets)",
        examples=['[[support]], at = "clamp", fix = ["x", "y", "z"]'],
    )
    port: Ports = Field(
        description="one table [[port]] (two brackets) or more", examples=['[[port]], name = "tip"']
    )
    modes: ModeChoice = Field(
        description="one table [modes] with count, max_frequency or step", examples=["[modes], count = 20"]
    )
    damping: DampingForm = Field(
        default=DampingForm(alpha=0.0, beta=0.0),
        description="one table [damping] with alpha and beta, ratio or ratios",
        examples=["[damping], ratio = 0.02"],
    )
