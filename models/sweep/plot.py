"""What the sweep found, drawn: python models/sweep/plot.py sweep.parquet FMU overshoot.png

The largest deflection of the tip over the damping of the first mode, for some levels of detail; dashed the
static deflection of beam theory times 1 + exp(−πζ/√(1 − ζ²)), the overshoot of one mode.
"""

import sys

import matplotlib.pyplot as plt
import numpy as np
import pyarrow.parquet as pq
from fmpy import read_model_description

ACTIVE = (2, 3, 5, 20)  # the second one moves in y
RATIO = 0.02  # of the part, to which damping.alpha adds α/2ω
STATIC = 79.389e-6  # m/N, Timoshenko; models/cantilever/README.md


def main(results: str, fmu: str, picture: str) -> None:
    """Draw the runs with the largest force."""
    start = {v.name: v.start for v in read_model_description(fmu).modelVariables}
    omega = 2 * np.pi * float(start["modes.frequency[1]"])
    rows = pq.read_table(results, columns=["damping.alpha", "modes.active", "tip.force.z", "peak"])
    alpha, active, force, peak = (column.to_numpy() for column in rows.columns)
    zeta = RATIO + alpha / (2 * omega)
    figure, axes = plt.subplots(figsize=(8, 4), layout="constrained")
    for r in ACTIVE:
        runs = (active == r) & (force == force.max())
        axes.plot(zeta[runs], 1e6 * peak[runs] / force[runs], marker="o", markersize=3, label=f"{r} modes")
    z = np.linspace(zeta.min(), zeta.max(), 100)
    theory = 1e6 * STATIC * (1 + np.exp(-np.pi * z / np.sqrt(1 - z**2)))
    axes.plot(z, theory, color="black", linestyle="--", linewidth=0.9, label="beam theory, one mode")
    axes.set(xlabel="damping ratio of the first mode", ylabel="largest deflection / force [µm/N]")
    axes.legend()
    figure.savefig(picture, dpi=110)


if __name__ == "__main__":
    main(*sys.argv[1:])
