"""Time from part file to FMU, and CalculiX's *FREQUENCY on the same mesh, in one run.

    python tests/benchmarks/offline.py [--size 2.0] [--size 1.1] [--modes 20] [--ccx ccx] [--repeat 1]

Each size is a mesh of the bracket by models/bracket/make_mesh.py (needs gmsh: pip install ".[mesh]").
Both programs are whole processes with two threads; peak memory is that of the process. Prints a table with
the ratio of the times; without CalculiX on the path, its columns stay empty.
"""

import argparse
import os
import re
import resource
import runpy
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import meshio

BRACKET = Path(__file__).resolve().parents[2] / "models" / "bracket"
STAGES = """
import sys, time
from pathlib import Path
from precompute.part import read_part
from precompute.pipeline import reduce_part, package
marks = []
def progress(stage, fraction):
    if not marks or marks[-1][0] != stage:
        marks.append((stage, time.perf_counter()))
reduction = reduce_part(read_part(Path(sys.argv[1])), progress)
package(reduction, Path(sys.argv[2]), progress)
marks.append(("end", time.perf_counter()))
for (stage, start), (_, end) in zip(marks, marks[1:]):
    print(f"stage {stage}: {end - start:.2f} s")
print("dofs", reduction.dofs)
print("solver", reduction.modes.solver)
print("first", *(f"{f:.6g}" for f in reduction.model.frequency[:3]))
"""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--size", type=float, action="append", help="element size in mm; may be repeated")
    parser.add_argument("--modes", type=int, default=20)
    parser.add_argument("--ccx", default="ccx")
    parser.add_argument("--repeat", type=int, default=1, help="runs of each; the fastest is reported")
    options = parser.parse_args()
    make_mesh = runpy.run_path(str(BRACKET / "make_mesh.py"))["make_mesh"]
    rows = []
    for size in options.size or [make_mesh.__kwdefaults__["size"]]:
        with tempfile.TemporaryDirectory() as folder:
            rows.append(_measure(Path(folder), make_mesh, size, options))
    print("\n     DOF   modalfmu  peak     assembly  solver                      ccx     ccx/modalfmu")
    print("             s      MB        s                                   s")
    for row in rows:
        print(row)


def _measure(folder: Path, make_mesh: object, size: float, options: argparse.Namespace) -> str:
    make_mesh(folder / "bracket.msh", size=size)  # type: ignore[operator]  # a function of the script
    text = (BRACKET / "part.toml").read_text()
    (folder / "part.toml").write_text(re.sub(r"^count = \d+", f"count = {options.modes}", text, flags=re.M))
    ours, peak, output = min(
        (_run([sys.executable, "-c", STAGES, "part.toml", "out.fmu"], folder) for _ in range(options.repeat)),
        key=lambda run: run[0],
    )
    print(f"\n--- {size} mm\n{output}", end="")
    dofs = int(re.search(r"dofs (\d+)", output).group(1))  # type: ignore[union-attr]  # printed above
    solver = re.search(r"solver (.*)", output).group(1)  # type: ignore[union-attr]  # printed above
    assembly = sum(float(s) for s in re.findall(r"stage assembling.*: (.*) s", output))
    row = f"{dofs:8d} {ours:9.1f} {peak:7.0f} {assembly:9.1f}    {solver:25s}"
    if shutil.which(options.ccx):
        _write_deck(folder, options.modes)
        theirs, _, _ = min(
            (_run([options.ccx, "-i", "job"], folder) for _ in range(options.repeat)), key=lambda run: run[0]
        )
        print("ccx first:", *_first_frequencies(folder / "job.dat"))
        row += f" {theirs:7.1f} {theirs / ours:9.1f}"
    return row


def _run(command: list[str], folder: Path) -> tuple[float, float, str]:
    """Wall seconds, peak memory in MB and output of a process with two threads."""
    threads = dict.fromkeys(("OMP_NUM_THREADS", "MKL_NUM_THREADS", "CCX_NPROC_EQUATION_SOLVER"), "2")
    before = time.perf_counter()
    process = subprocess.Popen(
        command, cwd=folder, env={**os.environ, **threads}, stdout=subprocess.PIPE, text=True
    )
    assert process.stdout is not None
    output = process.stdout.read()
    _, status, usage = os.wait4(process.pid, 0)
    if status:
        raise SystemExit(f"{command[0]} failed:\n{output[-2000:]}")
    return time.perf_counter() - before, usage.ru_maxrss / 1024, output


def _write_deck(folder: Path, modes: int) -> None:
    """The same nodes, elements, support and material for CalculiX, in mm, t, s."""
    part = (folder / "part.toml").read_text()
    value = {
        key: float(re.search(rf"^{key} = (\S+)", part, flags=re.M).group(1))  # type: ignore[union-attr]
        for key in ("young", "poisson", "density")
    }
    mesh = meshio.read(folder / "bracket.msh")
    tets = mesh.cells_dict["tetra10"]
    clamp = re.search(r'at = "(\w+)"\s*\nfix = \["x", "y", "z"\]', part).group(1)  # type: ignore[union-attr]
    held = sorted({int(n) for cells in mesh.cell_sets_dict[clamp].items() for n in _nodes_of(mesh, cells)})
    with (folder / "job.inp").open("w") as deck:
        deck.write("*NODE, NSET=NALL\n")
        deck.writelines(f"{i},{x:.12g},{y:.12g},{z:.12g}\n" for i, (x, y, z) in enumerate(mesh.points, 1))
        deck.write("*ELEMENT, TYPE=C3D10, ELSET=EALL\n")
        deck.writelines(f"{i},{','.join(str(n + 1) for n in tet)}\n" for i, tet in enumerate(tets, 1))
        deck.write("*NSET, NSET=CLAMP\n" + "".join(f"{n + 1},\n" for n in held))
        deck.write(
            f"*MATERIAL, NAME=M\n*ELASTIC\n{value['young'] * 1e-6},{value['poisson']}\n"
            f"*DENSITY\n{value['density'] * 1e-12}\n*SOLID SECTION, ELSET=EALL, MATERIAL=M\n"
            f"*BOUNDARY\nCLAMP,1,3\n*STEP\n*FREQUENCY\n{modes}\n*END STEP\n"
        )


def _nodes_of(mesh: meshio.Mesh, cells: tuple[str, object]) -> set[int]:
    kind, rows = cells
    return {int(n) for n in mesh.cells_dict[kind][rows].ravel()}


def _first_frequencies(path: Path) -> list[str]:
    rows = re.findall(r"^ +\d+ +\S+ +\S+ +(\S+) +\S+ *$", path.read_text(), flags=re.M)
    return [f"{float(f):.6g}" for f in rows[:3]]


if __name__ == "__main__":
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    main()
