"""The outcome of a simulation in a few lines."""

from rich import box
from rich.table import Table

from .simulation import Simulation


def summary(simulation: Simulation) -> Table:
    """One row per output: its unit, its last, smallest and largest value."""
    face, result = simulation.face, simulation.result
    end = simulation.time[-1]
    table = Table(
        title=f"{face.description.modelName}: {len(result) - 1} steps to {end:.6g} s",
        title_justify="left",
        box=box.SIMPLE,
    )
    table.add_column("output")
    table.add_column("unit")
    for heading in ("final", "minimum", "maximum"):
        table.add_column(heading, justify="right")
    for name in face.outputs:
        y = result[name]
        table.add_row(name, face.unit(name), *(f"{x:.6g}" for x in (y[-1], y.min(), y.max())))
    return table
