"""Speed of the native FMU: every table is made in one run, ratios by turns in small batches, medians of them.

    python tests/benchmarks/native.py [--quick]

Needs a machine to itself for figures worth keeping. The drivers in C are compiled as the libraries are.
"""

import argparse
import os
import platform
import tempfile
from pathlib import Path

from integrators import ACCURACY, OMEGA, by_cvode, exact, in_steps
from parts import MODELS, part, run, unpacked
from python_twins import compare

from fmu_src.native_library import native_libraries
from fmu_src.toolchain import PLATFORMS
from precompute.part import read_part
from precompute.pipeline import reduce_part

LARGE, SMALL, LOADED = (50, 30, 300), (20, 3, 3), (200, 30, 300)  # modes, inputs, outputs
SIZES = ((10, 3, 3), SMALL, (50, 3, 30), (100, 3, 30), LARGE, (100, 30, 300), LOADED)


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--quick", action="store_true", help="a tenth of the repetitions")
    scale = 10 if parser.parse_args().quick else 1
    print(f"{platform.machine()}, {os.cpu_count()} processors, load {os.getloadavg()[0]:.1f} at the start")
    with tempfile.TemporaryDirectory() as folder:
        scratch = Path(folder)
        cycles(scratch, 3000 // scale)
        against_python(scratch, 200 // scale)
        single_steps(scratch, 1_000_000 // scale)
        coupled_steps(scratch, 100_000 // scale)
        instruction_sets(scratch, 2000 // scale)
        integration(scratch)
        sizes(scratch)


def cycles(scratch: Path, batches: int) -> None:
    """From C: set, step, get."""
    head("set + step + get from C, and the bare B u, update, C q by the same kernels", "ns a cycle, medians")
    print("modes  inputs  outputs  read      FMU     bare  FMU/bare  ps per modes*(inputs+read)")
    for size in SIZES:
        native = unpacked(part(*size), scratch)
        for read in (0, 3, 30, 300) if size == LARGE else (size[2],):
            resources = native.folder / "resources"
            found = run("cycle", scratch, *native.arguments, resources, read, batches)
            if found["difference"] > 0.0:
                raise RuntimeError("the bare loops compute something else")
            each = 1e3 * found["fmu"] / (size[0] * (size[1] + read))
            row = "{:5} {:7} {:8} {:5}".format(*size, read)
            print(f"{row} {found['fmu']:8.0f} {found['bare']:8.0f} {found['ratio']:9.2f} {each:11.0f}")


def against_python(scratch: Path, batches: int) -> None:
    """One ctypes driver."""
    head("set + step + get by one ctypes driver", "us a cycle, medians")
    print("modes  inputs  outputs   native  Python twin  getters  ctypes alone  twin/native  getters/native")
    for size in (LARGE, SMALL):
        t = compare(unpacked(part(*size), scratch), scratch, batches)
        row = "{:5} {:7} {:8}".format(*size)
        print(
            f"{row} {t['native']:8.2f} {t['twin']:12.2f} {t['getters']:8.2f} {t['empty']:13.2f}"
            f" {t['twin ratio']:12.1f} {t['getters ratio']:15.1f}"
        )


def single_steps(scratch: Path, steps: int) -> None:
    """fmi2DoStep one by one, and loading."""
    head(f"fmi2DoStep alone, {steps} steps of one size, the clock's own cost in them", "ns; load in ms")
    print("modes  inputs  outputs   median    p99.9    maximum  new size  clock  load/ms")
    for size in (SMALL, LARGE, LOADED):
        native = unpacked(part(*size), scratch)
        t = run("steps", scratch, *native.arguments, size[1], steps, 30)
        row = "{:5} {:7} {:8}".format(*size)
        print(
            f"{row} {t['median']:8.0f} {t['p999']:8.0f} {t['maximum']:10.0f} {t['new']:9.0f}"
            f" {t['clock']:6.0f} {t['load'] / 1e6:8.2f}"
        )


def coupled_steps(scratch: Path, steps: int) -> None:
    """All modes joined by a dashpot, against the same part without it."""
    head("the same, all modes coupled by a dashpot, 3 inputs", "ns; in brackets: coupled/alone")
    print("modes   median          new size")
    for modes in (5, 20, 50, 100):
        together, alone = (
            run("steps", scratch, *unpacked(part(modes, 3, 3, coupled), scratch).arguments, 3, steps, 1)
            for coupled in (modes, 0)
        )
        texts = (f"{together[k]:10.0f} ({together[k] / alone[k]:.0f})" for k in ("median", "new"))
        print(f"{modes:5}", *texts)


def instruction_sets(scratch: Path, batches: int) -> None:
    """The kernels alone."""
    head("kernels by instruction set", "ns a cycle, medians; in brackets: baseline/this")
    for size in (SMALL, LARGE, LOADED):
        found = run("instructions", scratch, *size, batches)
        texts = (f"{name} {t:.0f} ({found['baseline'] / t:.1f})" for name, t in found.items())
        print("{:5} {:7} {:8}   ".format(*size), "   ".join(texts))


def integration(scratch: Path) -> None:
    """The cantilever under a sinusoidal force."""
    native = unpacked(reduce_part(read_part(MODELS / "cantilever")).model, scratch)
    force = f"sin({OMEGA:.1f} t) N at tip, y, for 1 s from rest"
    head(f"cantilever, 20 modes, {force}; error below {ACCURACY:g} of the peak", "steps; us")
    reference = exact(native.model)
    efforts = [in_steps(native, scratch, method, reference) for method in ("fmu", "newmark")]
    efforts.append(by_cvode(native, reference))
    print("method      steps         us    error  steps/FMU  time/FMU")
    for e in efforts:
        by_steps, by_time = e.steps / efforts[0].steps, e.nanoseconds / efforts[0].nanoseconds
        row = f"{e.method:8} {e.steps:8} {e.nanoseconds / 1e3:9.0f} {e.error:8.1e}"
        print(f"{row} {by_steps:10.1f} {by_time:9.1f}")
    print("fmu: through FMI with the first two derivatives of the force; newmark: average acceleration in C,")
    print("no FMI; CVode: FMPy, BDF, the right-hand side through Python, so its time holds that cost.")


def sizes(scratch: Path) -> None:
    """Of libraries and an FMU."""
    head("sizes", "kB")
    libraries = native_libraries()
    for name in PLATFORMS:
        if name in libraries:
            print(f"library {name:14} {libraries[name].stat().st_size / 1e3:8.0f}")
    for size in (SMALL, LARGE):
        fmu = unpacked(part(*size), scratch).fmu
        print("FMU, {} modes, {} inputs, {} outputs:".format(*size), f"{fmu.stat().st_size / 1e3:.0f}")


def head(title: str, unit: str) -> None:
    print(f"\n{title} [{unit}]", flush=True)


if __name__ == "__main__":
    main()
