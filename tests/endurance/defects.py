"""How near to a rotation rounded coefficients are: as the FMU has them, and as they could be."""

from dataclasses import dataclass

import mpmath
import numpy as np
from endurance.rotation import DIGITS, coefficients, determinant, near_zero, turn
from examples import oscillator
from native_fmu import native_fmu

from fmu_src.runtime.model import Floats, ReducedModel

BANDS = ((1e-3, 0.1), (0.1, 1.5), (1.5, np.pi), (np.pi, 100.0))  # of θ = ωh
EACH, H = 300, 1e-3


@dataclass(frozen=True)
class Defects:
    """det E − 1 of (n,) modes: of the FMU, of coefficients rounded correctly, and where cos θ − 1 is kept in
    place of cos θ; what a step turns too far (rad), of the FMU and rounded correctly."""

    fmu: Floats
    correct: Floats
    increments: Floats
    turn: Floats
    turn_correct: Floats


def many_modes() -> ReducedModel:
    """Undamped, at random in the bands."""
    rng = np.random.default_rng(3)
    theta = np.concatenate([np.exp(rng.uniform(*np.log(band), EACH)) for band in BANDS])
    r = len(theta)
    return oscillator(
        "many_modes",
        lam=np.sort(theta / H) ** 2,
        alpha=0.0,
        D_rest=np.zeros((r, r)),
        B=np.ones((r, 1)),
        C=np.ones((3, r)),
    )


def survey() -> list[Defects]:
    """For each band."""
    lam = many_modes().lam
    (E,) = coefficients(native_fmu(many_modes), {H: 1}).values()
    with mpmath.workdps(DIGITS):
        found = np.array([_defects(lam[i], E[:, :, i]) for i in range(len(lam))], float)
    return [Defects(*band.T) for band in found.reshape(len(BANDS), EACH, -1)]


def _defects(lam: float, E: Floats) -> list[mpmath.mpf]:
    omega = mpmath.sqrt(lam)
    theta = omega * mpmath.mpf(H)
    c, s = mpmath.cos(theta), mpmath.sin(theta)
    correct = np.array([[float(c), float(s / omega)], [float(-omega * s), float(c)]])
    kept = mpmath.mpf(float(c - 1))
    E12, E21 = (mpmath.mpf(float(e)) for e in (correct[0, 1], correct[1, 0]))
    return [
        determinant(E) - 1,
        determinant(correct) - 1,
        2 * kept + kept**2 - E12 * E21,
        near_zero(turn(E) - theta),
        near_zero(turn(correct) - theta),
    ]
