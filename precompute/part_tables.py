"""The tables of a part file, each with what may stand in it."""

from typing import Annotated, Literal, Self, TypeAlias, TypeVar

from pydantic import AfterValidator, Field, model_validator

from .at_table import At, Number
from .toml_table import Table, exactly_one, mistake, not_empty

# First words of the FMU's other variables.
RESERVED = ("modes", "damping", "energy", "gravity", "base", "der", "time")

Item = TypeVar("Item")


def _distinct(items: tuple[Item, ...]) -> tuple[Item, ...]:
    if len(set(items)) != len(items):
        raise ValueError(items)
    return items


def _unreserved(name: str) -> str:
    if name in RESERVED:
        raise ValueError(name)
    return name


def _two_frequencies(pairs: tuple[tuple[float, float], ...]) -> tuple[tuple[float, float], ...]:
    if len(pairs) < 2 or len({frequency for frequency, _ in pairs}) < len(pairs):
        raise ValueError(pairs)
    return pairs


# One line; U+FFFE and U+FFFF cannot stand in XML.
Text: TypeAlias = Annotated[str, Field(pattern=r"^[^\p{Cc}\p{Zl}\p{Zp}\uFFFE\uFFFF]+$")]
Identifier: TypeAlias = Annotated[str, Field(pattern=r"^[A-Za-z_][A-Za-z0-9_]*$")]
Direction: TypeAlias = Literal["x", "y", "z"]
LengthUnit: TypeAlias = Literal["m", "mm", "cm", "um", "in", "ft"]
Input: TypeAlias = Literal["force.x", "force.y", "force.z"]
# fmt: off
Output: TypeAlias = Literal[
    "displacement.x", "displacement.y", "displacement.z",
    "velocity.x", "velocity.y", "velocity.z",
    "acceleration.x", "acceleration.y", "acceleration.z",
]
# fmt: on
NotNegative: TypeAlias = Annotated[Number, Field(ge=0)]
# Far beyond any part, and (2πf)², 1/(2h) and ratios of them stay far from overflow.
Hertz: TypeAlias = Annotated[Number, Field(ge=1e-9, le=1e12)]
Seconds: TypeAlias = Annotated[Number, Field(ge=1e-12, le=1e9)]


class Heading(Table):
    """[part]"""

    name: Identifier = Field(
        description="a C identifier: letters, digits and _, no digit first", examples=['name = "cantilever"']
    )
    description: Text | None = Field(
        default=None, description="one line of text", examples=['description = "a steel beam"']
    )
    mesh: Text = Field(
        description="the path of a mesh file, relative to the part file, with / between folders",
        examples=['mesh = "beam.msh"'],
    )
    length_unit: LengthUnit = Field(
        description="the unit of the mesh's coordinates: m, mm, cm, um, in or ft",
        examples=['length_unit = "m"'],
    )


class Material(Table):
    """[[material]]: isotropic and linear elastic, for the cells of the set `cells` or all that are left."""

    name: Text = Field(description="a name of its own", examples=['name = "steel"'])
    young: Annotated[Number, Field(ge=1e-3, le=1e18)] = Field(
        description="Young's modulus in Pa, a finite number > 0 (1e-3 to 1e18)", examples=["young = 210e9"]
    )
    poisson: Annotated[Number, Field(gt=-1, lt=0.5)] = Field(
        description="Poisson's ratio, a number with -1 < ν < 0.5", examples=["poisson = 0.3"]
    )
    density: Annotated[Number, Field(ge=1e-9, le=1e9)] = Field(
        description="the density in kg/m³, a finite number > 0 (1e-9 to 1e9)", examples=["density = 7850.0"]
    )
    cells: Text | None = Field(
        default=None, description="the name of a cell set of the mesh", examples=['cells = "body"']
    )


class Support(Table):
    """[[support]]: directions in which nodes are held."""

    at: At = Field(
        description="the name of a set, or a table with one of point, box, plane, nodes",
        examples=['at = "clamp"'],
    )
    fix: Annotated[tuple[Direction, ...], AfterValidator(not_empty), AfterValidator(_distinct)] = Field(
        description='a list of one to three of "x", "y", "z", none twice', examples=['fix = ["x", "y", "z"]']
    )


class Port(Table):
    """[[port]]: where the part meets the rest of the system."""

    name: Annotated[Identifier, AfterValidator(_unreserved)] = Field(
        description="a C identifier (letters, digits and _, no digit first) other than "
        + ", ".join(RESERVED),
        examples=['name = "tip"'],
    )
    at: At = Field(
        description="the name of a set, or a table with one of point, box, plane, nodes",
        examples=["at = { point = [1.0, 0.0, 0.0] }"],
    )
    inputs: Annotated[tuple[Input, ...], AfterValidator(_distinct)] = Field(
        default=(),
        description="a list of force.x, force.y, force.z, none twice",
        examples=['inputs = ["force.z"]'],
    )
    outputs: Annotated[tuple[Output, ...], AfterValidator(_distinct)] = Field(
        default=(),
        description="a list of displacement, velocity, acceleration, each with .x, .y or .z, none twice",
        examples=['outputs = ["displacement.z"]'],
    )
    weights: Literal["area", "equal"] = Field(
        default="area", description='"area" or "equal"', examples=['weights = "area"']
    )

    @model_validator(mode="after")
    def _does_something(self) -> Self:
        if not (self.inputs or self.outputs):
            raise mistake(
                "got neither inputs nor outputs, expected at least one of them; "
                'write e.g. inputs = ["force.z"]'
            )
        return self


class ModeChoice(Table):
    """[modes]: the lowest `count` modes, or all with f ≤ `max_frequency` (Hz).

    A communication step h = `step` (s) samples what is slower than its Nyquist frequency:
    max_frequency = 1/(2h).
    """

    count: Annotated[int, Field(strict=True, ge=1)] | None = Field(
        default=None, description="a whole number of modes ≥ 1", examples=["count = 20"]
    )
    max_frequency: Hertz | None = Field(
        default=None,
        description="a frequency > 0 in Hz (1e-9 to 1e12)",
        examples=["max_frequency = 2000.0"],
    )
    step: Seconds | None = Field(
        default=None, description="a step size > 0 in s (1e-12 to 1e9)", examples=["step = 1e-3"]
    )
    initial: Literal["rest", "static"] = Field(
        default="rest", description='"rest" or "static"', examples=['initial = "rest"']
    )

    @model_validator(mode="after")
    def _one_choice(self) -> Self:
        exactly_one(sorted(self.model_fields_set - {"initial"}), "count, max_frequency, step")
        if self.step is None:
            return self
        return self.model_copy(update={"max_frequency": 1 / (2 * self.step)})


class DampingForm(Table):
    """[damping]: αI + βΛ by `alpha` (1/s) and `beta` (s) | one ratio ζ | ratios (Hz, ζ) to fit α, β to."""

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

    @model_validator(mode="after")
    def _one_form(self) -> Self:
        given = self.model_fields_set
        forms = [" and ".join(sorted(given & {"alpha", "beta"})), *sorted(given & {"ratio", "ratios"})]
        exactly_one([form for form in forms if form], "alpha with beta, ratio, ratios")
        return self
