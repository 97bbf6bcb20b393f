"""A part file to change, and the one line that a mistake in it is told in."""

import json
from pathlib import Path
from typing import Any

import pytest

from precompute.errors import PartError
from precompute.part import Part, read_part

BEAM = """
[part]
name = "cantilever"
mesh = "beam.msh"
length_unit = "mm"
[[material]]
name = "steel"
young = 210e9
poisson = 0.3
density = 7850
[[support]]
at = "clamp"
fix = ["x", "y", "z"]
[[port]]
name = "tip"
at = { point = [1.0, 0, 0.0] }
inputs = ["force.y", "force.z"]
outputs = ["displacement.y", "acceleration.z"]
[modes]
count = 20
[damping]
alpha = 1.0
beta = 1e-6
"""
FULL = """
[part]
name = "frame"
mesh = "frame.msh"
length_unit = "mm"
[[material]]
name = "steel"
young = 210e9
poisson = 0.3
density = 7850
alpha = 0.5
beta = 1e-5
[[support]]
name = "clamp"
at = "bolts"
fix = ["x", "y", "z"]
outputs = ["reaction.x"]
[[port]]
name = "tip"
at = "end"
inputs = ["moment.x", "pressure"]
outputs = ["rotation.z", "absolute_acceleration.y", "stress.mises"]
[[port]]
name = "flange"
at = "ring"
kind = "rigid"
[[pair]]
name = "gap"
ports = ["tip", "flange"]
outputs = ["angular_velocity.x"]
[loads]
gravity = true
base = ["x", "y"]
[[spring]]
port = "tip"
direction = "rx"
stiffness = 1e6
[[dashpot]]
port = "tip"
to = "flange"
direction = "z"
damping = 300
[[mass]]
port = "flange"
mass = 2.5
[energy]
outputs = ["kinetic", "strain"]
[basis]
kind = "modal"
[modes]
error = 0.02
band = [0, 500]
[damping]
alpha = 1.0
[accuracy]
band = [10, 400]
tolerance = 0.03
"""
MATRICES = """
[part]
name = "chain"
[system]
stiffness = "data/K.mtx"
mass = "M.mtx"
dofs = "dofs.csv"
units = { length = "mm", mass = "t" }
[[support]]
at = { nodes = [1] }
fix = ["x", "rx"]
[[port]]
name = "tip"
at = { nodes = [4] }
inputs = ["force.x"]
outputs = ["displacement.x"]
[modes]
count = 2
"""


def read(part_file: Path, text: str) -> Part:
    part_file.write_bytes(text.encode())
    return read_part(part_file)


def changed(old: str, new: str) -> str:
    assert BEAM.count(old) == 1, f"{old!r} must occur once in the example"
    return BEAM.replace(old, new)


def told(path: Path) -> str:
    """The one line that `path` ends in, without the file's name."""
    with pytest.raises(PartError) as caught:
        read_part(path)
    line = str(caught.value)
    assert len(line.splitlines()) == 1
    assert line.startswith(f"{path}: ")
    return line.removeprefix(f"{path}: ")


def full(old: str, new: str) -> str:
    assert FULL.count(old) == 1, f"{old!r} must occur once in the example"
    return FULL.replace(old, new)


def toml(value: Any) -> str:
    """`value` in TOML's inline notation."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{json.dumps(key)} = {toml(v)}" for key, v in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(toml, value)) + "]"
    if isinstance(value, str):
        return '"' + "".join(f"\\U{ord(c):08x}" for c in value) + '"'
    if isinstance(value, bool):
        return str(value).lower()
    return repr(value)  # nan and inf are TOML too
