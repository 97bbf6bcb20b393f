"""A simulation that is killed again and again, and resumed by a new process each time."""

import random
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

from endurance.programs import command, program, run
from examples import everything
from native_fmu import native_fmu

EVERY = 100  # steps between two states; writing one takes about a third as long as these


@dataclass(frozen=True)
class Survived:
    """What the last process printed; where each began; kills of a live process, of one in its writing."""

    last: list[list[str]]
    begun: list[int]
    kills: int
    in_writing: int


def uninterrupted(steps: int) -> list[list[str]]:
    with tempfile.TemporaryDirectory() as folder:
        return run(program("resume"), native_fmu(everything), *_arguments(steps, Path(folder) / "state"))[1:]


def killed(steps: int, kills: int, seed: int = 1) -> Survived:
    """The same with so many real kills up to three quarters of the steps, and one process to the end."""
    fmu, rng = native_fmu(everything), random.Random(seed)
    begun, hit, in_writing = [], 0, 0
    moments = sorted(rng.randrange(steps * 3 // 4) for _ in range(kills))
    with tempfile.TemporaryDirectory() as folder:
        state = Path(folder) / "state"
        line = command(program("resume"), fmu, *_arguments(steps, state))
        for moment in (*moments, None):
            with subprocess.Popen(line, stdout=subprocess.PIPE, text=True) as process:
                if moment is not None:
                    while process.poll() is None and _saved_step(state) < moment:
                        time.sleep(1e-3)
                    time.sleep(rng.uniform(0.0, 1e-3))
                    process.kill()
                out, _ = process.communicate()
            hit += process.returncode != 0
            in_writing += state.with_name("state.part").exists()
            lines = [words.split() for words in out.splitlines()]
            begun += [int(words[1]) for words in lines if words[0] == "from"]
    return Survived(lines[1:], begun, hit, in_writing)


def _saved_step(state: Path) -> int:
    """The number that a state begins with."""
    return int.from_bytes(state.read_bytes()[:8], sys.byteorder) if state.exists() else 0


def _arguments(steps: int, state: Path) -> tuple[object, ...]:
    fmu = native_fmu(everything)
    return len(fmu.inputs), fmu.size, steps, EVERY, state
