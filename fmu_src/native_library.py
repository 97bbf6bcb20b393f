"""Where the libraries of the C twin are: in the package, in the user's cache, or compiled into it."""

import os
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

from .toolchain import PLATFORMS, ToolchainError, can_compile, compile_library, host_platform, library_name

PACKAGED = Path(__file__).parent / "binaries"
CROSS = 'pip install "modalfmu[cross]"'

Progress = Callable[[str, float | None], None]
"""Called with what is being done and the fraction of it that is done, None where that is not known."""


def native_libraries(
    platforms: Sequence[str] | None = None, progress: Progress = lambda stage, fraction: None
) -> dict[str, Path]:
    """The library for each platform, compiled where it is not there; None: this one's and all others there.

    Raises ToolchainError where one is not there and there is no compiler, OSError where it cannot be kept.
    """
    if platforms is not None:
        return {platform: _find_or_compile(platform, progress) for platform in platforms}
    host = host_platform()
    found = {platform: _find(platform) for platform in PLATFORMS}
    there = {platform: library for platform, library in found.items() if library is not None}
    if host is not None and host not in there:
        there[host] = _find_or_compile(host, progress)
    if not there:
        raise ToolchainError(
            f"there is no library for this machine; choose others: --platform {','.join(PLATFORMS)}"
        )
    return there


def cache_folder() -> Path:
    """Where the user's libraries are kept: LOCALAPPDATA, XDG_CACHE_HOME, or the system's usual place.

    Raises ToolchainError for a user without a home.
    """
    variable = "LOCALAPPDATA" if sys.platform == "win32" else "XDG_CACHE_HOME"
    if folder := os.environ.get(variable):
        return Path(folder, "modalfmu")
    usual = {"win32": "AppData/Local", "darwin": "Library/Caches"}.get(sys.platform, ".cache")
    try:
        return Path.home() / usual / "modalfmu"
    except RuntimeError:
        raise ToolchainError(f"there is no home folder to keep libraries in; set {variable}") from None


def _find(platform: str) -> Path | None:
    name = library_name(platform)
    for folder in (PACKAGED, _cache_if_any()):
        if folder and (folder / platform / name).is_file():
            return folder / platform / name
    return None


def _cache_if_any() -> Path | None:
    try:
        return cache_folder()
    except ToolchainError:
        return None


def _find_or_compile(platform: str, progress: Progress) -> Path:
    found = _find(platform)
    if found is not None:
        return found
    if not can_compile():
        raise ToolchainError(f"the library for {platform} is not there, and no compiler; {CROSS}")
    progress(f"compiling the library for {platform}", None)
    library = cache_folder() / platform / library_name(platform)
    compile_library(platform, library)
    return library
