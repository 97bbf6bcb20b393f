"""The modes of a part as a table to read and as an object to compute with."""

from typing import Any

import numpy as np
from rich import box
from rich.table import Table

from .arrays import Floats
from .pipeline import Reduction


def hertz(f: float) -> str:
    """A frequency to two decimals, or four digits where it is low."""
    return f"{f:.2f}" if f >= 10 else f"{f:.4g}"


def mode_table(reduction: Reduction) -> Table:
    """One row per mode: frequency in Hz, damping ratio ζ, share of the part's mass in x, y and z, dominance.

    The last row says how much of the mass all modes together capture. Dominance is the mode's peak between
    the ports, relative to the highest.
    """
    model = reduction.model
    share = 100 * reduction.effective_mass / reduction.total_mass
    table = Table(
        title=f"{model.name}: {model.r} modes, {reduction.total_mass:.4g} kg",
        title_justify="left",
        box=box.SIMPLE,
        show_footer=True,
    )
    table.add_column("mode", "sum", justify="right")
    table.add_column("frequency / Hz", justify="right")
    table.add_column("damping ratio", justify="right")
    for axis, captured in zip("xyz", share.sum(axis=1), strict=True):
        table.add_column(f"mass in {axis} / %", f"{captured:.1f}", justify="right")
    table.add_column("dominance / %", justify="right")
    for i, (f, zeta) in enumerate(zip(model.frequency, _ratios(reduction), strict=True)):
        frequency, ratio = ("rigid", "–") if zeta is None else (hertz(f), f"{zeta:.4g}")
        dominance = "–" if zeta is None else f"{100 * reduction.dominance[i]:.3g}"
        table.add_row(str(i + 1), frequency, ratio, *(f"{x:.1f}" for x in share[:, i]), dominance)
    return table


def mode_object(reduction: Reduction) -> dict[str, Any]:
    """The same for JSON: Hz, ζ (None for rigid modes), kg."""
    return {
        "frequencies": reduction.model.frequency.tolist(),
        "damping_ratios": _ratios(reduction),
        "rigid_body_modes": int(np.count_nonzero(reduction.model.frequency == 0)),
        "effective_mass": dict(zip("xyz", reduction.effective_mass.tolist(), strict=True)),
        "total_mass": reduction.total_mass,
        "dominance": [float(x) if x >= 0 else None for x in reduction.dominance],
        "dofs": reduction.dofs,
        "solver": reduction.modes.solver,
    }


def _ratios(reduction: Reduction) -> list[float | None]:
    model = reduction.model
    zeta: Floats = model.damping_ratio(model.alpha, model.beta)
    return [float(z) if f > 0 else None for z, f in zip(zeta, model.frequency, strict=True)]
