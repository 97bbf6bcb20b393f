"""Isotropic linear elasticity σ = λ tr(ε) I + 2μ ε."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from .arrays import Ints
from .errors import ModalFmuError


@dataclass(frozen=True)
class CellMaterial:
    """A material and the cells made of it.

    young: E > 0 in Pa; poisson: −1 < ν < ½; density: ρ > 0 in kg/m³;
    cells: family → rows of `mesh.cells[family]`;
    alpha, beta: α ≥ 0 in 1/s, β ≥ 0 in s, its own damping α_m M_m + β_m K_m.
    Raises ModalFmuError: a number out of its range.
    """

    name: str
    young: float
    poisson: float
    density: float
    cells: Mapping[str, Ints]
    alpha: float = 0.0
    beta: float = 0.0

    def __post_init__(self) -> None:
        ranges = {
            "young": (self.young, 0.0, float("inf"), "Pa"),
            "poisson": (self.poisson, -1.0, 0.5, "no unit"),
            "density": (self.density, 0.0, float("inf"), "kg/m³"),
        }
        for key, (value, low, high, unit) in ranges.items():
            if not low < value < high:
                raise ModalFmuError(
                    f"material {self.name!r}: got {key} = {value}; expected {low} < {key} < {high} ({unit})"
                )
        for key, value, unit in (("alpha", self.alpha, "1/s"), ("beta", self.beta, "s")):
            if not 0 <= value < float("inf"):
                raise ModalFmuError(
                    f"material {self.name!r}: got {key} = {value}; expected a finite number ≥ 0 ({unit})"
                )

    @property
    def lam(self) -> float:
        """λ = E ν / ((1 + ν)(1 − 2ν)) in Pa."""
        return self.young * self.poisson / ((1 + self.poisson) * (1 - 2 * self.poisson))

    @property
    def mu(self) -> float:
        """μ = E / (2 (1 + ν)) in Pa."""
        return self.young / (2 * (1 + self.poisson))


def shared_rayleigh(materials: Sequence[CellMaterial]) -> tuple[float, float]:
    """α in 1/s and β in s that all materials have, each 0 where they differ.

    With them D = αM + βK + D_rest of the whole body, where D_rest holds what they do not have in common:
    a body of one damping has Rayleigh damping [2.28].
    """
    alphas, betas = {m.alpha for m in materials}, {m.beta for m in materials}
    return (alphas.pop() if len(alphas) == 1 else 0.0, betas.pop() if len(betas) == 1 else 0.0)
