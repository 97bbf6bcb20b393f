"""[loads], [[spring]], [[dashpot]], [[mass]]: what acts on the part beside the inputs of its ports."""

from typing import Annotated, Self, TypeAlias

from pydantic import AfterValidator, Field, model_validator

from .part_values import Axis, Direction, Number, distinct
from .toml_table import Table, mistake, not_empty, shown

# Far beyond any part, and products of two of them stay far from overflow.
Constant: TypeAlias = Annotated[Number, Field(ge=1e-12, le=1e18)]


class Loads(Table):
    """[loads]: gravity.x … and base.acceleration.x …, inputs that act on the whole part."""

    gravity: Annotated[bool, Field(strict=True)] = Field(
        default=False,
        description="true or false (its size and direction are the inputs gravity.x, gravity.y, gravity.z)",
        examples=["gravity = true"],
    )
    base: Annotated[tuple[Axis, ...], AfterValidator(not_empty), AfterValidator(distinct)] = Field(
        default=(),
        description='a list of one to three of "x", "y", "z", none twice',
        examples=['base = ["x", "y", "z"]'],
    )


class PortElement(Table):
    """What is fixed to a port."""

    port: str = Field(description="the name of a [[port]]", examples=['port = "tip"'])


class Link(PortElement):
    """Between a port and the ground or, with `to`, another port; the ground moves with the base."""

    to: str | None = Field(
        default=None,
        description="the name of another [[port]]; leave it out for the ground",
        examples=['to = "root"'],
    )
    direction: Direction = Field(
        description='"x", "y" or "z", or a rotation about one of them: "rx", "ry" or "rz"',
        examples=['direction = "z"'],
    )

    @model_validator(mode="after")
    def _two_ends(self) -> Self:
        if self.to == self.port:
            words = f"got {shown(self.to)}, the same as port, expected another port"
            raise mistake(f"{words}; leave it out for the ground", "to")
        return self


class Spring(Link):
    """[[spring]]: F = −k (u_port − u_to), u_to = 0 for the ground; k in N/m, of rotations N.m/rad."""

    stiffness: Constant = Field(
        description="the stiffness in N/m (N.m/rad for rotations), a finite number > 0 (1e-12 to 1e18)",
        examples=["stiffness = 1e6"],
    )


class Dashpot(Link):
    """[[dashpot]]: F = −c (u̇_port − u̇_to), 0 for the ground; c in N.s/m, of rotations N.m.s/rad."""

    damping: Constant = Field(
        description="the damping in N.s/m (N.m.s/rad for rotations), a finite number > 0 (1e-12 to 1e18)",
        examples=["damping = 300.0"],
    )


class Mass(PortElement):
    """[[mass]]: a point mass (kg) that moves with the port in x, y and z."""

    mass: Constant = Field(
        description="the mass in kg, a finite number > 0 (1e-12 to 1e18)", examples=["mass = 2.5"]
    )
