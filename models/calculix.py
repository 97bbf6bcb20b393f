"""Frequencies of a part by CalculiX on the same mesh: the independent reference of its README.

Run `python models/calculix.py models/bracket` where `ccx` (calculix.org) is installed.
"""

import re
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from precompute.mesh import Mesh
from precompute.part import Part, read_part
from precompute.read_mesh import UNITS, read_mesh
from precompute.selection import select_nodes

TYPES = {"tet10": "C3D10", "hex20": "C3D20"}
COUNT = 10


def deck(part: Part, mesh: Mesh, count: int = COUNT) -> Iterator[str]:
    """The lines of an input deck in SI units: one material, the part's supports, *FREQUENCY."""
    material = part.materials[0]
    yield "*NODE, NSET=ALL"  # numbers of at most 20 characters
    for k, (x, y, z) in enumerate(mesh.points, 1):
        yield f"{k}, {x:.12e}, {y:.12e}, {z:.12e}"
    for family, cells in mesh.cells.items():
        yield f"*ELEMENT, TYPE={TYPES[family]}, ELSET=BODY"
        for k, nodes in enumerate(cells + 1, 1):
            line = [k, *nodes]
            yield from (", ".join(map(str, line[i : i + 11])) + "," * (i + 11 < len(line)) for i in (0, 11))
    yield from ("*MATERIAL, NAME=M", "*ELASTIC", f"{material.young}, {material.poisson}")
    yield from ("*DENSITY", f"{material.density}", "*SOLID SECTION, ELSET=BODY, MATERIAL=M")
    yield "*BOUNDARY"
    for support in part.supports:
        for node in select_nodes(mesh, support.at, UNITS[part.length_unit]) + 1:
            yield from (f"{node}, {'xyz'.index(direction) + 1}" for direction in support.fix)
    yield from ("*STEP", "*FREQUENCY", str(count), "*NODE FILE", "U", "*END STEP", "")


def frequencies(folder: Path) -> np.ndarray:
    """The lowest frequencies in Hz, as ccx prints them: seven digits of ω²."""
    part = read_part(folder)
    text = "\n".join(line for line in deck(part, read_mesh(part.mesh, part.length_unit)) if line)
    with tempfile.TemporaryDirectory() as scratch:
        Path(scratch, "part.inp").write_text(text + "\n")
        subprocess.run(["ccx", "part"], cwd=scratch, check=True, stdout=subprocess.DEVNULL)
        table = Path(scratch, "part.dat").read_text()
    rows = re.findall(r"^ +\d+ +(\S+E\S+) +\S+ +\S+ +\S+ *$", table, re.MULTILINE)
    return np.sqrt(np.array(rows[:COUNT], dtype=float)) / (2 * np.pi)


if __name__ == "__main__":
    print("\n".join(f"{f:.4f}" for f in frequencies(Path(sys.argv[1]))))
