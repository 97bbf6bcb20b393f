"""Undamped modes over many steps: what the FMU did beside what its rounded rotation must do."""

from dataclasses import dataclass

import numpy as np
from endurance.programs import program, run
from endurance.rotation import Growth, coefficients, growth
from examples import oscillator
from native_fmu import NativeFmu, native_fmu

from fmu_src.runtime.model import Floats, ReducedModel

H = 1e-3  # s
THETA = np.array(
    [0.01, np.pi / 50, 0.3, 1.0, np.pi / 2, 2.0, 3.1, 100.0]
)  # ωh, a quarter of a turn among them
RNG = np.random.default_rng(1)
PLANS: dict[str, tuple[str, tuple[float, ...]]] = {
    "1 ms": ("held", (H,)),
    "1/1024 s": ("held", (1 / 1024,)),
    "0.1 s": ("held", (0.1,)),
    "t(k+1) - t(k), 1 ms": ("grid", (H,)),
    "12 sizes, 1 ms ± 20 %": ("drawn", tuple(H * (1 + 0.2 * RNG.uniform(-1, 1, 12)))),
    "40 sizes, not all kept": ("drawn", tuple(H * (1 + 0.2 * RNG.uniform(-1, 1, 40)))),
}


def free_modes() -> ReducedModel:
    """Undamped; the port's force disturbs them all."""
    r = len(THETA)
    return oscillator(
        "free_modes",
        lam=(THETA / H) ** 2,
        alpha=0.0,
        D_rest=np.zeros((r, r)),
        B=np.ones((r, 1)),
        C=np.ones((3, r)),
    )


@dataclass(frozen=True)
class Endured:
    """motion: (2, r) q, v after so many steps; memory in kB and bytes from a tenth of the steps on."""

    motion: dict[int, Floats]
    sizes: dict[float, int]
    resident: int
    allocations: int
    bytes: int
    left: int

    @property
    def steps(self) -> int:
        return max(self.motion)


def endure(plan: str, steps: int, saves: int = 0, restore: bool = True) -> Endured:
    """Free modes from q = 1, v = 0, through the FMU's own library."""
    fmu = native_fmu(free_modes)
    kind, sizes = PLANS[plan]
    amplitude = fmu.reference["modes.amplitude[1]"]
    lines = run(
        *(program("undamped"), fmu, fmu.modes, amplitude),
        *(steps, saves, int(restore), kind, *(h.hex() for h in map(float, sizes))),
    )
    told = {line[0]: int(line[1]) for line in lines if len(line) == 2}
    return Endured(
        {int(line[1]): _numbers(line[2:]) for line in lines if line[0] == "motion"},
        {float.fromhex(line[1]): int(line[2]) for line in lines if line[0] == "size"},
        *(told[key] for key in ("resident", "allocations", "bytes", "left")),
    )


def growths(endured: Endured) -> list[Growth]:
    """Of each mode at the end."""
    fmu: NativeFmu = native_fmu(free_modes)
    E = coefficients(fmu, endured.sizes)
    q, v = endured.motion[endured.steps]
    return [
        growth(lam, {h: E[h][:, :, i] for h in E}, endured.sizes, q[i], v[i])
        for i, lam in enumerate(free_modes().lam.tolist())
    ]


def _numbers(words: list[str]) -> Floats:
    return np.array([float.fromhex(word) for word in words]).reshape(2, -1)
