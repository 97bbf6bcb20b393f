"""The inputs of the fuzz targets, replayed: no sanitizer complains, and what the target demands holds."""

import shutil
import subprocess
from functools import cache
from pathlib import Path

import pytest
from native_library import TESTS, ZIG, compile_into, compiled
from native_reader import HELPERS, READER

FUZZ = Path(__file__).parent / "fuzz"
CORPUS = Path(__file__).parent / "data" / "fuzz"
NOT_READ = {"folder.c", "location.c"}  # the files of the target are in memory
SOURCES = {"resources": (*(source for source in READER if source not in NOT_READ), *HELPERS)}
UNDEFINED = ("-g", "-O1", "-fsanitize=undefined", "-fno-sanitize-recover=all")
ADDRESS = ("-fsanitize=address", *UNDEFINED)


@cache
def replay(target: str) -> Path:
    """The program, with AddressSanitizer where the system's compiler has it."""
    sources = (FUZZ / f"{target}.c", FUZZ / "replay.c", *SOURCES[target])
    for compiler in filter(shutil.which, ("gcc", "clang")):
        try:
            return compiled(f"replay_{target}", sources, ADDRESS, (compiler,))
        except RuntimeError:  # a compiler without the sanitizers' libraries
            continue
    return compiled(f"replay_{target}", sources, UNDEFINED, ZIG)


@pytest.mark.parametrize("target", list(SOURCES))
def test_corpus(target: str) -> None:
    inputs = sorted((CORPUS / target).iterdir())
    assert len(inputs) > 20
    done = subprocess.run([replay(target), *inputs], capture_output=True, text=True)
    assert done.returncode == 0, (done.stdout.splitlines()[-1], done.stderr)
    assert len(done.stdout.splitlines()) == len(inputs)


def test_a_fault_is_seen(tmp_path: Path) -> None:
    """A file that is said to be a byte longer than it is: reading it fails the replay."""
    faulty, right = tmp_path / "faulty.c", TESTS / "memory_files.c"
    size = "content->size = file->size;"
    assert right.read_text().count(size) == 1
    faulty.write_text(right.read_text().replace(size, "content->size = file->size + 1;"))
    sources = [faulty if source == right else source for source in SOURCES["resources"]]
    for compiler in filter(shutil.which, ("gcc", "clang")):
        try:
            program = compile_into(
                tmp_path, "faulty", [FUZZ / "resources.c", FUZZ / "replay.c", *sources], ADDRESS, [compiler]
            )
        except RuntimeError:
            continue
        done = subprocess.run([program, CORPUS / "resources" / "two_ports"], capture_output=True, text=True)
        assert done.returncode != 0
        assert "AddressSanitizer: heap-buffer-overflow" in done.stderr
        return
    pytest.skip("neither gcc nor clang with AddressSanitizer on this system")
