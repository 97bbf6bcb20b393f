"""The key `at` of a part file: where a support or a port is."""

from typing import Annotated, Any, Literal, TypeAlias

from pydantic import AfterValidator, Field, PlainValidator

from .part_values import Number
from .selection import Box, NamedSet, Nodes, Plane, Point, Selection
from .toml_table import Table, exactly_one, mistake, not_empty

Coordinates: TypeAlias = tuple[Number, Number, Number]
NodeId: TypeAlias = Annotated[int, Field(strict=True, ge=0, lt=2**63)]
WHERE = "the name of a set, or a table with one of point, box, plane, nodes"


def _low_to_high(box: tuple[Coordinates, Coordinates]) -> tuple[Coordinates, Coordinates]:
    if any(low > high for low, high in zip(*box, strict=True)):
        raise ValueError(box)
    return box


class PlaneTable(Table):
    """plane = { normal = "x", at = 0.0 }: the nodes with x = 0, in `length_unit`."""

    normal: Literal["x", "y", "z"] = Field(
        description="the direction x, y or z", examples=['plane = { normal = "x", at = 0.0 }']
    )
    at: Number = Field(
        description="a finite coordinate in length_unit", examples=['plane = { normal = "x", at = 0.0 }']
    )


class AtTable(Table):
    """Exactly one of the four ways to say where without a name; coordinates in `length_unit`."""

    point: Coordinates | None = Field(
        default=None,
        description="three finite coordinates [x, y, z] in length_unit",
        examples=["point = [1.0, 0.0, 0.0]"],
    )
    box: Annotated[tuple[Coordinates, Coordinates], AfterValidator(_low_to_high)] | None = Field(
        default=None,
        description="two corners [[x, y, z], [x, y, z]] in length_unit, none of the first's coordinates "
        "above the second's",
        examples=["box = [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0]]"],
    )
    plane: PlaneTable | None = Field(
        default=None,
        description="a table of normal and at",
        examples=['plane = { normal = "x", at = 0.0 }'],
    )
    nodes: Annotated[tuple[NodeId, ...], AfterValidator(not_empty)] | None = Field(
        default=None,
        description="a list of one or more node numbers, integers ≥ 0",
        examples=["nodes = [17, 18]"],
    )


def selection(at: Any) -> Selection:
    """The name of a set, or a table as AtTable, as what `select_nodes` takes."""
    if isinstance(at, Selection):
        return at
    if isinstance(at, str):
        if not at.strip():
            raise mistake('got an empty name, expected the name of a set; write e.g. at = "clamp"')
        return NamedSet(at)
    table = AtTable.model_validate(at)
    exactly_one(sorted(table.model_fields_set), "point, box, plane, nodes")
    if table.point is not None:
        return Point(table.point)
    if table.box is not None:
        return Box(*table.box)
    if table.plane is not None:
        return Plane(table.plane.normal, table.plane.at)
    assert table.nodes is not None  # the one that is left
    return Nodes(table.nodes)


At: TypeAlias = Annotated[Selection, PlainValidator(selection)]
