"""The parts of models/ and the tables of their READMEs."""

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from itertools import groupby
from pathlib import Path

import numpy as np

from fmu_src.runtime.instance import Instance
from precompute.arrays import Floats
from precompute.part import read_part
from precompute.pipeline import Reduction, reduce_part

MODELS = Path(__file__).parents[1] / "models"


@cache
def reduction(name: str) -> Reduction:
    return reduce_part(read_part(MODELS / name))


def table(name: str, first: str = "mode") -> list[dict[str, str]]:
    """The rows of the README's table whose first column has this heading; its modes where none is given."""
    lines = (MODELS / name / "README.md").read_text(encoding="utf-8").splitlines()
    for is_table, rows in groupby(lines, lambda line: line.startswith("|")):
        cells = [[cell.strip(" `") for cell in row.strip("|").split("|")] for row in rows]
        if is_table and cells[0][0] == first:
            return [dict(zip(cells[0], row, strict=True)) for row in cells[2:]]
    raise AssertionError(f"{name}: no table begins with {first}")


def column(name: str, heading: str) -> Floats:
    return np.array([float(row[heading]) for row in table(name)])


def computed(name: str) -> Floats:
    """Our frequencies of the modes that the README lists."""
    modes = [int(row["mode"]) - 1 for row in table(name)]
    return np.array(reduction(name).model.frequency[modes])


def at_rest(name: str, inputs: Mapping[str, float]) -> dict[str, float]:
    """The outputs in equilibrium with these inputs, the others 0."""
    model = replace(reduction(name).model, initial="static")
    instance = Instance(model)
    for key, value in inputs.items():
        instance.set_inputs(model.inputs.index(key), value)
    return dict(zip(model.outputs, instance.reals()[instance.layout.outputs].tolist(), strict=True))
