"""What can run inside an FMU: the native twin with its platforms, or the Python twin."""

from dataclasses import dataclass
from functools import partial
from typing import Literal

from fmu_src.native_fmu import build_native_fmu
from fmu_src.native_library import native_libraries
from fmu_src.toolchain import platforms_of

from .errors import ModalFmuError
from .full_part import Progress
from .pipeline import Builder


@dataclass(frozen=True)
class Runtime:
    """What writes the FMU, and the platforms that the FMU will run on."""

    build: Builder
    platforms: tuple[str, ...]


def choose_runtime(name: Literal["native", "python"], platforms: str | None, progress: Progress) -> Runtime:
    """The runtime of this name; libraries that are not there are compiled now, before the long computation.

    platforms: "win64,aarch64-linux", "all", or None for those that are there.
    Raises ModalFmuError: an unknown platform, platforms for Python, no library and no compiler.
    """
    if name == "python":
        from fmu_src.python_fmu import PLATFORMS, build_python_fmu  # pythonfmu is needed by this twin only

        if platforms is not None:
            raise ModalFmuError(
                f"--platform: the Python runtime has {', '.join(PLATFORMS)}, got {platforms}; leave it out"
            )
        return Runtime(build_python_fmu, PLATFORMS)
    chosen = None if platforms is None else platforms_of(platforms, "--platform")
    libraries = native_libraries(chosen, progress)
    return Runtime(partial(build_native_fmu, libraries=libraries), tuple(libraries))
