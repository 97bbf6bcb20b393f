"""Files that are written: refused early where they cannot be, replaced only by a whole file."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from .errors import ModalFmuError


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """A name beside `path`, with its ending, to write to; it becomes `path` if the block ends well."""
    aside = _aside(path)
    try:
        yield aside
        aside.replace(path)
    finally:
        aside.unlink(missing_ok=True)


def check_writable(path: Path) -> None:
    """Raises ModalFmuError where no file `path` could be written: to be asked before a long computation."""
    if path.is_dir():
        raise ModalFmuError(f"{path}: got a folder, expected a file to write; add the file's name")
    if not path.parent.is_dir():
        raise ModalFmuError(f"{path}: got a folder {path.parent} that does not exist; make it first")
    try:
        _aside(path).touch()
        _aside(path).unlink()
    except OSError as error:
        raise ModalFmuError(f"{path}: cannot be written ({error.strerror}); choose another place") from None


def check_ending(option: str, path: Path, *endings: str) -> None:
    """Raises ModalFmuError where `path`, given to `option`, has none of the endings or cannot be written."""
    if path.suffix.lower() not in endings:
        raise ModalFmuError(
            f"{option}: got {path.name}, expected a file name ending in {' or '.join(endings)}"
        )
    check_writable(path)


def fmu_path(name: str, output: Path | None) -> Path:
    """Where the FMU of the part `name` goes, as `output_path` tells."""
    return output_path(name, output, ".fmu")


def output_path(name: str, output: Path | None, ending: str) -> Path:
    """`output`, or the file `name` with this ending in the folder `output` (left out: here).

    Raises ModalFmuError where `output` is neither a folder nor a file name with this ending.
    """
    folder = Path() if output is None else output
    if folder.is_dir():
        return folder / f"{name}{ending}"
    if folder.suffix.lower() != ending:
        raise ModalFmuError(f"{folder}: expected a folder that exists, or a file name that ends in {ending}")
    return folder


def _aside(path: Path) -> Path:
    return path.with_name(f".{path.stem}.{os.getpid()}{path.suffix}")
