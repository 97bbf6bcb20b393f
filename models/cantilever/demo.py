"""From a part file to an FMU, and what the FMU computes beside what beam theory says.

Run `python models/cantilever/demo.py [FOLDER]`: writes cantilever.fmu and response.png to the folder (./out).
"""

import logging
import sys
from math import pi, sqrt
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from fmpy import read_model_description, simulate_fmu
from rich.console import Console
from rich.table import Table
from theory import Beam, overshoot

from precompute.part import read_part
from precompute.pipeline import Reduction, package, reduce_part

FORCE = 10.0  # N, upwards at the tip from t = 0
STEP, STOP = 5e-4, 4.0  # s
DEFLECTION = "tip.displacement.z"
SHAPES = ["z bending 1", "y bending 1", "z bending 2", "y bending 2", "z bending 3", "y bending 3"]


def beam_of(reduction: Reduction) -> Beam:
    """The part as theory sees it."""
    low, high = reduction.full.nodes.points.min(axis=0), reduction.full.nodes.points.max(axis=0)
    steel = reduction.part.materials[0]
    return Beam(*(high - low), steel.young, steel.poisson, steel.density)


def respond(fmu: Path) -> tuple[np.ndarray, np.ndarray]:
    """t and the tip's deflection under a step of force, by FMPy."""
    result = simulate_fmu(
        str(fmu),
        stop_time=STOP,
        step_size=STEP,
        output_interval=STEP,
        start_values={"tip.force.z": FORCE},
        output=[DEFLECTION],
    )
    return result["time"], result[DEFLECTION]


def measure(t: np.ndarray, u: np.ndarray, f: float) -> tuple[float, float, float]:
    """Static deflection, largest deflection, and damping ratio by logarithmic decrement, of a step response.

    The mean over whole periods 1/f at the end is the static deflection; the peaks of the first mode
    fall by e^{−2πζ/√(1−ζ²)} each period; the higher modes have died down after four of them.
    """
    static = float(u[t > t[-1] - 10 / f].mean())
    periods = [u[(t > k / f) & (t <= (k + 1) / f)].max() - static for k in (4, 24)]
    decrement = float(np.log(periods[0] / periods[1])) / 20
    return static, float(u.max()), decrement / sqrt(4 * pi**2 + decrement**2)


def show(rows: list[tuple[str, float, float, str]]) -> None:
    """What, computed, theory, unit; and the difference."""
    table = Table(title="cantilever.fmu, simulated by FMPy, beside beam theory")
    for heading in ("", "FMU", "theory", "unit", "difference"):
        table.add_column(heading, justify="left" if heading in ("", "unit") else "right")
    for what, computed, theory, unit in rows:
        table.add_row(what, f"{computed:.4f}", f"{theory:.4f}", unit, f"{computed / theory - 1:+.2%}")
    Console().print(table)


def plot(t: np.ndarray, u: np.ndarray, static: float, peak: float, path: Path) -> None:
    """The response with theory's static and largest deflection (m)."""
    figure, axes = plt.subplots(figsize=(8, 4), layout="constrained")
    axes.plot(t, 1e3 * u, linewidth=0.9, label="FMU")
    axes.axhline(1e3 * static, color="C1", linestyle="--", label="static, Timoshenko")
    axes.axhline(1e3 * peak, color="C2", linestyle=":", label="largest, by one mode")
    axes.set(xlabel="t / s", ylabel="tip deflection / mm", xlim=(0.0, 2.0))
    axes.set_title(f"A force of {FORCE:g} N from t = 0 at the tip of the cantilever")
    axes.legend(loc="lower right")
    figure.savefig(path, dpi=120)


def main(folder: Path) -> None:
    """Build, simulate, compare."""
    reduction = reduce_part(read_part(Path(__file__).parent))
    beam = beam_of(reduction)
    folder.mkdir(parents=True, exist_ok=True)
    fmu = package(reduction, folder / "cantilever.fmu")
    t, u = respond(fmu)

    variables = {v.name: v for v in read_model_description(str(fmu)).modelVariables}
    frequencies = [float(variables[f"modes.frequency[{i}]"].start) for i in range(1, len(SHAPES) + 1)]
    reference = sorted(beam.timoshenko("z", 3) + beam.timoshenko("y", 3))
    zeta = float(reduction.model.damping_ratio(reduction.model.alpha, reduction.model.beta)[0])
    expected = beam.deflection("z", FORCE)
    largest = expected * overshoot(zeta)
    static, peak, ratio = measure(t, u, frequencies[0])
    show(
        [(s, f, r, "Hz") for s, f, r in zip(SHAPES, frequencies, reference, strict=True)]
        + [
            ("static deflection", 1e3 * static, 1e3 * expected, "mm"),
            ("largest deflection, by one mode", 1e3 * peak, 1e3 * largest, "mm"),
            ("damping ratio", 100 * ratio, 100 * zeta, "%"),
        ]
    )
    plot(t, u, expected, largest, folder / "response.png")
    print(f"written: {fmu} and {folder / 'response.png'}")


if __name__ == "__main__":
    logging.basicConfig(level="INFO", format="%(message)s")
    logging.getLogger("matplotlib").setLevel("WARNING")
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "out"))
