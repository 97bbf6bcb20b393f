"""Time from part file to FMU, and CalculiX's *FREQUENCY on the same mesh, in one run.

    python tests/benchmarks/offline.py [--finer 1.0 --finer 1.9] [--modes 20] [--repeat 1]

Meshes: the bracket, by models/bracket/make_mesh.py with smaller cells (needs gmsh: pip install ".[mesh]").
Both programs are whole processes that may use two threads; memory is the peak of the process. Without ccx on
the path its columns stay empty.
"""

import argparse
import os
import re
import runpy
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from precompute.part import read_part
from precompute.read_mesh import read_mesh

MODELS = Path(__file__).resolve().parents[2] / "models"
BUILD = """
import sys, time
from pathlib import Path
from precompute.part import read_part
from precompute.pipeline import package, reduce_part
marks = []
def progress(stage, fraction):
    name = stage.split(":")[0]
    if not marks or marks[-1][0] != name:
        marks.append((name, time.perf_counter()))
reduction = reduce_part(read_part(Path(sys.argv[1])), progress)
package(reduction, Path(sys.argv[2]), progress)
marks.append(("end", time.perf_counter()))
for (stage, start), (_, end) in zip(marks, marks[1:]):
    print(f"  {stage}: {end - start:.2f} s")
print("solver =", reduction.modes.solver)
print("dofs =", reduction.dofs)
print("frequencies =", *(f"{f:.7g}" for f in reduction.model.frequency[:3]))
"""
HEAD = "     DOF  modalfmu/s  peak/MB  assembly/s  solver                 ccx/s  ccx/modalfmu"


def main() -> None:
    """Measure each mesh and print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--finer", type=float, action="append", help="how many times smaller the cells are")
    parser.add_argument("--modes", type=int, default=20)
    parser.add_argument("--repeat", type=int, default=1, help="runs of each; the fastest counts")
    parser.add_argument("--no-ccx", action="store_true", help="leave CalculiX out")
    options = parser.parse_args()
    rows = []
    for finer in options.finer or [1.0]:
        with tempfile.TemporaryDirectory() as folder:
            rows.append(measure(Path(folder), finer, options.modes, options.repeat, not options.no_ccx))
    print("", HEAD, *rows, sep="\n")


def measure(folder: Path, finer: float, modes: int, repeat: int, with_ccx: bool) -> str:
    """One row of the table."""
    runpy.run_path(str(MODELS / "bracket" / "make_mesh.py"))["main"](folder / "bracket.msh", finer)
    text = (MODELS / "bracket" / "part.toml").read_text()
    (folder / "part.toml").write_text(re.sub(r"^count = \d+", f"count = {modes}", text, flags=re.M))
    command = [sys.executable, "-c", BUILD, "part.toml", "bracket.fmu"]
    seconds, peak, output = fastest(command, folder, repeat)
    print(output, end="", flush=True)
    said = dict(re.findall(r"^(\w+) = (.*)$", output, flags=re.M))
    assembly = sum(float(s) for s in re.findall(r"  assembling.*: (.*) s", output))
    row = f"{said['dofs']:>8} {seconds:11.1f} {peak:8.0f} {assembly:11.1f}  {said['solver']:20}"
    if with_ccx and shutil.which("ccx"):
        part = read_part(folder)
        lines = runpy.run_path(str(MODELS / "calculix.py"))["deck"](part, read_mesh(part.mesh, "mm"), modes)
        (folder / "job.inp").write_text("\n".join(line for line in lines if line) + "\n")
        theirs, _, _ = fastest(["ccx", "job"], folder, repeat)
        found = re.findall(r"^ +\d+ +\S+ +\S+ +(\S+) +\S+ *$", (folder / "job.dat").read_text(), flags=re.M)
        print("ccx frequencies =", *(f"{float(f):.7g}" for f in found[:3]), flush=True)
        row += f" {theirs:7.1f} {theirs / seconds:13.1f}"
    return row


def fastest(command: list[str], folder: Path, repeat: int) -> tuple[float, float, str]:
    """Wall seconds, peak memory in MB and output of the fastest of some runs."""
    return min((run(command, folder) for _ in range(repeat)), key=lambda result: result[0])


def run(command: list[str], folder: Path) -> tuple[float, float, str]:
    """The same of one run with two threads."""
    threads = dict.fromkeys(("OMP_NUM_THREADS", "MKL_NUM_THREADS", "CCX_NPROC_EQUATION_SOLVER"), "2")
    start = time.perf_counter()
    process = subprocess.Popen(
        command, cwd=folder, env={**os.environ, **threads}, stdout=subprocess.PIPE, text=True
    )
    output = process.stdout.read() if process.stdout else ""
    _, status, usage = os.wait4(process.pid, 0)
    if status:
        raise SystemExit(f"{' '.join(command[:2])} failed:\n{output[-2000:]}")
    return time.perf_counter() - start, usage.ru_maxrss / 1024, output


if __name__ == "__main__":
    main()
