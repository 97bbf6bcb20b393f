"""What beam theory says of a mast with an instrument on top: a Timoshenko beam by its transfer matrix.

Lengths in m, E in Pa, ρ in kg/m³, frequencies in Hz. Displacements are relative to the base.
"""

from dataclasses import dataclass
from math import pi, sin, sqrt

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm
from scipy.optimize import brentq

Complexes = NDArray[np.complex128]
Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Mast:
    """A tube along z, clamped at z = 0, a mass m and perhaps a stay (k, c to the base) at z = L.

    alpha, beta: D = αM + βK of tube, mass and spring, in 1/s and s.
    """

    length: float
    outer: float
    inner: float
    young: float
    poisson: float
    density: float
    mass: float
    stiffness: float = 0.0
    damping: float = 0.0
    alpha: float = 0.0
    beta: float = 0.0

    @property
    def area(self) -> float:
        """A = π (R² − r²)."""
        return pi * (self.outer**2 - self.inner**2)

    @property
    def second_moment(self) -> float:
        """I = π (R⁴ − r⁴) / 4."""
        return pi * (self.outer**4 - self.inner**4) / 4

    @property
    def shear_modulus(self) -> float:
        """G = E / (2 (1 + ν))."""
        return self.young / (2 * (1 + self.poisson))

    @property
    def shear_stiffness(self) -> float:
        """κGA, κ = 6 (1+ν)(1+n²)² / ((7+6ν)(1+n²)² + (20+12ν) n²), n = r/R.

        Source: Cowper, J. Appl. Mech. 33 (1966) 335–340.
        """
        nu, square = self.poisson, (self.inner / self.outer) ** 2
        kappa = 6 * (1 + nu) * (1 + square) ** 2
        kappa /= (7 + 6 * nu) * (1 + square) ** 2 + (20 + 12 * nu) * square
        return kappa * self.shear_modulus * self.area

    @property
    def total_mass(self) -> float:
        """ρAL + m in kg."""
        return self.density * self.area * self.length + self.mass

    def sections(self, omega: Complexes, z: float, force: float, base: float) -> Complexes:
        """(f, 4): w, ψ, M, V at the height z, under a force at the top and an acceleration of the base.

        w = ψ = 0 at the base, M = 0 and V = F − m a − (k + iωc − m s) w at the top; the rest as in `_along`.
        omega: (f,) rad/s, complex where the motion grows or dies; 0 is statics.
        """
        A = self._along(omega, base)
        EI = self.young * self.second_moment
        ends = self._ends(A, omega)
        loads = np.array([0.0, (force - self.mass * base) / EI])
        foot = np.zeros((len(omega), 5, 1), dtype=complex)
        foot[:, 2:4] = np.linalg.solve(ends[:, :, 2:4], (loads - ends[:, :, 4])[:, :, None])
        foot[:, 4] = 1
        found: Complexes = (expm(A * z) @ foot)[:, :4, 0]
        return found * [1, 1, EI, EI]

    def _along(self, omega: Complexes, base: float) -> Complexes:
        """A of y' = A y, y = (w, ψ, M/EI, V/EI, 1), (f, 5, 5).

        With e^{iωt}, s = ω² − iαω and E, G times 1 + iωβ:
        w' = ψ + V/κGA, ψ' = M/EI, M' = −V − ρI s ψ, V' = −ρA s w + ρA a
        (Timoshenko, Phil. Mag. 41 (1921) 744–746).
        """
        s, stiff = omega**2 - 1j * self.alpha * omega, 1 + 1j * omega * self.beta
        EI = self.young * self.second_moment
        rho_A, rho_I = self.density * self.area, self.density * self.second_moment
        A = np.zeros((len(omega), 5, 5), dtype=complex)
        A[:, 0, 1] = 1
        A[:, 0, 3] = EI / (self.shear_stiffness * stiff)
        A[:, 1, 2] = 1 / stiff
        A[:, 2, 1], A[:, 2, 3] = -rho_I * s / EI, -1
        A[:, 3, 0], A[:, 3, 4] = -rho_A * s / EI, rho_A * base / EI
        return A

    def _ends(self, A: Complexes, omega: Complexes) -> Complexes:
        """(f, 2, 5): what y at the foot makes of M/EI and of (V + (k + iωc − m s) w)/EI at the top."""
        s, stiff = omega**2 - 1j * self.alpha * omega, 1 + 1j * omega * self.beta
        k = self.stiffness * stiff + 1j * omega * self.damping - self.mass * s
        top = expm(A * self.length)
        held = k[:, None] / (self.young * self.second_moment)
        return np.stack([top[:, 2], top[:, 3] + held * top[:, 0]], axis=1)

    def static(self, z: float, force: float = 0.0, base: float = 0.0) -> Floats:
        """w, ψ, M, V at the height z at rest; gravity g is base = −g."""
        return self.sections(np.zeros(1, dtype=complex), z, force, base)[0].real

    def stress(self, moment: Floats, angle: float) -> Floats:
        """σ = −M x̄ / I, its mean over the outer face within ± angle of x: x̄ = R sin(angle) / angle."""
        return -moment * self.outer * sin(angle) / angle / self.second_moment

    def bending(self, count: int) -> list[float]:
        """The lowest frequencies: M and V at the foot can be other than 0 without a load.

        Of the mast without damping.
        """
        lowest = sqrt(3 * self.young * self.second_moment / (self.length**3 * self.total_mass)) / (2 * pi)

        def determinant(f: float) -> float:
            omega = np.array([2 * pi * f + 0j])
            return float(np.linalg.det(self._ends(self._along(omega, 0.0), omega)[0, :, 2:4]).real)

        roots: list[float] = []
        f = lowest / 2
        while len(roots) < count:  # the frequencies of a mast lie farther apart than this
            if determinant(f) * determinant(f + lowest) < 0:
                roots.append(float(brentq(determinant, f, f + lowest, xtol=1e-9)))
            f += lowest
        return roots

    def torsion(self) -> float:
        """f = √(G/ρ) / 4L, a quarter wave: the instrument is a point."""
        return sqrt(self.shear_modulus / self.density) / (4 * self.length)

    def axial(self) -> float:
        """ρA cos κL = m κ sin κL, ω = κ √(E/ρ): the lowest."""
        rho_A = self.density * self.area

        def balance(kappa: float) -> float:
            return float(
                rho_A * np.cos(kappa * self.length) - self.mass * kappa * np.sin(kappa * self.length)
            )

        kappa = float(brentq(balance, 0.0, pi / (2 * self.length)))
        return kappa * sqrt(self.young / self.density) / (2 * pi)

    def shaken(self, t: Floats, a: Floats, z: float) -> tuple[Floats, Floats]:
        """Response to an acceleration a(t) of the base from rest: w, ψ, M, V at z (4, n), and ẅ + a (n,).

        By Fourier transforms of motions times e^{−σt} over twice the time, so that little of the end of
        the period comes round to its beginning: the exponential window.
        Source: Kausel & Roësset, J. Eng. Mech. 118 (1992) 721–734.
        t: (n,) equally spaced from 0.
        """
        n, h = len(t), t[1] - t[0]
        sigma = 12 / (2 * n * h)  # what comes round is e^{−12} of it
        omega = 2 * pi * np.fft.rfftfreq(2 * n, h) - 1j * sigma
        spectrum = np.fft.rfft(a * np.exp(-sigma * t), 2 * n)
        H = self.sections(omega, z, 0.0, 1.0)
        H = np.column_stack([H, 1 - omega**2 * H[:, 0]])
        y = np.fft.irfft(H.T * spectrum, 2 * n)[:, :n] * np.exp(sigma * t)
        return y[:4], y[4]
