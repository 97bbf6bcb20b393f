"""Isotropic linear elasticity σ = λ tr(ε) I + 2μ ε."""

from collections.abc import Mapping
from dataclasses import dataclass

from .arrays import Ints
from .errors import ModalFmuError


@dataclass(frozen=True)
class CellMaterial:
    """A material and the cells made of it.

    young: E > 0 in Pa; poisson: −1 < ν < ½; density: ρ > 0 in kg/m³;
    cells: family → rows of `mesh.cells[family]`.
    Raises ModalFmuError: a number out of its range.
    """

    name: str
    young: float
    poisson: float
    density: float
    cells: Mapping[str, Ints]

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

    @property
    def lam(self) -> float:
        """λ = E ν / ((1 + ν)(1 − 2ν)) in Pa."""
        return self.young * self.poisson / ((1 + self.poisson) * (1 - 2 * self.poisson))

    @property
    def mu(self) -> float:
        """μ = E / (2 (1 + ν)) in Pa."""
        return self.young / (2 * (1 + self.poisson))
