"""[[port]], [[pair]], [energy]: the tables of a part file that name the FMU's inputs and outputs."""

from typing import Annotated, Literal, Self, TypeAlias

from pydantic import AfterValidator, Field, model_validator

from fmu_src.runtime.kinds import ORDINARY_INPUTS, ORDINARY_OUTPUTS

from .at_table import WHERE, At
from .part_values import NAME, Name, distinct
from .port_rows import DRIVEN
from .toml_table import Table, mistake, not_empty, one_of, shown

RELATIVE_KINDS = (
    *("displacement", "velocity", "acceleration"),
    *("rotation", "angular_velocity", "angular_acceleration"),
)
OUTPUTS = tuple(ORDINARY_OUTPUTS)
RELATIVE_OUTPUTS = tuple(output for output in OUTPUTS if output.split(".")[0] in RELATIVE_KINDS)

Input: TypeAlias = Annotated[str, one_of(tuple(ORDINARY_INPUTS))]
Output: TypeAlias = Annotated[str, one_of(OUTPUTS)]
RelativeOutput: TypeAlias = Annotated[str, one_of(RELATIVE_OUTPUTS)]
PUSHED = {"force": "motion", "moment": "angular_motion"}
_RELATIVE = ", ".join(RELATIVE_KINDS)


class Port(Table):
    """[[port]]: where the part meets the rest of the system."""

    name: Name = Field(description=NAME, examples=['name = "tip"'])
    at: At = Field(description=WHERE, examples=["at = { point = [1.0, 0.0, 0.0] }"])
    inputs: Annotated[tuple[Input, ...], AfterValidator(distinct)] = Field(
        default=(),
        description="a list of force, moment, motion and angular_motion, each with .x, .y or .z, and "
        "pressure, none twice",
        examples=['inputs = ["force.z"]'],
    )
    outputs: Annotated[tuple[Output, ...], AfterValidator(distinct)] = Field(
        default=(),
        description=f"a list of {_RELATIVE}, absolute_acceleration, reaction, reaction_moment, action, "
        "action_moment, each with .x, .y or .z, and stress with .xx, .yy, .zz, .xy, .yz, .zx or .mises, none "
        "twice",
        examples=['outputs = ["displacement.z"]'],
    )
    weights: Literal["area", "equal"] = Field(
        default="area", description='"area" or "equal"', examples=['weights = "area"']
    )
    kind: Literal["average", "rigid"] = Field(
        default="average", description='"average" or "rigid"', examples=['kind = "rigid"']
    )

    @model_validator(mode="after")
    def _motions(self) -> Self:
        """In each direction a port is pushed or moved; what moves it feels a reaction."""
        for k, key in enumerate(self.inputs):
            kind, _, axis = key.partition(".")
            if kind in PUSHED and (moved := f"{PUSHED[kind]}.{axis}") in self.inputs:
                words = (
                    f"got {shown(key)} beside {shown(moved)}, expected one of the two: a port is pushed or"
                )
                raise mistake(f"{words} moved; remove one", "inputs", k)
        for k, key in enumerate(self.outputs):
            kind, _, axis = key.partition(".")
            if kind in DRIVEN and (moved := f"{DRIVEN[kind]}.{axis}") not in self.inputs:
                words = (
                    f"got {shown(key)} without the input {shown(moved)}, expected both: what prescribes the"
                )
                raise mistake(
                    f"{words} motion feels the reaction; add {shown(moved)} to inputs", "outputs", k
                )
        return self

    @model_validator(mode="after")
    def _rigid_ports(self) -> Self:
        if self.kind == "average":
            return self
        mend = 'remove it, or write kind = "average"'
        if "weights" in self.model_fields_set:
            words = f"got {shown(self.weights)} at a rigid port, expected none: its nodes move as one body"
            raise mistake(f"{words}; {mend}", "weights")
        for k, output in enumerate(self.outputs):
            if output.startswith("stress."):
                words = f"got {shown(output)} at a rigid port, expected a motion: it does not deform"
                raise mistake(f"{words}; {mend}", "outputs", k)
        return self


class Pair(Table):
    """[[pair]]: the motion of the second of two ports relative to the first."""

    name: Name = Field(description=NAME, examples=['name = "gap"'])
    ports: Annotated[tuple[str, str], AfterValidator(distinct)] = Field(
        description="the names of two different ports [a, b]: the outputs are b minus a",
        examples=['ports = ["root", "tip"]'],
    )
    outputs: Annotated[tuple[RelativeOutput, ...], AfterValidator(not_empty), AfterValidator(distinct)] = (
        Field(
            description=f"a list of one or more of {_RELATIVE}, each with .x, .y or .z, none twice",
            examples=['outputs = ["displacement.z"]'],
        )
    )


class Energy(Table):
    """[energy]: the part's energies in J."""

    outputs: Annotated[
        tuple[Literal["kinetic", "strain"], ...], AfterValidator(not_empty), AfterValidator(distinct)
    ] = Field(
        default=(),
        description='a list of "kinetic", "strain" or both, none twice',
        examples=['outputs = ["kinetic", "strain"]'],
    )
