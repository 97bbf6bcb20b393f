"""[damping]: how the modes lose energy."""

from typing import Annotated, Self, TypeAlias

from pydantic import AfterValidator, Field, model_validator

from .part_values import Hertz, NotNegative
from .toml_table import Table, exactly_one, not_empty

OTHER_FORMS = ("ratio", "ratios", "table", "structural")
ModeNumber: TypeAlias = Annotated[int, Field(strict=True, ge=1, lt=2**31)]


def _two_frequencies(pairs: tuple[tuple[float, float], ...]) -> tuple[tuple[float, float], ...]:
    if len(pairs) < 2 or len({frequency for frequency, _ in pairs}) < len(pairs):
        raise ValueError(pairs)
    return pairs


def _no_mode_twice(pairs: tuple[tuple[int, float], ...]) -> tuple[tuple[int, float], ...]:
    if len({number for number, _ in pairs}) < len(pairs):
        raise ValueError(pairs)
    return pairs


class DampingForm(Table):
    """[damping]: one of five forms.

    αI + βΛ by `alpha` (1/s) and `beta` (s) | one `ratio` ζ | `ratios` (Hz, ζ) to fit α, β to |
    a `table` (number of the mode, ζ) | the loss factor η of `structural` damping, ζ = η/2.
    """

    alpha: NotNegative = Field(
        default=0.0, description="a finite number ≥ 0 in 1/s", examples=["alpha = 1.0"]
    )
    beta: NotNegative = Field(default=0.0, description="a finite number ≥ 0 in s", examples=["beta = 1e-6"])
    ratio: NotNegative | None = Field(
        default=None, description="a damping ratio ≥ 0 (2 % is 0.02)", examples=["ratio = 0.02"]
    )
    ratios: Annotated[tuple[tuple[Hertz, NotNegative], ...], AfterValidator(_two_frequencies)] | None = Field(
        default=None,
        description="two or more pairs [Hz, damping ratio ≥ 0], no frequency twice, each > 0 (1e-9 to 1e12)",
        examples=["ratios = [[10.0, 0.02], [500.0, 0.01]]"],
    )
    table: (
        Annotated[
            tuple[tuple[ModeNumber, NotNegative], ...],
            AfterValidator(not_empty),
            AfterValidator(_no_mode_twice),
        ]
        | None
    ) = Field(
        default=None,
        description="one or more pairs [number of the mode ≥ 1, damping ratio ≥ 0], no mode twice",
        examples=["table = [[1, 0.02], [2, 0.015]]"],
    )
    structural: NotNegative | None = Field(
        default=None, description="a loss factor ≥ 0, twice the damping ratio", examples=["structural = 0.01"]
    )

    @model_validator(mode="after")
    def _one_form(self) -> Self:
        given = self.model_fields_set
        forms = [" and ".join(sorted(given & {"alpha", "beta"})), *(f for f in OTHER_FORMS if f in given)]
        exactly_one([form for form in forms if form], "alpha with beta, " + ", ".join(OTHER_FORMS))
        return self

    @property
    def other_form(self) -> str | None:
        """The key of a form other than α and β."""
        return next((form for form in OTHER_FORMS if getattr(self, form) is not None), None)
