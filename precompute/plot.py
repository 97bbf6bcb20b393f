"""Inputs and outputs of a simulation over time, one panel per unit."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from matplotlib.figure import Figure

from .output_file import replacing
from .simulation import Simulation

PANEL = (9.0, 2.4)  # inches
COLOURS = 10  # of matplotlib's cycle; more curves than that change their dashes
DASHES = ("-", "--", ":", "-.")


@dataclass(frozen=True)
class Panel:
    """Curves of one unit; `held`: constant over each step, as inputs are."""

    label: str
    names: Sequence[str]
    held: bool


def write_plot(path: Path, simulation: Simulation) -> Path:
    """A .png file (or what else matplotlib knows by the ending: .pdf, .svg); gives its path."""
    with replacing(path) as aside:
        figure(simulation).savefig(aside, dpi=130)
    return path


def figure(simulation: Simulation) -> Figure:
    """Panels of inputs, then of outputs, under one time axis in s."""
    shown = panels(simulation)
    figure = Figure(figsize=(PANEL[0], PANEL[1] * len(shown) + 0.6), layout="constrained")
    all_axes = figure.subplots(len(shown), 1, sharex=True, squeeze=False)[:, 0]
    for axes, panel in zip(all_axes, shown, strict=True):
        for i, name in enumerate(panel.names):
            axes.plot(
                simulation.time,
                simulation.result[name],
                label=name,
                color=f"C{i % COLOURS}",
                linestyle=DASHES[i // COLOURS % len(DASHES)],
                linewidth=1.2,
                # recorded at the end of the step over which it was held
                drawstyle="steps-pre" if panel.held else "default",
            )
        axes.set_ylabel(panel.label)
        axes.ticklabel_format(axis="both", scilimits=(-3, 4), useMathText=True)
        axes.grid(alpha=0.3)
        axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.02), fontsize="small", frameon=False)
    figure.align_ylabels(all_axes)
    all_axes[-1].set_xlabel("time / s")
    all_axes[-1].set_xlim(simulation.time[0], simulation.time[-1])
    description = simulation.face.description
    figure.suptitle(": ".join(filter(None, (description.modelName, description.description))))
    return figure


def panels(simulation: Simulation) -> list[Panel]:
    """Inputs that act (all, if none does) and outputs, by unit and in the FMU's order."""
    face = simulation.face
    acting = [name for name in face.inputs if simulation.result[name].any()] or face.inputs
    found = []
    for names, held in ((acting, True), (face.outputs, False)):
        by_unit: dict[str, list[str]] = {}
        for name in names:
            by_unit.setdefault(face.unit(name), []).append(name)
        found += [Panel(_label(group, unit), group, held) for unit, group in by_unit.items()]
    return found


def _label(names: Sequence[str], unit: str) -> str:
    """ "force / N": the quantity where all names, port.quantity.direction, agree on it."""
    kinds = {tuple(name.split(".")[-2:-1]) for name in names}
    kind = kinds.pop() if len(kinds) == 1 else ()
    return " / ".join([*kind, unit.replace("s2", "s²")] if unit else kind)
