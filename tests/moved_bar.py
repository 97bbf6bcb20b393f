"""The bar of small_part.py with a port at its root, and pieces of its part file to change."""

from pathlib import Path

from small_part import write_part

from precompute.part import read_part
from precompute.pipeline import Reduction, reduce_part

SUPPORT = '[[support]]\nat = { plane = { normal = "x", at = 0.0 } }\nfix = ["x", "y", "z"]\n'
OUTPUTS = 'outputs = ["displacement.x", "displacement.z", "velocity.z"]'
RATIO = "[damping]\nratio = 0.02\n"
MODES = "[modes]\ncount = 8\n"
SIX = '["motion.x", "motion.y", "motion.z", "angular_motion.x", "angular_motion.y", "angular_motion.z"]'


def root(inputs: str, outputs: str = "[]", more: str = "") -> str:
    """A port at the end x = 0."""
    return (
        '[[port]]\nname = "root"\nat = { plane = { normal = "x", at = 0.0 } }\n'
        f"inputs = {inputs}\noutputs = {outputs}\n{more}\n"
    )


def reduced(folder: Path, *changes: tuple[str, str], certified: bool = False) -> Reduction:
    folder.mkdir(exist_ok=True)
    return reduce_part(read_part(write_part(folder, *changes)), certified=certified)
