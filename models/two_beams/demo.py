"""Two beams, a spring between their tips: packaged as an SSP, run by FMPy, beside beam theory.

Run `python models/two_beams/demo.py [FOLDER]`: writes two_beams.ssp and beats.png to the folder (./out).
"""

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from fmpy.ssp.simulation import simulate_ssp
from fmpy.ssp.ssd import Parameter, ParameterSet
from rich.console import Console
from rich.table import Table
from theory import frequency

from precompute.cli import main as modalfmu

STOP, STEP = 2.0, 2e-4  # s
SPRING, FORCE = 1000.0, 10.0  # N/m, N: those of system.toml


def simulated(path: Path) -> np.ndarray:
    """What FMPy's master records; it leaves out the start values of an SSP, so they are told to it."""
    start = ParameterSet(parameters=[Parameter(name="left.push.force.z", type="Real", value=FORCE)])
    return simulate_ssp(str(path), stop_time=STOP, step_size=STEP, parameter_set=start)


def measured(t: np.ndarray, x: np.ndarray) -> float:
    """The frequency in Hz of a signal, by the times at which it rises through its mean."""
    x = x - x.mean()
    k = np.flatnonzero((x[:-1] < 0) & (x[1:] >= 0))
    rises = t[k] - x[k] * (t[k + 1] - t[k]) / (x[k + 1] - x[k])
    return float((len(rises) - 1) / (rises[-1] - rises[0]))


def main(folder: Path) -> None:
    """Package, simulate, compare."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "two_beams.ssp"
    if modalfmu(["ssp", str(Path(__file__).parent), "-o", str(path)]):
        sys.exit(2)
    result = simulated(path)
    t = result["time"]
    left, right = (result[f"{name}.tip.displacement.z"] for name in ("left", "right"))
    together, against = measured(t, left + right), measured(t, left - right)
    table = Table(title="two_beams.ssp, simulated by FMPy, beside beam theory")
    for heading in ("", "FMUs", "theory", "unit", "difference"):
        table.add_column(heading, justify="left" if heading in ("", "unit") else "right")
    for what, computed, theory, unit in (
        ("tips together", together, frequency(0.0), "Hz"),
        ("tips against each other", against, frequency(2 * SPRING), "Hz"),
        ("beat", 1 / (against - together), 1 / (frequency(2 * SPRING) - frequency(0.0)), "s"),
    ):
        table.add_row(what, f"{computed:.4f}", f"{theory:.4f}", unit, f"{computed / theory - 1:+.2%}")
    Console().print(table)
    figure, axes = plt.subplots(2, figsize=(8, 4), sharex=True, layout="constrained")
    for one, name, x in zip(axes, ("left", "right"), (left, right), strict=True):
        one.plot(t, 1e3 * x, linewidth=0.8)
        one.set(ylabel=f"{name} tip / mm", xlim=(0.0, STOP))
    axes[0].set_title(f"A force of {FORCE:g} N from t = 0 on the left beam; a spring between the tips")
    axes[1].set(xlabel="t / s")
    figure.savefig(folder / "beats.png", dpi=90)
    print(f"written: {path} and {folder / 'beats.png'}")


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "out"))
