"""The command that packages a system of FMUs: ssp."""

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from .console import progress, show
from .output_file import check_writable, output_path

# The stages are imported when the command runs: they take a second to load, and --help needs none of them.


def ssp(
    system: Path,
    /,
    *,
    output: Annotated[Path | None, Parameter(name=["--output", "-o"])] = None,
    platform: str | None = None,
    certificate: bool = True,
) -> None:
    """Package several parts, other FMUs and their connections as an SSP 1.0 file.

    Example:

        modalfmu ssp models/two_beams -o two_beams.ssp

    Parameters
    ----------
    system
        A system file, or a folder with a system.toml.
    output
        The SSP, or a folder for it. Left out: NAME.ssp in the current folder.
    platform
        Where the parts run, as of `modalfmu build`.
    certificate
        Compare the reduced models of the parts with the full ones, as `modalfmu build` does.
    """
    from .runtimes import choose_runtime
    from .ssp_file import read_system_file
    from .ssp_package import package_system, write_ssp
    from .ssp_report import system_table

    file, source = read_system_file(system)
    path = output_path(file.system.name, output, ".ssp")
    check_writable(path)
    with progress() as tell:
        inside = choose_runtime("native", platform, tell)
        package = package_system(file, source, inside.build, tell, certified=certificate)
        tell("packaging", None)
        write_ssp(package, path)
    show(
        system_table(package),
        f"{path}: {path.stat().st_size / 1e6:.2f} MB, {len(package.elements)} components, "
        f"{len(package.wires)} connections",
    )
