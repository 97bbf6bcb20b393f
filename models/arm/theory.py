"""What beam theory says of an arm whose root is moved: a Timoshenko beam by its transfer matrix.

Lengths in m, E in Pa, ρ in kg/m³, frequencies in Hz; the arm bends in y, about z.
"""

from dataclasses import dataclass
from math import pi

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm
from scipy.optimize import brentq

Complexes = NDArray[np.complex128]


@dataclass(frozen=True)
class Arm:
    """A bar of thickness h in y and width b in z, moved at x = 0, free at x = L; D = βK, β in s."""

    length: float
    thickness: float
    width: float
    young: float
    poisson: float
    density: float
    beta: float = 0.0

    @property
    def area(self) -> float:
        """A = b h."""
        return self.width * self.thickness

    @property
    def second_moment(self) -> float:
        """I = b h³ / 12."""
        return self.width * self.thickness**3 / 12

    @property
    def bending_stiffness(self) -> float:
        """EI."""
        return self.young * self.second_moment

    @property
    def shear_stiffness(self) -> float:
        """κGA, κ = 10 (1 + ν)/(12 + 11 ν).

        Source: Cowper, J. Appl. Mech. 33 (1966) 335–340.
        """
        kappa = 10 * (1 + self.poisson) / (12 + 11 * self.poisson)
        return kappa * self.young / (2 * (1 + self.poisson)) * self.area

    @property
    def mass(self) -> float:
        """ρAL."""
        return self.density * self.area * self.length

    @property
    def inertia(self) -> float:
        """About z at the root, ρAL³/3 + ρIL."""
        return self.density * self.length * (self.area * self.length**2 / 3 + self.second_moment)

    def _along(self, f: float) -> Complexes:
        """A of y' = A y, y = (w, ψ, M, V), (4, 4), with e^{iωt}, E and G times 1 + iωβ.

        w' = ψ + V/κGA, ψ' = M/EI, M' = −V − ρIω²ψ, V' = −ρAω²w
        (Timoshenko, Phil. Mag. 41 (1921) 744–746).
        """
        omega = 2 * pi * f
        stiff = 1 + 1j * omega * self.beta
        A = np.zeros((4, 4), dtype=complex)
        A[0, 1], A[0, 3] = 1, 1 / (self.shear_stiffness * stiff)
        A[1, 2] = 1 / (self.bending_stiffness * stiff)
        A[2, 1], A[2, 3] = -self.density * self.second_moment * omega**2, -1
        A[3, 0] = -self.density * self.area * omega**2
        return A

    def moved(self, f: float, x: float, acceleration: float = 0.0, angular: float = 0.0) -> Complexes:
        """w, ψ, M, V at x, (4,), under accelerations ẅ and ψ̈ of the root at f in Hz; M = V = 0 at the tip.

        −V and −M at the root are what drives it.
        """
        A, omega = self._along(f), 2 * pi * f
        moved = np.array([-acceleration / omega**2, -angular / omega**2, 0, 0], dtype=complex)
        end = expm(A * self.length)[2:]
        moved[2:] = np.linalg.solve(end[:, 2:], -end[:, :2] @ moved[:2])
        found: Complexes = expm(A * x) @ moved
        return found

    def bending(self, count: int) -> list[float]:
        """The lowest frequencies with the root held: M and V there can be other than 0 while it rests."""

        def determinant(f: float) -> float:
            return float(np.linalg.det(expm(self._along(f) * self.length)[2:, 2:].real))

        lowest = 0.56 * np.sqrt(self.bending_stiffness / (self.density * self.area)) / self.length**2
        roots: list[float] = []
        f = float(lowest) / 2
        while len(roots) < count:
            if determinant(f) * determinant(f + lowest) < 0:
                roots.append(float(brentq(determinant, f, f + lowest, xtol=1e-9)))
            f += float(lowest)
        return roots

    def axial(self) -> float:
        """√(E/ρ)/4L."""
        return float(np.sqrt(self.young / self.density) / (4 * self.length))
