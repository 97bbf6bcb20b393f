"""What beam theory says of a clamped bar of rectangular section: the cantilever's references.

Lengths in m, E, G in Pa, ρ in kg/m³, frequencies in Hz.
"""

from dataclasses import dataclass
from math import exp, pi, sqrt

import numpy as np
from scipy.linalg import expm
from scipy.optimize import brentq


@dataclass(frozen=True)
class Beam:
    """A bar along x, clamped at x = 0, free at x = L; section: width along y, height along z."""

    length: float
    width: float
    height: float
    young: float
    poisson: float
    density: float

    @property
    def area(self) -> float:
        """A = b h."""
        return self.width * self.height

    @property
    def shear_modulus(self) -> float:
        """G = E / (2 (1 + ν))."""
        return self.young / (2 * (1 + self.poisson))

    @property
    def shear_stiffness(self) -> float:
        """κGA with κ = 10 (1 + ν) / (12 + 11 ν) (Cowper, J. Appl. Mech. 33 (1966) 335–340)."""
        kappa = 10 * (1 + self.poisson) / (12 + 11 * self.poisson)
        return kappa * self.shear_modulus * self.area

    def second_moment(self, direction: str) -> float:
        """I = b t³ / 12 with t the side along the direction, "y" or "z", of the deflection."""
        across, along = {"y": (self.height, self.width), "z": (self.width, self.height)}[direction]
        return across * along**3 / 12

    def euler_bernoulli(self, direction: str) -> list[float]:
        """f = (βL)² / (2πL²) √(EI/ρA) with cos βL cosh βL = −1: the three lowest."""
        EI = self.young * self.second_moment(direction)
        unit = sqrt(EI / (self.density * self.area)) / (2 * pi * self.length**2)
        return [root**2 * unit for root in (1.875104, 4.694091, 7.854757)]

    def timoshenko(self, direction: str, count: int) -> list[float]:
        """The lowest frequencies of a beam with shear and rotary inertia.

        y' = A(ω) y for y = (w, ψ, M, V): w' = ψ + V/κGA, ψ' = M/EI, M' = −V − ρIω²ψ, V' = −ρAω²w.
        w = ψ = 0 at x = 0, M = V = 0 at x = L: the lower right 2 × 2 block of e^{A(ω)L} is singular
        (Timoshenko, Phil. Mag. 41 (1921) 744–746).
        """
        EI = self.young * self.second_moment(direction)
        rho_A, rho_I = self.density * self.area, self.density * self.second_moment(direction)

        def block(f: float) -> float:
            square = (2 * pi * f) ** 2
            A = np.zeros((4, 4))
            A[0, 1], A[0, 3] = 1.0, EI / self.shear_stiffness  # M, V in units of EI
            A[1, 2] = 1.0
            A[2, 1], A[2, 3] = -rho_I * square / EI, -1.0
            A[3, 0] = -rho_A * square / EI
            return float(np.linalg.det(expm(A * self.length)[2:, 2:]))

        lowest = self.euler_bernoulli(direction)[0]
        roots: list[float] = []
        f = lowest / 4
        while len(roots) < count:  # the frequencies of a cantilever lie farther apart than this
            if block(f) * block(f + lowest) < 0:
                roots.append(float(brentq(block, f, f + lowest, xtol=1e-9)))
            f += lowest
        return roots

    def axial(self) -> float:
        """f = √(E/ρ) / 4L, a quarter wave."""
        return sqrt(self.young / self.density) / (4 * self.length)

    def torsion(self) -> float:
        """f = √(GJ/ρI_p) / 4L, free warping; J = a b³ (1/3 − 0.21 b/a (1 − b⁴/12a⁴)), a ≥ b (Roark)."""
        b, a = sorted((self.width, self.height))
        J = a * b**3 * (1 / 3 - 0.21 * b / a * (1 - b**4 / (12 * a**4)))
        polar = self.second_moment("y") + self.second_moment("z")
        return sqrt(self.shear_modulus * J / (self.density * polar)) / (4 * self.length)

    def deflection(self, direction: str, force: float) -> float:
        """δ = F L³ / 3EI + F L / κGA at the tip, m."""
        EI = self.young * self.second_moment(direction)
        return force * self.length**3 / (3 * EI) + force * self.length / self.shear_stiffness


def overshoot(ratio: float) -> float:
    """Largest deflection after a step of force over the static one, one mode: 1 + e^{−ζπ/√(1−ζ²)}."""
    return 1 + exp(-ratio * pi / sqrt(1 - ratio**2))
