"""The inputs of the fuzz target of the calls, replayed on three models."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from native_library import NATIVE, TESTS, ZIG, compile_into

from fmu_src.toolchain import fmi_headers

FUZZ = Path(__file__).parent / "fuzz"
CORPUS = Path(__file__).parent / "data" / "fuzz" / "calls"
SOURCES = (FUZZ / "calls.c", FUZZ / "replay.c", TESTS / "counting_memory.c")
UNDEFINED = ("-g", "-O1", "-fsanitize=undefined", "-fno-sanitize-recover=all")
EMBEDDED = (
    "-DMODALFMU_EMBEDDED_MODEL",
    "-Wno-unused-function",  # the reader of the resources is declared, and not there
    f"-I{NATIVE}",
    f"-I{fmi_headers()}",
)


def replayed(folder: Path, model: str, sources: tuple[Path, ...] = SOURCES, *include: str) -> tuple[int, str]:
    """Exit status and output of the replay of the corpus."""
    subprocess.run([sys.executable, FUZZ / "call_seeds.py", folder, model], check=True)
    flags = (*include, f"-I{folder}", f"-I{FUZZ}", *EMBEDDED)
    program = None
    for compiler in filter(shutil.which, ("gcc", "clang")):
        try:
            program = compile_into(
                folder, "replay", sources, ("-fsanitize=address", *UNDEFINED, *flags), (compiler,)
            )
            break
        except RuntimeError:  # a compiler without the sanitizers' libraries
            continue
    if program is None:
        program = compile_into(folder, "replay", sources, (*UNDEFINED, *flags), ZIG)
    done = subprocess.run([program, *sorted(CORPUS.iterdir())], capture_output=True, text=True)
    return done.returncode, done.stdout[-300:] + done.stderr[-2000:]


@pytest.mark.parametrize("model", ["rest", "static", "driven"])
def test_corpus(tmp_path: Path, model: str) -> None:
    assert len(list(CORPUS.iterdir())) > 10
    status, output = replayed(tmp_path, model)
    assert status == 0, output


@pytest.mark.parametrize(
    ("file", "right", "wrong"),
    [
        ("fmi2_life.c", "        c->memory.release(c->name);", "        (void)0;"),
        ("fmi2_variables.c", "highest < size", "highest <= size"),
        ("saved_state.c", "head.active > n ", "head.active > n + 1000 "),
    ],
)
def test_a_fault_is_seen(tmp_path: Path, file: str, right: str, wrong: str) -> None:
    """Negative control: with one check of the twin taken out, the replay fails."""
    twin = tmp_path / "native"
    shutil.copytree(NATIVE, twin)
    text = (twin / file).read_text(encoding="ascii")
    assert text.count(right) == 1
    (twin / file).write_text(text.replace(right, wrong), encoding="ascii")
    # an include in quotes is looked for beside the including file first: the copy takes the copy's
    target = tmp_path / "calls.c"
    shutil.copy(FUZZ / "calls.c", target)
    target.write_text(target.read_text().replace('"modalfmu.c"', f'"{twin / "modalfmu.c"}"'))
    status, _ = replayed(tmp_path, "rest", (target, *SOURCES[1:]))
    assert status != 0
