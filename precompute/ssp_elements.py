"""The FMUs of a system: parts are built, others read, springs and dampers made."""

import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from .errors import ModalFmuError, SspError
from .fmu_face import Face, checked_setting, describe
from .full_part import Progress
from .notice import notice
from .part import read_part
from .pipeline import Builder, package, reduce_part
from .spring_damper import spring_damper
from .ssp_file import SystemFile


@dataclass(frozen=True)
class Element:
    """One component: its FMU, what it says of itself, and its start values."""

    fmu: bytes
    face: Face
    start: Mapping[str, float]


def read_elements(
    file: SystemFile, build: Builder, progress: Progress, *, certified: bool
) -> dict[str, Element]:
    """Name → component, in the order of the file; a part that several name is built once.

    build: writes the FMUs of parts, springs and dampers. certified: as of `reduce_part`.
    Raises ModalFmuError where a part or an FMU is not valid or a start value is not to be set.
    """
    # All files are read before the first part is built, which takes longer.
    faces = {one.fmu: describe(one.fmu) for one in file.component if one.fmu is not None}
    parts = {one.part: read_part(one.part) for one in file.component if one.part is not None}
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        built: dict[Path, Path] = {}
        elements: dict[str, Element] = {}
        for k, component in enumerate(file.component):
            path = component.fmu
            if component.part is not None:
                part = parts[component.part]
                if part.source not in built:
                    target = Path(folder, f"{len(built)}.fmu")  # the number keeps parts of one name apart
                    reduction = reduce_part(part, progress, certified=certified)
                    built[part.source] = package(reduction, target, progress, build)
                path = built[part.source]
            assert path is not None  # the table has one of the two
            face = faces[path] if path in faces else describe(path)
            where = f"component[{k + 1}].start"
            try:
                start = {
                    name: checked_setting(where, name, repr(value), face)
                    for name, value in component.start.items()
                }
            except ModalFmuError as error:
                raise SspError(str(error)) from None
            fmu = path.read_bytes()
            if face.description.coSimulation.canBeInstantiatedOnlyOncePerProcess and any(
                fmu == other.fmu for other in elements.values()
            ):
                notice(
                    f"component[{k + 1}]: {path.name} can be instantiated once per process only, "
                    "and it is there twice; a master that runs all FMUs in one process cannot run this system"
                )
            elements[component.name] = Element(fmu, face, start)
        for joint in file.spring_damper:
            path = Path(folder, f"{joint.name}.fmu")
            build(spring_damper(joint.name, joint.stiffness, joint.damping), path, {})
            elements[joint.name] = Element(path.read_bytes(), describe(path), {})
    return elements
