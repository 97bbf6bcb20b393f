"""Compiles the libraries of the native FMUs while modalfmu is built.

MODALFMU_PLATFORMS: "all", or a list such as "linux64,win64"; left out: this machine's. A wheel with all
of them installs everywhere, one with some of them on those platforms.
"""

import os
import re
import sys
import sysconfig
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

VARIABLE = "MODALFMU_PLATFORMS"


class NativeLibraries(BuildHookInterface):  # type: ignore[type-arg]  # generic in newer hatchling only
    """Puts the libraries into `fmu_src/binaries/<platform>/`, and into the wheel."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """version: "standard" or "editable"; build_data: the tag of the wheel and what goes in."""
        sys.path.insert(0, self.root)  # what is being built is not installed yet
        from fmu_src import toolchain
        from fmu_src.runtime.errors import ModalFmuError

        chosen = os.environ.get(VARIABLE) or toolchain.host_platform()
        if chosen is None:
            sys.exit(f"modalfmu: there is no native library for this machine; set {VARIABLE}=all")
        try:
            platforms = toolchain.platforms_of(chosen, VARIABLE)
            libraries = [self._library(toolchain, platform) for platform in platforms]
        except (ModalFmuError, OSError) as error:
            sys.exit(f"modalfmu: {error}")
        build_data["force_include"] |= {place: place for place in libraries}
        if len(platforms) < len(toolchain.PLATFORMS):
            tags = [toolchain.PLATFORMS[platform].wheel_tag for platform in platforms]
            if VARIABLE not in os.environ:  # a wheel for this machine, whatever its C library
                tags = [re.sub(r"[-.]", "_", sysconfig.get_platform())]
            build_data |= {"pure_python": False, "tag": f"py3-none-{'.'.join(sorted(tags))}"}

    def _library(self, toolchain: Any, platform: str) -> str:
        """Its place below the root, where it is up to date and alone."""
        name = toolchain.library_name(platform)
        place = f"fmu_src/binaries/{platform}/{name}"
        library = Path(self.root, place)
        if not library.is_file():
            self.app.display_info(f"compiling the library for {platform}")
            toolchain.compile_library(platform, library)
        for old in library.parent.glob("modalfmu-*"):
            if old != library:
                old.unlink()
        return place
