"""The FMU file: a zip whose bytes depend on its content only, written aside and then renamed."""

import os
import tempfile
import zipfile
from collections.abc import Mapping
from pathlib import Path

EPOCH = (1980, 1, 1, 0, 0, 0)  # the earliest time a zip can hold


def write_archive(path: Path, files: Mapping[str, bytes]) -> None:
    """Names sorted, times fixed, permissions fixed; `path` is replaced only by the whole file.

    Raises OSError where the folder cannot be written.
    """
    descriptor, aside = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
    try:
        with os.fdopen(descriptor, "wb") as stream, zipfile.ZipFile(stream, "w") as archive:
            for name in sorted(files):
                entry = zipfile.ZipInfo(name, date_time=EPOCH)
                entry.compress_type = zipfile.ZIP_DEFLATED
                entry.create_system = 3  # Unix, so that the permissions below are read as such
                entry.external_attr = 0o100644 << 16
                archive.writestr(entry, files[name])
        umask = os.umask(0)
        os.umask(umask)
        Path(aside).chmod(0o666 & ~umask)
        Path(aside).replace(path)
    except BaseException:
        Path(aside).unlink(missing_ok=True)
        raise
