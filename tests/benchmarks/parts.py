"""Parts of any size for the benchmarks, as FMUs in folders, and the C drivers that run them."""

import subprocess
import sys
import zipfile
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from fmu_src.native_fmu import build_native_fmu
from fmu_src.native_library import native_libraries
from fmu_src.runtime.model import Port, ReducedModel
from fmu_src.toolchain import FLAGS, PLATFORMS, SOURCES, fmi_headers, host_platform

HERE = Path(__file__).parent
MODELS = HERE.parents[1] / "models"
PLATFORM = host_platform() or "linux64"
READER = (
    *("common", "json", "json_scalars", "sha256", "npy"),
    *("model", "kinds", "ports", "header", "folder", "resources"),
)
DRIVERS = {
    "cycle": (*READER, "propagator", "kernels"),
    "steps": (),
    "instructions": (),
    "oscillators": READER,
}
KINDS = ("displacement", "velocity")


@dataclass(frozen=True)
class Unpacked:
    """A native FMU in a folder."""

    model: ReducedModel
    fmu: Path
    folder: Path

    @property
    def library(self) -> Path:
        return next((self.folder / "binaries" / PLATFORM).iterdir())

    @property
    def arguments(self) -> list[str]:
        """LIBRARY GUID LOCATION of the drivers."""
        resources = self.folder / "resources"
        return [str(self.library), (resources / "guid.txt").read_text().strip(), resources.as_uri()]


def part(r: int, m: int, p: int, coupled: int = 0) -> ReducedModel:
    """r modes from 10 Hz to 5 kHz, m forces, p displacements and velocities, shapes at random.

    coupled: a dashpot of 300 N.s/m joins so many of the modes.
    """
    rng = np.random.default_rng(1)
    count = max(-(-m // 3), -(-p // 6))
    forces = [f"force.{axis}" for axis in "xyz"]
    outputs = [f"{kind}.{axis}" for kind in KINDS for axis in "xyz"]
    ports = tuple(
        Port(f"p{k}", tuple(forces[: max(0, m - 3 * k)]), tuple(outputs[: max(0, p - 6 * k)]))
        for k in range(count)
    )
    w = np.where(np.arange(r) < coupled, rng.standard_normal(r), 0.0)
    return ReducedModel(
        name=f"part_{r}_{m}_{p}_{coupled}",
        description="shapes at random",
        lam=(2 * np.pi * np.geomspace(10.0, 5000.0, r)) ** 2,
        alpha=1.0,
        beta=1e-6,
        D_rest=300.0 * np.outer(w, w),
        B=rng.standard_normal((r, m)),
        C=rng.standard_normal((p, r)),
        R=np.zeros((p, m)),
        R_in=np.zeros((m, m)),
        ports=ports,
    )


def unpacked(model: ReducedModel, scratch: Path) -> Unpacked:
    """The FMU with this machine's library, and its files."""
    libraries = native_libraries((PLATFORM,))
    fmu = build_native_fmu(model, scratch / f"{model.name}.fmu", libraries=libraries)
    with zipfile.ZipFile(fmu) as archive:
        archive.extractall(scratch / model.name)
    return Unpacked(model, fmu, scratch / model.name)


@cache
def driver(name: str, scratch: Path) -> Path:
    """The C driver, compiled as the libraries are: same compiler, same flags."""
    flags = [flag for flag in FLAGS if flag not in ("-shared", "-fvisibility=hidden")]
    sources = [HERE / f"{name}.c", *(SOURCES / f"{source}.c" for source in DRIVERS[name])]
    command = [sys.executable, "-m", "ziglang", "cc", "-target", PLATFORMS[PLATFORM].targets[0], *flags]
    command += ["-I", str(SOURCES), "-I", str(fmi_headers()), *map(str, sources)]
    subprocess.run([*command, "-lm", "-ldl", "-o", str(scratch / name)], check=True)
    return scratch / name


def run(name: str, scratch: Path, *arguments: object) -> dict[str, float]:
    """What the driver printed: names and numbers."""
    command = [str(driver(name, scratch)), *map(str, arguments)]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    return {key: float(value) for key, value in (line.split() for line in done.stdout.splitlines())}
