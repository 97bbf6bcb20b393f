"""Two equal Euler–Bernoulli cantilevers with a spring k between their tips.

They move together as if there were no spring, or against each other, each as if held by 2k to the ground:

  E I β³ (1 + cos βL cosh βL) = 2k (cos βL sinh βL − sin βL cosh βL),  2πf = β² √(EI/ρA).

Source: Blevins, Formulas for Natural Frequency and Mode Shape, table 8-1.
"""

from math import cos, cosh, pi, sin, sinh, sqrt

from scipy.optimize import brentq

LENGTH, WIDTH, HEIGHT = 1.0, 0.03, 0.02  # m; it bends in z, along its height
YOUNG, DENSITY = 210e9, 7850.0  # Pa, kg/m³
FLEXURAL = YOUNG * WIDTH * HEIGHT**3 / 12  # EI, N·m²


def frequency(spring: float) -> float:
    """The lowest natural frequency in Hz of one beam whose tip a spring (N/m) holds to the ground."""

    def residual(x: float) -> float:
        bending = FLEXURAL * (x / LENGTH) ** 3 * (1 + cos(x) * cosh(x))
        return bending - spring * (cos(x) * sinh(x) - sin(x) * cosh(x))

    beta = brentq(residual, 1.5, 3.9) / LENGTH  # 1.875 free, 3.927 propped
    return float(beta**2 * sqrt(FLEXURAL / (DENSITY * WIDTH * HEIGHT)) / (2 * pi))
