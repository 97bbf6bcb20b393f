"""C of the native twin, and of its tests, compiled for tests: as a library for ctypes or as a program."""

import ctypes
import hashlib
import os
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from functools import cache
from pathlib import Path

NATIVE = Path(__file__).parents[1] / "fmu_src" / "native"
TESTS = Path(__file__).parent / "native"
FLAGS = ("-std=c11", "-O2", "-Wall", "-Wextra", "-Werror", f"-I{NATIVE}", f"-I{TESTS}")
ZIG = (sys.executable, "-m", "ziglang", "cc")
SHARED = ("-shared",) if sys.platform == "win32" else ("-shared", "-fPIC")


def native_library(name: str, sources: Sequence[str | Path], flags: Sequence[str] = ()) -> ctypes.CDLL:
    """The library made of these C files; paths are relative to fmu_src/native."""
    ending = ".dll" if sys.platform == "win32" else ".so"
    return ctypes.CDLL(str(compiled(name + ending, tuple(sources), (*SHARED, *flags))))


@cache
def compiled(
    name: str, sources: tuple[str | Path, ...], flags: tuple[str, ...] = (), compiler: tuple[str, ...] = ZIG
) -> Path:
    """A program, or a library if the flags say so, compiled once for its content.

    Several processes at once do no harm. Raises RuntimeError with the words of the compiler.
    """
    target = _cache() / _digest(sources, (*compiler, *flags)) / name
    if not target.exists():
        target.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=target.parent) as aside:
            os.replace(compile_into(Path(aside), name, sources, flags, compiler), target)
    return target


def compile_into(
    folder: Path,
    name: str,
    sources: Sequence[str | Path],
    flags: Sequence[str] = (),
    compiler: Sequence[str] = ZIG,
) -> Path:
    """The same, made anew in this folder."""
    command = [
        *compiler,
        *FLAGS,
        *flags,
        *(str(NATIVE / source) for source in sources),
        "-o",
        str(folder / name),
    ]
    if sys.platform != "win32":
        command.append("-lm")
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError(f"{name} does not compile:\n{done.stderr}")
    return folder / name


def _cache() -> Path:
    """A folder of this user's own."""
    folder = Path(tempfile.gettempdir()) / f"modalfmu-tests-{getattr(os, 'getuid', int)()}"
    folder.mkdir(mode=0o700, exist_ok=True)
    return folder


def _digest(sources: Sequence[str | Path], options: Sequence[str]) -> str:
    """Of all that the result depends on."""
    paths = [NATIVE / source for source in sources]
    total = hashlib.sha256(repr((paths, options, FLAGS)).encode())
    for path in sorted({*NATIVE.glob("*.[ch]"), *TESTS.glob("*.[ch]"), *paths}):
        total.update(f"{path}\0".encode() + hashlib.sha256(path.read_bytes()).digest())
    return total.hexdigest()[:32]
