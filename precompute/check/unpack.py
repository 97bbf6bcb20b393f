"""The zip of an FMU from a stranger: unpacked where every path stays inside and the whole stays small."""

import stat
import zipfile
from pathlib import Path, PurePosixPath

from ..errors import ModalFmuError
from .description import DESCRIPTION, read_description
from .library import library_suffix, platform_folder

LARGEST = 4 << 30  # bytes, unpacked
RATIO = 1100  # deflate cannot do better than 1032
MOST = 100_000  # files


def unpack(path: Path, folder: Path) -> None:
    """Into an empty folder. Raises ModalFmuError in one line that begins with the file's name:
    no file, no zip or a truncated one, paths that climb out, links, a size that is a trap, no FMI 2.0
    co-simulation, no binary for this platform.
    """
    try:
        with zipfile.ZipFile(path) as archive:
            _check_entries(archive.infolist())
            for entry in archive.infolist():
                archive.extract(entry, folder)
    except ModalFmuError as error:
        raise ModalFmuError(f"{path}: {error}") from None
    except FileNotFoundError:
        raise ModalFmuError(f"{path}: there is no such file") from None
    except OSError as error:
        raise ModalFmuError(f"{path}: cannot be unpacked ({error.strerror or error})") from None
    except (zipfile.BadZipFile, EOFError, NotImplementedError, RuntimeError, ValueError) as error:
        raise ModalFmuError(f"{path}: got no whole zip ({error}), expected an FMU") from None
    except Exception as error:  # noqa: BLE001  zlib, bz2 and lzma have errors of their own
        raise ModalFmuError(f"{path}: got a damaged zip ({error}), expected an FMU") from None
    try:
        description = read_description(folder)
    except ModalFmuError as error:
        raise ModalFmuError(f"{path}: {error}") from None
    here = folder / "binaries" / platform_folder()
    if not any(here.glob(f"*{library_suffix()}")):
        there = sorted(p.name for p in (folder / "binaries").glob("*") if p.is_dir())
        raise ModalFmuError(
            f"{path}: got binaries for {', '.join(there) or 'no platform'}, expected {platform_folder()}; "
            f"check it where it runs, or build it for {platform_folder()}"
        )
    if not description.identifier:
        raise ModalFmuError(f"{path}: its <CoSimulation> has no modelIdentifier")


def _check_entries(entries: list[zipfile.ZipInfo]) -> None:
    if all(entry.filename != DESCRIPTION for entry in entries):
        raise ModalFmuError(f"got a zip without {DESCRIPTION}, expected an FMU")
    if len(entries) > MOST:
        raise ModalFmuError(f"got a zip of {len(entries)} files, expected at most {MOST}")
    seen: set[str] = set()
    total = 0
    for entry in entries:
        name = PurePosixPath(entry.filename.replace("\\", "/"))
        if name.is_absolute() or ".." in name.parts or ":" in entry.filename or "\0" in entry.orig_filename:
            raise ModalFmuError(
                f"got the path {entry.filename!r}, which leads out of the FMU; it is not unpacked"
            )
        if stat.S_ISLNK(entry.external_attr >> 16):
            raise ModalFmuError(f"got a link {entry.filename!r}, expected files; it is not unpacked")
        if entry.filename in seen:
            raise ModalFmuError(f"got the file {entry.filename!r} twice; it is not unpacked")
        seen.add(entry.filename)
        total += entry.file_size
        if entry.file_size > RATIO * max(entry.compress_size, 1) or total > LARGEST:
            raise ModalFmuError(
                f"got {total} bytes at {entry.filename!r}, more than fits an FMU; it is not unpacked"
            )
