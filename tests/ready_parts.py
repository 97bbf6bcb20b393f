"""The parts of models/ and the tables of their READMEs."""

from functools import cache
from pathlib import Path

import numpy as np

from precompute.arrays import Floats
from precompute.part import read_part
from precompute.pipeline import Reduction, reduce_part

MODELS = Path(__file__).parents[1] / "models"


@cache
def reduction(name: str) -> Reduction:
    return reduce_part(read_part(MODELS / name))


def table(name: str) -> list[dict[str, str]]:
    """The rows of the README's table of references."""
    lines = [
        [cell.strip() for cell in line.strip("|").split("|")]
        for line in (MODELS / name / "README.md").read_text(encoding="utf-8").splitlines()
        if line.startswith("|")
    ]
    return [dict(zip(lines[0], row, strict=True)) for row in lines[2:]]


def column(name: str, heading: str) -> Floats:
    return np.array([float(row[heading]) for row in table(name)])


def computed(name: str) -> Floats:
    """Our frequencies of the modes that the README lists."""
    modes = [int(row["mode"]) - 1 for row in table(name)]
    return np.array(reduction(name).model.frequency[modes])
