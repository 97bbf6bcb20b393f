"""From a system file to its SSP: a zip with SystemStructure.ssd and the FMUs."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from fmu_src.archive import write_archive

from .errors import SspError
from .full_part import Progress
from .pipeline import Builder
from .ssp_description import fmu_name, system_structure
from .ssp_elements import Element, read_elements
from .ssp_file import SystemFile
from .ssp_loops import check_loops
from .ssp_wiring import Wire, wires_of


@dataclass(frozen=True)
class Package:
    """A system that is checked: its components by name, what joins them, and its SystemStructure.ssd."""

    file: SystemFile
    elements: Mapping[str, Element]
    wires: Sequence[Wire]
    structure: bytes


def package_system(
    file: SystemFile, source: Path, build: Builder, progress: Progress, *, certified: bool
) -> Package:
    """Build and read the FMUs of a system file, then check how they are joined.

    source: the file's path, for messages; the rest as of `read_elements`.
    Raises ModalFmuError in one line that begins with the file at fault.
    """
    try:
        elements = read_elements(file, build, progress, certified=certified)
        wires = wires_of(file, elements)
        check_loops(wires, elements)
        structure = system_structure(file, elements, wires)
    except SspError as error:
        raise SspError(f"{source}: {error}") from None
    return Package(file, elements, wires, structure)


def write_ssp(package: Package, path: Path) -> Path:
    """Write the SSP and return its path; the same content gives the same bytes.

    Raises OSError where the file cannot be written; nothing half-written is left behind.
    """
    fmus = {fmu_name(name): element.fmu for name, element in package.elements.items()}
    write_archive(path, {"SystemStructure.ssd": package.structure, **fmus})
    return path
