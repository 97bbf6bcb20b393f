"""The command that runs an FMU: simulate."""

import math
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from .console import progress, show
from .errors import ModalFmuError
from .output_file import check_ending

# FMPy and matplotlib are imported when the command runs: they take a second, and --help needs neither.


def simulate(
    fmu: Path,
    /,
    *,
    input_: Annotated[Path | None, Parameter(name="--input")] = None,
    output: Path | None = None,
    plot: Path | None = None,
    vtu: Path | None = None,
    stop_time: float | None = None,
    step: float | None = None,
    settings: Annotated[
        tuple[str, ...], Parameter(name="--set", negative="", consume_multiple=True, show_default=False)
    ] = (),
    scale: float = 1.0,
) -> None:
    """Run an FMU with FMPy and show what its outputs did.

    Example:

        modalfmu simulate cantilever.fmu --set tip.force.z=10 --plot tip.png

    Parameters
    ----------
    fmu
        Any FMI 2.0 co-simulation FMU.
    input_
        CSV with a header such as time,tip.force.z; linear in between, two rows of one time are a jump.
    output
        CSV of all outputs over time.
    plot
        Inputs and outputs over time, one panel per unit: .png, .pdf or .svg.
    vtu
        The deformed shape over time for ParaView: NAME.pvd with numbered .vtu files beside it.
    stop_time
        End of the simulation in s. Left out: the one that the FMU suggests.
    step
        Step size in s. Left out: the one that the FMU suggests.
    settings
        Values of inputs and parameters, as name=value.
    scale
        The deformation is drawn this many times larger.
    """
    from .deformed_series import write_series
    from .fmu_face import read_face, read_settings
    from .notice import notice
    from .plot import write_plot
    from .shape import read_shape
    from .signals import read_signals
    from .simulation import simulate as run
    from .simulation_report import summary
    from .trajectory import write_trajectory

    face = read_face(fmu)
    values = read_settings(settings, face)
    signals = None if input_ is None else read_signals(input_, face)
    for option, path, endings in (
        ("--output", output, (".csv",)),
        ("--plot", plot, (".png", ".pdf", ".svg")),
        ("--vtu", vtu, (".pvd", ".vtu")),
    ):
        if path is not None:
            check_ending(option, path, *endings)
    if not math.isfinite(scale):
        raise ModalFmuError(f"--scale: got {scale}, expected a finite number")
    shape = None if vtu is None else read_shape(fmu)
    with progress() as tell:
        simulation = run(face, signals, values, stop_time, step, record_modes=vtu is not None, progress=tell)
        written = []
        if output is not None:
            written.append(write_trajectory(output, simulation))
        if plot is not None:
            tell("plotting", None)
            written.append(write_plot(plot, simulation))
        if vtu is not None and shape is not None:
            tell("writing the deformed shape", None)
            written.append(write_series(vtu, shape, simulation.time, simulation.q, scale))
    if signals is None and face.inputs and not {*values} & {*face.inputs, *face.motions}:
        example = f"--set {face.inputs[0]}=1"
        notice(f"no input was given, all keep their start values; add {example}, or --input FILE.csv")
    show(summary(simulation), *(f"{path} written" for path in written))
