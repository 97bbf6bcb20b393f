"""FMUs with one planted fault each, made from the sources, the description and the archive of a sound one."""

import subprocess
import zipfile
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from shutil import which
from tempfile import TemporaryDirectory

from examples import two_ports

from fmu_src.native_fmu import build_native_fmu
from fmu_src.toolchain import SINGLE_FILE, SOURCES, fmi_headers, host_platform
from precompute.experiments import reference_experiments
from precompute.ls_ref import write_experiments

DESCRIPTION = "modelDescription.xml"
NAME = "two_ports"
LIBRARY = f"binaries/linux64/{NAME}.so"
FLAGS = ("-std=c11", "-O0", "-fPIC", "-fvisibility=hidden", "-w")
CC = which("gcc") or which("clang") if host_platform() == "linux64" else None
UNITS_OF_HEADER = {"component.h": ("component.c",)}  # that see the difference


@dataclass(frozen=True)
class Edit:
    """`old`, which is there once, becomes `new`. file: a C file of the native twin, or one of the archive."""

    file: str
    old: str
    new: str


@dataclass(frozen=True)
class Move:
    """A file of the archive has another name, or is not there (None)."""

    old: str
    new: str | None


@dataclass(frozen=True)
class Fault:
    """name: what is wrong; finding: the checker's name for it; group: those of its checks that must find it.

    group None: it is taken for no FMU at all, with `finding` among the words.
    """

    name: str
    changes: tuple[Edit | Move, ...]
    finding: str
    group: str | None


def code(name: str, file: str, old: str, new: str, finding: str, group: str) -> Fault:
    """One change of a C file."""
    return Fault(name, (Edit(file, old, new),), finding, group)


def told(name: str, old: str, new: str, finding: str, group: str | None) -> Fault:
    """One change of the description."""
    return Fault(name, (Edit(DESCRIPTION, old, new),), finding, group)


def edited(text: str, edit: Edit) -> str:
    """Raises AssertionError where the text to be replaced is not there, or is there twice."""
    assert text.count(edit.old) == 1, f"{edit.file}: {edit.old!r} is there {text.count(edit.old)} times"
    return text.replace(edit.old, edit.new)


def planted(fault: Fault | None, path: Path) -> Path:
    """Write the FMU with this fault; None: the sound one."""
    changes = fault.changes if fault else ()
    code = [change for change in changes if is_code(change)]
    files = sound_files()
    if code:
        files[LIBRARY] = library(code)
    for change in changes:
        if isinstance(change, Move):
            content = files.pop(change.old)
            if change.new is not None:
                files[change.new] = content
        elif change not in code:
            files[change.file] = edited(files[change.file].decode(), change).encode()
    with zipfile.ZipFile(path, "w") as archive:
        for name, content in files.items():
            archive.writestr(name, content)
    return path


def is_code(change: Edit | Move) -> bool:
    return isinstance(change, Edit) and "/" not in change.file and change.file.endswith((".c", ".h"))


def sound_files() -> dict[str, bytes]:
    return dict(_sound_files())


@cache
def _sound_files() -> dict[str, bytes]:
    """All files of the sound FMU; its library is compiled as those with faults are."""
    model = two_ports()
    with TemporaryDirectory() as place:
        compiled = Path(place, "part.so")
        compiled.write_bytes(library([]))
        references = write_experiments(reference_experiments(model))
        fmu = build_native_fmu(model, Path(place, "part.fmu"), references, {"linux64": compiled})
        with zipfile.ZipFile(fmu) as archive:
            return {name: archive.read(name) for name in archive.namelist()}


OBJECTS = TemporaryDirectory(prefix="planted", ignore_cleanup_errors=True)


@cache
def sound_objects() -> dict[str, Path]:
    """Every C file by itself, compiled once."""
    sources = [path for path in sorted(SOURCES.glob("*.c")) if path.name != SINGLE_FILE]
    return {path.name: compiled(path, [SOURCES], Path(OBJECTS.name)) for path in sources}


def compiled(source: Path, include: Sequence[Path], folder: Path) -> Path:
    target = folder / f"{source.stem}.o"
    paths = [f"-I{place}" for place in (*include, fmi_headers())]
    run(str(CC), *FLAGS, *paths, "-c", str(source), "-o", str(target))
    return target


def library(edits: Sequence[Edit]) -> bytes:
    """The native twin with these edits: what they touch is compiled, the rest is there already."""
    with TemporaryDirectory() as place:
        folder = Path(place)
        for edit in edits:
            file = folder / edit.file
            before = (file if file.exists() else SOURCES / edit.file).read_text()
            file.write_text(edited(before, edit))
        units = {unit for e in edits for unit in UNITS_OF_HEADER.get(e.file, (e.file,))}
        objects = dict(sound_objects())
        for unit in sorted(units):
            if not (folder / unit).exists():
                (folder / unit).write_bytes((SOURCES / unit).read_bytes())
            objects[unit] = compiled(folder / unit, [folder, SOURCES], folder)
        target = folder / "part.so"
        run(str(CC), "-shared", *map(str, objects.values()), "-o", str(target), "-lm")
        return target.read_bytes()


def run(*command: str) -> None:
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
