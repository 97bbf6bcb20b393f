"""How the C twin becomes a library: one compiler, one recipe per platform.

Nothing here needs numpy: it also runs while modalfmu itself is being built.
"""

import hashlib
import importlib.util
import os
import struct
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from platform import machine

from .runtime.errors import ModalFmuError

SOURCES = Path(__file__).parent / "native"
SINGLE_FILE = "modalfmu.c"  # includes all the others
FMI_HEADERS = ("fmi2FunctionTypes.h", "fmi2Functions.h", "fmi2TypesPlatform.h")
FLAGS = (
    *("-std=c11", "-O3", "-fno-math-errno", "-shared", "-fPIC", "-fvisibility=hidden", "-s"),
    "-mcpu=baseline",  # wider instructions are chosen when the library is loaded
    "-fno-sanitize=undefined",
)
PAGE = 1 << 14  # of Apple's arm64 processors


class ToolchainError(ModalFmuError):
    """A library of the C twin is not there and cannot be compiled."""


@dataclass(frozen=True)
class Platform:
    """A folder of an FMU's `binaries/`: the compiler's targets, the library's ending, the tag of a wheel."""

    name: str
    targets: tuple[str, ...]
    ending: str
    wheel_tag: str


# glibc 2.17 is that of CentOS 7; darwin64 is one file for both processors
PLATFORMS = {
    platform.name: platform
    for platform in (
        Platform("linux64", ("x86_64-linux-gnu.2.17",), ".so", "manylinux_2_17_x86_64"),
        Platform("win64", ("x86_64-windows-gnu",), ".dll", "win_amd64"),
        Platform("darwin64", ("x86_64-macos.11.0", "aarch64-macos.11.0"), ".dylib", "macosx_11_0_universal2"),
        Platform("aarch64-linux", ("aarch64-linux-gnu.2.17",), ".so", "manylinux_2_17_aarch64"),
    )
}
MACHINES = {
    ("linux", "x86_64"): "linux64",
    ("linux", "aarch64"): "aarch64-linux",
    ("win32", "amd64"): "win64",
    ("darwin", "x86_64"): "darwin64",
    ("darwin", "arm64"): "darwin64",
}


def host_platform() -> str | None:
    """The platform that this Python runs on, None where it is none of PLATFORMS."""
    return MACHINES.get((sys.platform, machine().lower())) if sys.maxsize > 2**32 else None


def platforms_of(text: str, option: str) -> tuple[str, ...]:
    """ "win64,aarch64-linux" → their names in the order of PLATFORMS; "all" → all of them.

    Raises ToolchainError, beginning with `option`, where a name is unknown.
    """
    names = {name.strip() for name in text.split(",")}
    if names == {"all"}:
        return tuple(PLATFORMS)
    if unknown := sorted(names - {*PLATFORMS}):
        raise ToolchainError(f"{option}: got {unknown[0]!r}, expected all, or some of {','.join(PLATFORMS)}")
    return tuple(name for name in PLATFORMS if name in names)


def native_sources() -> dict[str, bytes]:
    """The C files and headers of the twin, by name."""
    return {path.name: path.read_bytes() for path in sorted(SOURCES.glob("*.[ch]"))}


def fmi_headers() -> Path:
    """The folder of the FMI 2.0 headers, which FMPy carries.

    Raises ToolchainError where it does not.
    """
    found = importlib.util.find_spec("fmpy")
    folders = (
        [] if found is None else [Path(place, "c-code") for place in found.submodule_search_locations or ()]
    )
    for folder in folders:
        if all((folder / name).is_file() for name in FMI_HEADERS):
            return folder
    raise ToolchainError("FMPy's FMI 2.0 headers are not there; pip install --force-reinstall fmpy")


def library_name(platform: str) -> str:
    """The library's file name; it changes with the sources and the recipe, so an old library is not found."""
    recipe = PLATFORMS[platform]
    total = hashlib.sha256("\0".join((*FLAGS, *recipe.targets)).encode())
    for name, content in native_sources().items():
        total.update(f"\0{name}\0{len(content)}\0".encode() + content)
    return f"modalfmu-{total.hexdigest()[:12]}{recipe.ending}"


def can_compile() -> bool:
    """Whether ziglang is installed, the compiler for all platforms."""
    return importlib.util.find_spec("ziglang") is not None


def compile_library(platform: str, library: Path) -> None:
    """Compile the C twin for this platform; `library` appears as a whole or not at all.

    Raises ToolchainError with the compiler's own words, OSError where the file cannot be written.
    """
    recipe = PLATFORMS[platform]
    library.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=".compiling-", dir=library.parent) as folder:
        slices = [_compiled(target, Path(folder), recipe.ending) for target in recipe.targets]
        whole = Path(folder, library.name)
        whole.write_bytes(slices[0] if len(slices) == 1 else universal_binary(slices))
        whole.chmod(0o755)
        whole.replace(library)


def _compiled(target: str, folder: Path, ending: str) -> bytes:
    output = folder / f"modalfmu{ending}"
    command = [sys.executable, "-m", "ziglang", "cc", "-target", target, *FLAGS]
    command += ["-I", str(fmi_headers()), str(SOURCES / SINGLE_FILE), "-o", output.name]
    environment = dict(os.environ)
    if not any(name in environment for name in ("HOME", "XDG_CACHE_HOME", "LOCALAPPDATA")):
        environment.setdefault("ZIG_GLOBAL_CACHE_DIR", str(folder / "zig"))  # it finds no place by itself
    try:
        done = subprocess.run(
            command,
            cwd=folder,
            env=environment,
            capture_output=True,
            text=True,
            encoding="utf-8",
            errors="replace",
            check=False,
        )
    except OSError as error:
        raise ToolchainError(f"{target}: the compiler cannot be started ({error})") from None
    if done.returncode != 0:
        lines = done.stderr.strip().splitlines() or [f"exit code {done.returncode}"]
        told = next((line for line in lines if "error" in line), lines[-1])
        raise ToolchainError(f"{target}: the compiler failed: {told}")
    return output.read_bytes()


def universal_binary(slices: Sequence[bytes]) -> bytes:
    """Mach-O files for several processors as one, after a table of cputype, subtype, offset, size, log2 PAGE.

    The table is big-endian, each file begins on a page of its own (Apple, mach-o/fat.h).
    """
    table, body = struct.pack(">II", 0xCAFEBABE, len(slices)), b""
    for part in slices:
        processor = struct.unpack_from("<II", part, 4)
        table += struct.pack(">IIIII", *processor, PAGE + len(body), len(part), PAGE.bit_length() - 1)
        body += part + bytes(-len(part) % PAGE)
    return table.ljust(PAGE, b"\0") + body
