"""[part], [[material]], [system], [[support]]: the tables of a part file that say what the body is."""

from typing import Annotated, Literal, Self

from pydantic import AfterValidator, Field, model_validator

from .at_table import WHERE, At
from .part_values import (
    NAME,
    Direction,
    FilePath,
    Identifier,
    LengthUnit,
    Name,
    NotNegative,
    Number,
    Text,
    distinct,
)
from .toml_table import Table, mistake, not_empty

_MATRIX_FILE = "the path of a matrix file, relative to the part file, with / between folders"


class Heading(Table):
    """[part]"""

    name: Identifier = Field(
        description="a C identifier: letters, digits and _, no digit first", examples=['name = "cantilever"']
    )
    description: Text | None = Field(
        default=None, description="one line of text", examples=['description = "a steel beam"']
    )
    mesh: FilePath | None = Field(
        default=None,
        description="the path of a mesh file, relative to the part file, with / between folders",
        examples=['mesh = "beam.msh"'],
    )
    length_unit: LengthUnit | None = Field(
        default=None,
        description="the unit of the mesh's coordinates: m, mm, cm, um, in or ft",
        examples=['length_unit = "m"'],
    )

    @model_validator(mode="after")
    def _unit_of_the_mesh(self) -> Self:
        if self.mesh is not None and self.length_unit is None:
            words = "missing, expected the unit of the mesh's coordinates: m, mm, cm, um, in or ft"
            raise mistake(f'{words}; write e.g. length_unit = "m"', "length_unit")
        return self


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
    alpha: NotNegative = Field(
        default=0.0,
        description="mass-proportional damping, a finite number ≥ 0 in 1/s",
        examples=["alpha = 1.0"],
    )
    beta: NotNegative = Field(
        default=0.0,
        description="stiffness-proportional damping, a finite number ≥ 0 in s",
        examples=["beta = 1e-6"],
    )


class Units(Table):
    """The units that matrices are in."""

    length: LengthUnit = Field(default="m", description="m, mm, cm, um, in or ft", examples=['length = "mm"'])
    mass: Literal["kg", "t", "g", "mg", "lb", "slug", "slinch"] = Field(
        default="kg", description="kg, t, g, mg, lb, slug or slinch", examples=['mass = "t"']
    )
    time: Literal["s", "ms"] = Field(default="s", description="s or ms", examples=['time = "s"'])


class SystemTable(Table):
    """[system]: K, M and perhaps D of another program, in place of materials; the paths are absolute."""

    stiffness: FilePath = Field(description=_MATRIX_FILE, examples=['stiffness = "K.mtx"'])
    mass: FilePath = Field(description=_MATRIX_FILE, examples=['mass = "M.mtx"'])
    damping: FilePath | None = Field(default=None, description=_MATRIX_FILE, examples=['damping = "D.mtx"'])
    dofs: FilePath | None = Field(
        default=None,
        description="the path of a file that tells node and direction of each row, relative to the part file",
        examples=['dofs = "dofs.csv"'],
    )
    units: Units = Field(
        default=Units(),
        description="a table of length, mass and time, the matrices' units",
        examples=['units = { length = "mm", mass = "t", time = "s" }'],
    )


class Support(Table):
    """[[support]]: directions in which nodes are held, and the forces that this takes."""

    name: Name | None = Field(default=None, description=NAME, examples=['name = "clamp"'])
    at: At = Field(description=WHERE, examples=['at = "clamp"'])
    fix: Annotated[tuple[Direction, ...], AfterValidator(not_empty), AfterValidator(distinct)] = Field(
        description='a list of one or more of "x", "y", "z" and, with [system], "rx", "ry", "rz", none twice',
        examples=['fix = ["x", "y", "z"]'],
    )
    outputs: Annotated[
        tuple[Literal["reaction.x", "reaction.y", "reaction.z"], ...], AfterValidator(distinct)
    ] = Field(
        default=(),
        description="a list of reaction.x, reaction.y, reaction.z, none twice",
        examples=['outputs = ["reaction.x"]'],
    )

    @model_validator(mode="after")
    def _reactions(self) -> Self:
        if self.outputs and self.name is None:
            words = f"missing, outputs need it: expected {NAME}"
            raise mistake(f'{words}; write e.g. name = "clamp"', "name")
        for k, output in enumerate(self.outputs):
            if output[-1] not in self.fix:
                words = f'got "{output}", expected a direction that is in fix'
                raise mistake(f'{words}; remove it, or add "{output[-1]}" to fix', "outputs", k)
        return self
