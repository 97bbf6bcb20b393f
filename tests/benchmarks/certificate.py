"""Cost of the certificate beside the cost of the modes, on brackets of several sizes, in one run.

    python tests/benchmarks/certificate.py [--finer 0.7 --finer 1.25 --finer 2.1] [--modes 20]

Meshes: models/bracket/make_mesh.py with smaller cells (needs gmsh: pip install ".[mesh]"). Two ports,
each with forces, displacements, velocities and accelerations in x, y, z.
"""

import argparse
import os
import runpy
import tempfile
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import numpy as np
from scipy.sparse import csc_array, csr_array

from fmu_src.runtime.model import Port
from precompute.accuracy import captured_mass, certify, default_band
from precompute.assembly import assemble
from precompute.certificate_report import certificate_lines
from precompute.damping import rayleigh
from precompute.eigen import solve_modes
from precompute.full_response import full_response
from precompute.interface import Interface
from precompute.known_modes import KnownModes
from precompute.material import CellMaterial
from precompute.mesh import Mesh
from precompute.mode_choice import FINER
from precompute.read_mesh import read_mesh
from precompute.reduction import reduce
from precompute.statics import static_solver

MAKE_MESH = Path(__file__).resolve().parents[2] / "models" / "bracket" / "make_mesh.py"
PORTS, SUPPORT = ("bearing", "load_face"), "bolts"
TOLERANCE = 0.01
KINDS = ("displacement", "velocity", "acceleration")
HEAD = "     DOF   modes/s  factor/s  responses/s  comparison/s  certificate/modes  Krylov vectors  proved to"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--finer", type=float, action="append", help="how many times smaller the cells are")
    parser.add_argument("--modes", type=int, default=20)
    options = parser.parse_args()
    print(f"{os.cpu_count()} processors, load {os.getloadavg()[0]:.1f} at the start")
    rows = [measure(finer, options.modes) for finer in options.finer or [0.7, 1.25, 2.1]]
    print("", HEAD, *rows, sep="\n")


def measure(finer: float, count: int) -> str:
    """One row of the table."""
    with tempfile.TemporaryDirectory() as folder:
        runpy.run_path(str(MAKE_MESH))["main"](Path(folder) / "bracket.msh", finer)
        mesh = read_mesh(Path(folder) / "bracket.msh", "mm")
    cells = {family: np.arange(len(nodes)) for family, nodes in mesh.cells.items()}
    system = assemble(mesh, [CellMaterial("aluminium", 70e9, 0.33, 2700.0, cells)])
    fixed = (3 * mesh.node_sets[SUPPORT][:, None] + np.arange(3)).ravel()
    between = interface(mesh)
    with timed() as modes_time:
        modes = solve_modes(system, fixed, count=count)
    damping = rayleigh(modes.lam, 30.0, 1e-7)
    known, band = KnownModes(modes.lam, modes.Phi, damping.D_rest), default_band(modes.frequencies)
    if band is None:
        raise RuntimeError("no elastic mode")
    model = reduce("bracket", "", modes.lam, modes.Phi, damping, between)
    with ExitStack() as stack:
        with timed() as factor_time:
            solve = stack.enter_context(static_solver(system, fixed))
        with timed() as response_time:
            reference = full_response(solve, known, damping, between, band, FINER * TOLERANCE)
        with timed() as comparison_time:
            certificate = certify(reference, model, captured_mass(system, modes.Phi), TOLERANCE)
    print(*certificate_lines(certificate), sep="\n")
    costs = [times[0] for times in (modes_time, factor_time, response_time, comparison_time)]
    return (
        "{:8d} {:9.2f} {:9.2f} {:12.2f} {:13.2f}".format(system.K.shape[0] - len(fixed), *costs)
        + f" {sum(costs[1:]) / costs[0]:18.2f} {certificate.vectors:15d} {certificate.proved_to:7.0f} Hz"
    )


def interface(mesh: Mesh) -> Interface:
    """Forces and motions of the ports' nodes, equally weighted, in x, y, z."""
    n = 3 * len(mesh.points)
    motions = []
    for name in PORTS:
        nodes = mesh.node_sets[name]
        for axis in range(3):
            motion = np.zeros(n)
            motion[3 * nodes + axis] = 1 / len(nodes)
            motions.append(motion)
    outputs = tuple(f"{kind}.{axis}" for kind in KINDS for axis in "xyz")
    ports = tuple(Port(name, ("force.x", "force.y", "force.z"), outputs) for name in PORTS)
    rows = np.concatenate([np.tile(motions[:3], (3, 1)), np.tile(motions[3:], (3, 1))])
    return Interface(ports, csc_array(np.array(motions).T), csr_array(rows), np.zeros((18, 6)))


@contextmanager
def timed() -> Iterator[list[float]]:
    """The seconds that a block takes, in a list that is filled at its end."""
    taken: list[float] = []
    start = time.perf_counter()
    yield taken
    taken.append(time.perf_counter() - start)


if __name__ == "__main__":
    main()
