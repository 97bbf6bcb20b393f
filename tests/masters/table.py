"""What the masters do on a system, measured, as the table and the picture of its README."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from math import log2

import numpy as np
from extrapolation import ORDER, Kind
from fixed_point import NotConverged, fixed_point
from gauss_seidel import gauss_seidel
from interface_newton import interface_newton
from jacobi import jacobi
from markdown import largest
from matplotlib.axes import Axes
from run import Step


@dataclass(frozen=True)
class Algorithm:
    """A master with its name, the kind of its inputs and the order that it must have."""

    name: str
    kind: Kind
    order: int
    step: Callable[[], Step]


@dataclass(frozen=True)
class Row:
    """Measured: errors, of the peak, at step sizes h in s, each half of the one before; NaN: not converged.

    stable: the largest stable step in s; drift: of the energy, relative.
    """

    algorithm: Algorithm
    h: Sequence[float]
    errors: Sequence[float]
    stable: float
    drift: float

    @property
    def order(self) -> float:
        """log₂ of the last two errors' quotient."""
        return log2(self.errors[-2] / self.errors[-1])


def algorithms() -> list[Algorithm]:
    """Every master that any system can have: four ways to couple, three kinds of inputs."""
    ways = {
        "Jacobi": jacobi,
        "Gauss–Seidel": gauss_seidel,
        "fixed point": fixed_point,
        "interface Newton": interface_newton,
    }
    return [
        Algorithm(f"{name}, {kind}", kind, ORDER[kind], lambda make=make, kind=kind: make(kind))
        for name, make in ways.items()
        for kind in ORDER
    ]


def errors(found: Callable[[float, int], float], end: float, counts: Iterable[int]) -> list[float]:
    """found(h, count) for every count of steps to `end`; NaN where the iteration does not converge."""

    def one(count: int) -> float:
        try:
            return found(end / count, count)
        except NotConverged:
            return np.nan

    return [one(count) for count in counts]


def cells(row: Row) -> dict[str, str]:
    """A line of the README's table."""
    return {
        "master": row.algorithm.name,
        f"error, h = {1e3 * row.h[-1]:g} ms": f"{row.errors[-1]:.1e}",
        "order": f"{row.order:.2f}",
        "expected": f"{row.algorithm.order}",
        "largest stable h / ms": largest(row.stable, 1e-3),
        "energy drift": f"{row.drift:.1e}",
    }


def draw_errors(axes: Axes, rows: Sequence[Row]) -> None:
    """Errors over step sizes; a colour for each way to couple, a dash for each kind of inputs."""
    dashes = {"hold": "-", "linear": "--", "derivative": ":"}
    ways = list(dict.fromkeys(row.algorithm.name.split(",")[0] for row in rows))
    for row in rows:
        colour = f"C{ways.index(row.algorithm.name.split(',')[0])}"
        axes.loglog(
            1e3 * np.array(row.h),
            row.errors,
            dashes[row.algorithm.kind],
            color=colour,
            label=row.algorithm.name,
            linewidth=1.2,
        )
    axes.set(xlabel="h / ms", ylabel="largest error / peak")
    ticks = [1e3 * h for h in rows[0].h]
    axes.set_xticks(ticks, [f"{h:g}" for h in ticks])
    axes.minorticks_off()
    axes.grid(alpha=0.3)
