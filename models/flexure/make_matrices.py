"""The deck of the flexure, K and M of it by CalculiX, and CalculiX's own answers to compare with.

Run `python make_matrices.py` where `ccx` (calculix.org, 2.20) is installed; writes flexure.inp, flexure.sti,
flexure.mas and flexure.dof beside itself and prints frequencies and static displacements.
"""

import re
import shutil
import subprocess
import tempfile
from collections.abc import Iterator
from itertools import product
from pathlib import Path

import numpy as np

HERE = Path(__file__).parent
ACROSS = [
    0.0,
    1.0,
    10.5,
    20.0,
    29.5,
    39.0,
    40.0,
]  # mm: x of the corners of cells; the first and last: a blade
WIDE = [0.0, 6.0, 12.0]  # mm: y
UP = [*np.linspace(0.0, 40.0, 7), 48.0]  # mm: z; the last: the stage
SENSOR = (20.0, 6.0, 48.0)  # mm: in the middle of the top of the stage
CORNERS = [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 2), (2, 0, 2), (2, 2, 2), (0, 2, 2)]
EDGES = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
STORE = ["*STEP", "*FREQUENCY, SOLVER=MATRIXSTORAGE", "1", "*END STEP"]
MODES = 6
AREA = 12.0 * 8.0  # mm²: of the face that the actuator pushes
LOADS = {  # name, lines, direction of the sensor's displacement
    "1 N at the actuator in x": (["*DLOAD", f"PUSHED, P4, {-1 / AREA!r}"], 0),
    "1 N at the sensor in x": (["*CLOAD", "SENSOR, 1, 1."], 0),
    "1 N at the sensor in y": (["*CLOAD", "SENSOR, 2, 1."], 1),
}


def cells() -> list[np.ndarray]:
    """Corners and middles of edges of each cell on a grid twice as fine: (20, 3) whole numbers each."""
    last = len(UP) - 2
    found = []
    for i, j, k in product(range(len(ACROSS) - 1), range(len(WIDE) - 1), range(len(UP) - 1)):
        if k == last or i in (0, len(ACROSS) - 2):
            corners = np.array(CORNERS) + 2 * np.array([i, j, k])
            middles = [(corners[a] + corners[b]) // 2 for a, b in EDGES]
            found.append(np.vstack([corners, middles]))
    return found


def place(node: tuple[int, int, int]) -> tuple[float, ...]:
    """x, y, z in mm of a point of the fine grid."""
    axes = (ACROSS, WIDE, UP)
    return tuple(
        float(np.interp(n, 2 * np.arange(len(axis)), axis)) for n, axis in zip(node, axes, strict=True)
    )


def model() -> Iterator[str]:
    """The lines of the deck up to its step; mm, t, s, so MPa."""
    grid = [[tuple(map(int, node)) for node in cell] for cell in cells()]
    number = {node: n for n, node in enumerate(sorted({node for cell in grid for node in cell}), 1)}
    yield "** A stage on two blades; mm, t, s. Written by make_matrices.py."
    yield "*NODE"
    for node, n in number.items():
        yield f"{n}, " + ", ".join(f"{x:g}" for x in place(node))
    yield "*ELEMENT, TYPE=C3D20R, ELSET=FLEXURE"
    pushed = []
    for e, cell in enumerate(grid, 1):
        names = [str(number[node]) for node in cell]
        yield f"{e}, " + ", ".join(names[:10]) + ","
        yield ", ".join(names[10:])
        if cell[1][0] == 2 * (len(ACROSS) - 1) and cell[4][2] == 2 * (len(UP) - 1):
            pushed.append(e)
    yield from ("*ELSET, ELSET=PUSHED", ", ".join(map(str, pushed)))
    feet = [n for node, n in number.items() if node[2] == 0]
    side = [n for node, n in number.items() if place(node)[0] == ACROSS[-1] and place(node)[2] >= UP[-2]]
    sensor = [n for node, n in number.items() if place(node) == SENSOR]
    for name, nodes in ("FEET", feet), ("ACTUATOR", side), ("SENSOR", sensor):
        yield f"*NSET, NSET={name}"
        yield from (", ".join(map(str, nodes[i : i + 10])) for i in range(0, len(nodes), 10))
    yield from ("*MATERIAL, NAME=ALUMINIUM", "*ELASTIC", "70000., 0.33", "*DENSITY", "2.7E-9")
    yield "*SOLID SECTION, ELSET=FLEXURE, MATERIAL=ALUMINIUM"
    yield from ("*BOUNDARY", "FEET, 1, 3")


def run(lines: list[str], folder: Path) -> str:
    """What ccx prints into its .dat file, if anything."""
    (folder / "flexure.inp").write_text("\n".join(lines) + "\n")
    subprocess.run(["ccx", "flexure"], cwd=folder, check=True, stdout=subprocess.DEVNULL)
    table = folder / "flexure.dat"
    return table.read_text() if table.exists() else ""


def main() -> None:
    """The files, then the references."""
    deck = list(model())
    with tempfile.TemporaryDirectory() as scratch:
        run([*deck, *STORE], Path(scratch))
        for ending in ("inp", "sti", "mas", "dof"):
            shutil.copy(Path(scratch, f"flexure.{ending}"), HERE)
    with tempfile.TemporaryDirectory() as scratch:
        table = run([*deck, "*STEP", "*FREQUENCY", str(MODES), "*END STEP"], Path(scratch))
        squares = re.findall(r"^ +\d+ +(\S+E\S+) +\S+ +\S+ +\S+ *$", table, re.MULTILINE)[:MODES]
        print(*(f"{np.sqrt(float(s)) / (2 * np.pi):.4f} Hz" for s in squares), sep="\n")
    for name, (load, direction) in LOADS.items():
        with tempfile.TemporaryDirectory() as scratch:
            step = ["*STEP", "*STATIC", *load, "*NODE PRINT, NSET=SENSOR", "U", "*END STEP"]
            printed = run([*deck, *step], Path(scratch)).split()
            print(f"{name}: the sensor moves by {float(printed[-3 + direction]) / 1000:.6e} m")


if __name__ == "__main__":
    main()
