"""What the FMUs of both twins share: the archive whose GUID is made of its content."""

import hashlib
from collections.abc import Callable, Mapping
from pathlib import Path
from uuid import UUID

from .archive import write_archive

DESCRIPTION = "modelDescription.xml"


def write_fmu(
    path: Path, files: Mapping[str, bytes], files_with_guid: Callable[[str], Mapping[str, bytes]]
) -> Path:
    """Write the FMU and return its path; the same content gives the same bytes.

    files_with_guid: those files that hold the GUID, made for it; it is made of all files with an empty one.
    Raises OSError where the file cannot be written; nothing half-written is left behind.
    """
    guid = UUID(digest({**files, **files_with_guid("")})[:32])
    write_archive(path, {**files, **files_with_guid(f"{{{guid}}}")})
    return path


def digest(files: Mapping[str, bytes]) -> str:
    """SHA-256 of names and contents, in hexadecimal digits."""
    total = hashlib.sha256()
    for name in sorted(files):
        total.update(f"{name}\0{len(files[name])}\0".encode())
        total.update(files[name])
    return total.hexdigest()
