"""Random lives of native instances under valgrind and the sanitizers of clang: no fault, no leak, no race.

    python tests/memcheck.py [--instances 1000]

valgrind runs the FMU's own library, the sanitizers the same sources. A tool that is not there is left out.
Prints a line for each, or what the tool found; the exit code tells whether any found something.
"""

import argparse
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path

from examples import everything
from native_fmu import native_fmu
from native_library import TESTS, compile_into

from fmu_src.runtime.model import ReducedModel
from fmu_src.toolchain import fmi_headers

SANITIZERS = {
    "AddressSanitizer, LeakSanitizer, UBSan": ("-fsanitize=address,undefined", "-fno-sanitize-recover=all"),
    "ThreadSanitizer": ("-fsanitize=thread",),
}
VALGRIND = ("valgrind", "--quiet", "--leak-check=full", "--show-leak-kinds=all", "--error-exitcode=1")


def main() -> int:
    parser = argparse.ArgumentParser(
        formatter_class=argparse.RawDescriptionHelpFormatter, description=__doc__
    )
    parser.add_argument("--instances", type=int, default=1000)
    instances = parser.parse_args().instances
    sound = True
    with tempfile.TemporaryDirectory() as folder:
        if shutil.which("valgrind") and shutil.which("gcc"):
            library = next((native_fmu(everything).folder / "binaries").glob("*/*.so"))
            program = compile_into(Path(folder), "lives", [LIVES, library], lives_flags(), ["gcc"])
            sound &= run("valgrind", [*VALGRIND, str(program)], instances, threads=1)
        if shutil.which("clang"):
            for tool, flags in SANITIZERS.items():
                program = compile_into(
                    Path(folder), tool[:6], [LIVES, "modalfmu.c"], [*lives_flags(), *flags], ["clang"]
                )
                for threads in (1, 8):
                    sound &= run(f"{tool}, {threads} threads", [str(program)], instances, threads)
    return 0 if sound else 1


LIVES = TESTS / "lives.c"


def lives_flags() -> list[str]:
    return ["-g", "-O1", "-pthread", f"-I{fmi_headers()}"]


def lives_arguments(instances: int, threads: int, make: Callable[[], ReducedModel] = everything) -> list[str]:
    fmu = native_fmu(make)
    sizes = (fmu.modes, len(fmu.inputs), len(fmu.outputs), instances, threads)
    return [fmu.guid, fmu.resources, *map(str, sizes)]


def run(tool: str, command: Sequence[str], instances: int, threads: int) -> bool:
    begin = time.monotonic()
    done = subprocess.run([*command, *lives_arguments(instances, threads)], capture_output=True, text=True)
    print(f"{tool}: {done.stdout.strip()}, {time.monotonic() - begin:.1f} s", done.stderr, flush=True)
    return done.returncode == 0


if __name__ == "__main__":
    sys.exit(main())
