"""Masters that are not ours, each in a process of its own (tests/foreign), and how far two of them differ."""

import json
import platform
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest

from precompute.arrays import Floats

FOREIGN = Path(__file__).parent / "foreign"
SAME = 1e-12

Record = Mapping[str, Floats]

has_libraries = pytest.mark.skipif(
    platform.machine() not in ("x86_64", "AMD64") or sys.platform == "darwin",
    reason="libcosimpy and ecospy have libraries for x86-64 Linux and Windows only",
)


def run(script: str, *arguments: object) -> Record:
    """What a script of tests/foreign prints in its last line."""
    done = subprocess.run(
        [sys.executable, "-I", str(FOREIGN / script), *map(str, arguments)],
        capture_output=True,
        text=True,
        encoding="utf-8",
        timeout=120,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return {key: np.array(values) for key, values in json.loads(done.stdout.splitlines()[-1]).items()}


def difference(found: Record, expected: Record) -> float:
    """The largest difference of one of `found`, relative to its largest value; all of them move."""
    assert {*found} <= {*expected}
    assert all(abs(expected[key]).max() > 1e-6 for key in found)
    return max(abs(found[key] - expected[key]).max() / abs(expected[key]).max() for key in found)
