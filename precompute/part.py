"""What the user asks for: one deformable part, by its part file."""

import os
from dataclasses import dataclass
from pathlib import Path

from .damping_table import DampingForm
from .errors import PartError
from .load_tables import Dashpot, Loads, Mass, Spring
from .mode_tables import Accuracy, Basis, ModeChoice
from .part_file import PartFile
from .part_tables import Material, Support, SystemTable
from .part_values import LengthUnit
from .port_tables import Energy, Pair, Port
from .toml_file import read_toml
from .toml_table import validated

PART_FILE = "part.toml"


@dataclass(frozen=True)
class Part:
    """A part file, read and checked; its attributes mirror the file's tables.

    Paths are absolute, `source` is the part file. Coordinates are in `length_unit`, the matrices of `system`
    in its units, all else in SI. Either `system` is there, perhaps with a mesh, or a mesh with materials.
    """

    name: str
    description: str | None
    mesh: Path | None
    length_unit: LengthUnit
    system: SystemTable | None
    materials: tuple[Material, ...]
    supports: tuple[Support, ...]
    ports: tuple[Port, ...]
    pairs: tuple[Pair, ...]
    loads: Loads
    springs: tuple[Spring, ...]
    dashpots: tuple[Dashpot, ...]
    masses: tuple[Mass, ...]
    energy: Energy
    basis: Basis
    modes: ModeChoice
    damping: DampingForm
    accuracy: Accuracy | None
    source: Path


def read_part(path: Path) -> Part:
    """The part that the file `path`, or part.toml in the folder `path`, describes.

    Raises PartError, one line that names the file, the key (arrays counted from 1), what was got, what
    was expected and how to mend it. No other file is opened here.
    """
    source = _part_file(path)
    file = validated(PartFile, read_toml(source), source)
    return Part(
        name=file.part.name,
        description=file.part.description,
        mesh=file.part.mesh,
        length_unit=file.length_unit,
        system=file.system,
        materials=file.material,
        supports=file.support,
        ports=file.port,
        pairs=file.pair,
        loads=file.loads,
        springs=file.spring,
        dashpots=file.dashpot,
        masses=file.mass,
        energy=file.energy,
        basis=file.basis,
        modes=file.modes,
        damping=file.damping,
        accuracy=file.accuracy,
        source=source.absolute(),
    )


def _part_file(path: Path) -> Path:
    # os.path: False where Path.is_dir would raise, for a name too long or a folder that is closed to us.
    if not os.path.isdir(path):
        return path
    if not os.path.isfile(path / PART_FILE):
        raise PartError(f"{path}: got a folder without {PART_FILE}; add it, or name the part file")
    return path / PART_FILE
