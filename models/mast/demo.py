"""A shock of the base, and what the FMU says of the mast on it beside beam theory.

Run `python models/mast/demo.py [FOLDER]`: writes mast.fmu and shock.png to the folder (./out).
"""

import logging
import sys
from collections.abc import Sequence
from dataclasses import replace
from math import pi
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from fmpy import simulate_fmu
from rich.console import Console
from rich.table import Table
from theory import Mast

from precompute.part import read_part
from precompute.pipeline import Reduction, package, reduce_part

PEAK, DURATION, BEGIN = 50.0, 0.011, 0.01  # m/s², s, s: of a half sine, in x and y at once
STEP, STOP = 2.5e-4, 1.0  # s
OUTPUTS = [
    *("top.displacement.x", "top.displacement.y"),
    *("top.absolute_acceleration.x", "top.absolute_acceleration.y"),
    *("gauge.stress.zz", "foot.reaction.x", "foot.reaction.y"),
]
GAUGE, HALF_ANGLE = 0.25, pi / 8  # m: its middle; rad: its half width around the tube


def mast_of(reduction: Reduction) -> Mast:
    """The part as theory sees it when it moves in x; in y the stay is to be added."""
    points = reduction.full.nodes.points
    radii = np.hypot(points[:, 0], points[:, 1])
    part, model = reduction.part, reduction.model
    steel = part.materials[0]
    return Mast(
        *(np.ptp(points[:, 2]), radii.max(), radii.min()),
        *(steel.young, steel.poisson, steel.density),
        part.masses[0].mass,
        alpha=model.alpha,
        beta=model.beta,
    )


def stayed(mast: Mast, reduction: Reduction) -> Mast:
    """The mast as it moves in y."""
    part = reduction.part
    return replace(mast, stiffness=part.springs[0].stiffness, damping=part.dashpots[0].damping)


def half_sine(t: np.ndarray) -> np.ndarray:
    """The acceleration of the base, m/s²."""
    after = t - BEGIN  # the FMU stands still before
    return np.where((after > 0) & (after < DURATION), PEAK * np.sin(pi * after / DURATION), 0.0)


def simulated(fmu: Path, inputs: Sequence[str]) -> np.ndarray:
    """The outputs over time, by FMPy; what is held during a step is the shock in its middle."""
    t = np.arange(0.0, STOP + STEP, STEP)
    given = np.zeros(len(t), dtype=[(name, float) for name in ("time", *inputs)])
    given["time"] = t
    given["base.acceleration.x"] = given["base.acceleration.y"] = half_sine(t + STEP / 2)
    return simulate_fmu(
        str(fmu), stop_time=STOP, step_size=STEP, output_interval=STEP, input=given, output=OUTPUTS
    )


def expected(mast: Mast, other: Mast, t: np.ndarray) -> dict[str, np.ndarray]:
    """The same by beam theory, mast in x, other in y."""
    a = half_sine(t)
    found = {}
    for axis, beam in ("x", mast), ("y", other):
        section, acceleration = beam.shaken(t, a, beam.length)
        found[f"top.displacement.{axis}"] = section[0]
        found[f"top.absolute_acceleration.{axis}"] = acceleration
        found[f"foot.reaction.{axis}"] = -beam.shaken(t, a, 0.0)[0][3]
    found["gauge.stress.zz"] = mast.stress(mast.shaken(t, a, GAUGE)[0][2], HALF_ANGLE)
    return found


def show(result: np.ndarray, theory: dict[str, np.ndarray]) -> None:
    """Largest magnitudes."""
    table = Table(title="mast.fmu after a shock of its base, beside beam theory")
    for heading in ("largest", "FMU", "theory", "difference"):
        table.add_column(heading, justify="left" if heading == "largest" else "right")
    for name in OUTPUTS:
        computed, beam = np.abs(result[name]).max(), np.abs(theory[name]).max()
        table.add_row(name, f"{computed:.4g}", f"{beam:.4g}", f"{computed / beam - 1:+.2%}")
    Console().print(table)


def plot(result: np.ndarray, theory: dict[str, np.ndarray], path: Path) -> None:
    """The top's displacement and acceleration."""
    t = result["time"]
    figure, (upper, lower) = plt.subplots(2, 1, figsize=(8, 6), layout="constrained")
    for axis, words in ("x", "in x, free"), ("y", "in y, stayed"):
        for axes, name, scale in (
            (upper, f"top.displacement.{axis}", 1e3),
            (lower, f"top.absolute_acceleration.{axis}", 1.0),
        ):
            axes.plot(t, scale * result[name], linewidth=1.4, label=words)
            axes.plot(t, scale * theory[name], "k:", linewidth=1.0)
    lower.plot(t, half_sine(t), color="0.7", label="the base")
    lower.plot([], [], "k:", linewidth=1.0, label="beam theory")
    upper.set(ylabel="displacement against the base / mm", xlim=(0.0, 1.0))
    lower.set(ylabel="acceleration / (m/s²)", xlabel="t / s", xlim=(0.0, 0.15))
    upper.set_title(
        f"The top of the mast; its base gets a half sine of {PEAK:g} m/s² in {1e3 * DURATION:g} ms"
    )
    lower.legend(loc="upper center", ncols=4, fontsize="small", bbox_to_anchor=(0.5, 1.17), frameon=False)
    figure.savefig(path, dpi=100)


def main(folder: Path) -> None:
    """Build, shake, compare."""
    reduction = reduce_part(read_part(Path(__file__).parent))
    folder.mkdir(parents=True, exist_ok=True)
    fmu = package(reduction, folder / "mast.fmu")
    result = simulated(fmu, reduction.model.inputs)
    mast = mast_of(reduction)
    theory = expected(mast, stayed(mast, reduction), result["time"])
    show(result, theory)
    plot(result, theory, folder / "shock.png")
    print(f"written: {fmu} and {folder / 'shock.png'}")


if __name__ == "__main__":
    logging.basicConfig(level="INFO", format="%(message)s")
    logging.getLogger("matplotlib").setLevel("WARNING")
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path("out"))
