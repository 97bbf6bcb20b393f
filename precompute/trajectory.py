"""The outputs of a simulation over time, as a CSV file."""

from pathlib import Path

from fmpy.util import write_csv

from .output_file import replacing
from .simulation import Simulation


def write_trajectory(path: Path, simulation: Simulation) -> Path:
    """A column `time` (s) and one per output, in digits that give back the same number; gives the path."""
    with replacing(path) as aside:
        write_csv(aside, simulation.result, simulation.face.outputs)
    return path
