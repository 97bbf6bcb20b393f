"""The commands that read a part or its mesh: build, modes, inspect."""

import json
import time
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

from .console import progress, show
from .output_file import check_ending, check_writable, fmu_path

# The stages are imported by the commands that run them: finite elements and meshio take a second to load,
# and --help needs none of them.

LengthUnit = Literal["m", "mm", "cm", "um", "in", "ft"]


def build(
    part: Path,
    /,
    *,
    output: Annotated[Path | None, Parameter(name=["--output", "-o"])] = None,
    runtime: Literal["native", "python"] = "native",
    platform: str | None = None,
    certificate: bool = True,
) -> None:
    """Build the FMU of a part; show its modes and what the reduction costs in accuracy.

    Example:

        modalfmu build models/cantilever -o cantilever.fmu

    Parameters
    ----------
    part
        A part file, or a folder with a part.toml.
    output
        The FMU, or a folder for it. Left out: NAME.fmu in the current folder.
    runtime
        What runs inside the FMU. "native": a library that needs nothing where the FMU runs. "python": the
        same equations in Python, which needs Python and numpy there.
    platform
        Where the native FMU runs: linux64, win64, darwin64, aarch64-linux, several with commas, or all.
        Left out: this machine's, and all others whose libraries are there already. After
        `pip install "modalfmu[cross]"` the others are compiled when they are first asked for.
    certificate
        Compare the frequency responses of the reduced model with those of the full one. The result is shown
        and goes into the FMU (documentation/accuracy.html); it takes about as long as the modes.
    """
    from .certificate_report import certificate_lines, certificate_table
    from .mode_report import mode_table
    from .part import read_part
    from .pipeline import package, reduce_part
    from .runtimes import choose_runtime

    started = time.monotonic()
    described = read_part(part)
    path = fmu_path(described.name, output)
    check_writable(path)
    with progress() as tell:
        inside = choose_runtime(runtime, platform, tell)
        reduction = reduce_part(described, tell, certified=certificate)
        package(reduction, path, tell, inside.build)
    found = reduction.certificate
    show(mode_table(reduction))
    if found is not None:
        show(certificate_table(found), *certificate_lines(found), "")
    show(
        f"{path}: {path.stat().st_size / 1e6:.2f} MB, {runtime} runtime ({', '.join(inside.platforms)}), "
        f"{reduction.dofs} degrees of freedom → {reduction.model.r} modes, {reduction.modes.solver}, "
        f"{time.monotonic() - started:.1f} s",
    )


def modes(
    part: Path,
    /,
    *,
    as_json: Annotated[bool, Parameter(name="--json", negative="")] = False,
    vtu: Path | None = None,
) -> None:
    """Compute the modes of a part: frequencies, damping ratios, effective masses.

    Example:

        modalfmu modes models/tuning_fork --vtu fork.vtu

    Parameters
    ----------
    part
        A part file, or a folder with a part.toml.
    as_json
        Write one JSON object on stdout and nothing else.
    vtu
        A .vtu file for ParaView: the mesh in m with one displacement field per mode, each scaled so that its
        largest displacement is 5 % of the mesh's diagonal (Warp By Vector with scale factor 1).
    """
    from .mode_report import mode_object, mode_table
    from .mode_shapes import write_mode_shapes
    from .part import read_part
    from .pipeline import reduce_part

    described = read_part(part)
    if vtu is not None:
        check_ending("--vtu", vtu, ".vtu")
    with progress() as tell:
        reduction = reduce_part(described, tell)
        if vtu is not None:
            tell("writing the mode shapes", None)
            write_mode_shapes(vtu, reduction)
    if as_json:
        print(json.dumps(mode_object(reduction), indent=2, allow_nan=False))
    else:
        show(mode_table(reduction), f"{reduction.dofs} degrees of freedom, {reduction.modes.solver}")


def inspect(mesh: Path, /, *, length_unit: LengthUnit | None = None) -> None:
    """Say what one needs of a mesh in order to write a part file for it.

    Example:

        modalfmu inspect bracket.msh --length-unit mm

    Parameters
    ----------
    mesh
        A mesh file: .msh, .inp, .bdf, .nas, .dat, .fem, .vtu or .vtk.
    length_unit
        The unit of its coordinates, where it is known.
    """
    from .inspection import inspection
    from .read_mesh import read_mesh

    with progress() as tell:
        tell("reading the mesh", None)
        read = read_mesh(mesh, length_unit or "m")
    show(*inspection(read, mesh, length_unit))
