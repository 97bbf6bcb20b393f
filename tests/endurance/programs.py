"""The C programs of this folder, with the library of the FMUs or, under a sanitizer, with its sources."""

import shutil
import subprocess
from collections.abc import Sequence
from functools import cache
from pathlib import Path

from native_fmu import NativeFmu
from native_library import ZIG, compiled

from fmu_src.native_library import native_libraries
from fmu_src.toolchain import fmi_headers, host_platform

HERE = Path(__file__).parent
SANITIZERS = {
    "ThreadSanitizer": ("-fsanitize=thread",),
    "AddressSanitizer, UBSan": ("-fsanitize=address,undefined", "-fno-sanitize-recover=all"),
}


@cache
def program(name: str) -> Path:
    """The program with the library that is in every FMU."""
    (library,) = native_libraries([host_platform() or "linux64"]).values()
    return compiled(name, (HERE / f"{name}.c", library), _flags(), ZIG)


@cache
def sanitized(name: str, sanitizer: str) -> Path | None:
    """The same with the sources, or None where no compiler here has the sanitizer."""
    flags = ("-g", "-O1", *_flags(), *SANITIZERS[sanitizer])
    for compiler in filter(shutil.which, ("gcc", "clang")):
        try:
            return compiled(name, (HERE / f"{name}.c", "modalfmu.c"), flags, (compiler,))
        except RuntimeError:  # without the sanitizer's library
            continue
    return None


def run(path: Path, fmu: NativeFmu, *arguments: object) -> list[list[str]]:
    """The words of each line it printed. Raises RuntimeError where it fails."""
    done = subprocess.run(command(path, fmu, *arguments), capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError(f"{path.name}: exit {done.returncode}\n{done.stdout}{done.stderr}")
    return [line.split() for line in done.stdout.splitlines()]


def command(path: Path, fmu: NativeFmu, *arguments: object) -> Sequence[str]:
    return [str(path), fmu.guid, fmu.resources, *map(str, arguments)]


def _flags() -> tuple[str, ...]:
    return ("-pthread", f"-I{fmi_headers()}")
