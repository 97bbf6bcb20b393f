"""The rounded rotation: what a step of an undamped mode does to its energy and phase, known in advance.

E(h) = [[cos θ, sin θ/ω], [−ω sin θ, cos θ]] with θ = ωh has det E = 1. Its rounded entries have a determinant
of their own, and for any 2×2 matrix the quadratic form det[x, E x] is multiplied by det E in every step,

    det[E x, E E x] = det E · det[x, E x],    det[x, E x] = E₂₁ q² + (E₂₂ − E₁₁) q v − E₁₂ v²,

which is −E₁₂ (λq² + v²) but for the rounding of E₂₁ = −λE₁₂. So after N steps, without any other rounding,

    energy = (det E)^N · energy at 0,    phase = N θ̂,  θ̂ = atan2(±√(−E₁₂E₂₁), (E₁₁ + E₂₂)/2).

Bounds of this systematic part to first order in u = 2⁻⁵³: √λ and √λh, division by √λh, products with h and λ
round by u each, sine and cosine of the C library by 1.1u. So E₁₂E₂₁ is off by 11.2u of itself, E₁₁ by 1.1u,
and |det E − 1| ≤ 12u; θ̂ is off by 2uθ + 4u.

Each step rounds besides, in q and in v, two products and their sum: at most 5u of the energy. These roundings
have no direction and walk at random, with 0.43u as the mean error of one (mantissas being logarithmically
distributed), together 0.9u of the energy; sizes of step that change have forms that differ by the rounding of
E₂₁, 0.5u more. After N steps: u√N, half of it for the phase. Where a step is a simple fraction of a turn the
modes come back to the same numbers, so do their roundings, and 5uN is all that can be said. Over very many
steps of one size the roundings of other modes, too, are a little alike and walk some times as far.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import mpmath
import numpy as np
from native_fmu import OK, NativeFmu

from fmu_src.runtime.model import Floats

U = 2.0**-53
DEFECT = 12 * U  # of the determinant, at most
ROUNDING = 5 * U  # of the energy in a step, at most; half of it for the phase
DIGITS = 40


@dataclass(frozen=True)
class Growth:
    """Of one mode after N steps: ln(energy/energy at 0) and phase − ωt, as expected and as measured.

    `defect` is the largest |det E − 1| among the sizes of step.
    """

    steps: int
    theta: float
    defect: float
    energy_expected: float
    energy: float
    phase_expected: float
    phase: float

    @property
    def within_bounds(self) -> bool:
        """What holds for any step size and any frequency."""
        rounding = ROUNDING * (self.steps + 1)
        return (
            self.defect <= DEFECT
            and abs(self.energy - self.energy_expected) <= rounding
            and abs(self.phase - self.phase_expected) <= 0.5 * rounding
            and abs(self.phase_expected) <= self.steps * U * (2 * self.theta + 4)
        )

    @property
    def energy_walk(self) -> float:
        """What the roundings of the steps did, in standard deviations."""
        return abs(self.energy - self.energy_expected) / (U * self.steps**0.5)

    @property
    def phase_walk(self) -> float:
        return abs(self.phase - self.phase_expected) / (0.5 * U * self.steps**0.5)


def coefficients(fmu: NativeFmu, sizes: Mapping[float, int]) -> dict[float, Floats]:
    """E (2, 2, r) of each size of step: its columns are where the FMU's own step takes q = 1 and v = 1."""
    x = fmu.instance(logging=False)
    q, v = (
        [fmu.reference[f"modes.{name}[{i + 1}]"] for i in range(fmu.modes)]
        for name in ("amplitude", "velocity")
    )
    found = {}
    for h in sizes:
        columns = []
        for unit in (q, v):
            x.must("Reset")
            x.must("SetupExperiment", 0, 0.0, 0.0, 0, 0.0)
            x.must("EnterInitializationMode")
            assert x.set_real(unit, np.ones(len(unit))) == OK
            x.must("ExitInitializationMode")
            assert x.step(0.0, h) == OK
            columns.append([x.get_real(q), x.get_real(v)])
        found[h] = np.array(columns).transpose(1, 0, 2)
    x.free()
    return found


def growth(lam: float, E: Mapping[float, Floats], sizes: Mapping[float, int], q: float, v: float) -> Growth:
    """Of a mode that began with q = 1, v = 0 and made so many steps of each size; E: (2, 2) of each."""
    with mpmath.workdps(DIGITS):
        omega = mpmath.sqrt(lam)
        energy, phase, defect = mpmath.mpf(0), mpmath.mpf(0), 0.0
        for h, count in sizes.items():
            det = determinant(E[h])
            energy += count * mpmath.log(det)
            phase += count * near_zero(turn(E[h]) - omega * h)
            defect = max(defect, abs(float(det - 1)))
        time = mpmath.fsum(count * mpmath.mpf(h) for h, count in sizes.items())
        reached = mpmath.atan2(-mpmath.mpf(v), omega * q)
        return Growth(
            steps=sum(sizes.values()),
            theta=float(omega * max(sizes)),
            defect=defect,
            energy_expected=float(energy),
            energy=float(mpmath.log((lam * mpmath.mpf(q) ** 2 + mpmath.mpf(v) ** 2) / lam)),
            phase_expected=float(phase),
            phase=float(near_zero(reached - omega * time)),
        )


def determinant(E: Floats) -> mpmath.mpf:
    """det E of the numbers as they are."""
    (E11, E12), (E21, E22) = _exact(E)
    return E11 * E22 - E12 * E21


def turn(E: Floats) -> mpmath.mpf:
    """θ̂ in −π … π."""
    (E11, E12), (E21, E22) = _exact(E)
    return mpmath.atan2(mpmath.sign(E12) * mpmath.sqrt(-E12 * E21), (E11 + E22) / 2)


def _exact(E: Floats) -> list[list[mpmath.mpf]]:
    return [[mpmath.mpf(float(e)) for e in row] for row in E]


def near_zero(angle: mpmath.mpf) -> mpmath.mpf:
    """The same angle in −π … π."""
    turns = 2 * mpmath.pi
    return angle - turns * mpmath.nint(angle / turns)
