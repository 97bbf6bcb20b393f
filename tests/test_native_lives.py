"""Random lives of native instances, in several threads, under the sanitizers of the system's compiler."""

import shutil
import subprocess
from collections.abc import Callable
from functools import cache
from pathlib import Path

import pytest
from examples import everything
from memcheck import LIVES, lives_arguments, lives_flags
from native_library import compiled

from fmu_src.runtime.model import ReducedModel
from precompute.spring_damper import spring_damper

SANITIZED = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all")


@cache
def lives() -> Path:
    for compiler in filter(shutil.which, ("gcc", "clang")):
        try:
            return compiled("lives", (LIVES, "modalfmu.c"), (*lives_flags(), *SANITIZED), (compiler,))
        except RuntimeError:  # a compiler without threads or without the sanitizers' libraries
            continue
    pytest.skip("neither gcc nor clang with sanitizers on this system")


def mount() -> ReducedModel:
    """Without a mode."""
    return spring_damper("mount", {"x": 500.0, "rz": 7.0}, {"x": 3.0, "ry": 0.5})


@pytest.mark.parametrize(("make", "count"), [(everything, 1000), (mount, 200)])
def test_random_lives(make: Callable[[], ReducedModel], count: int) -> None:
    """Wrong calls, damaged states, failing memory: no fault, nothing left, and all threads see the same."""
    seen = []
    for threads in (1, 4):
        command = [str(lives()), *lives_arguments(count, threads, make)]
        done = subprocess.run(command, capture_output=True, text=True)
        assert done.returncode == 0, done.stdout + done.stderr
        seen.append(done.stdout)
    assert seen[0] == seen[1]
    assert seen[0].startswith(f"{count} lives, ")
