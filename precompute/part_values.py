"""The values that several tables of a part file have in common."""

from pathlib import Path
from typing import Annotated, Any, Literal, TypeAlias, TypeVar

from pydantic import AfterValidator, BeforeValidator, Field, TypeAdapter, ValidationInfo

Item = TypeVar("Item")

# First words of the FMU's other variables.
RESERVED = ("modes", "damping", "energy", "gravity", "base", "der", "time")


def distinct(items: tuple[Item, ...]) -> tuple[Item, ...]:
    """Raise where one item is there twice."""
    if len(set(items)) != len(items):
        raise ValueError(items)
    return items


def _unreserved(name: str) -> str:
    if name in RESERVED:
        raise ValueError(name)
    return name


def _ascending(band: tuple[float, float]) -> tuple[float, float]:
    if not band[0] < band[1]:
        raise ValueError(band)
    return band


# One line; U+FFFE and U+FFFF cannot stand in XML.
Text: TypeAlias = Annotated[str, Field(pattern=r"^[^\p{Cc}\p{Zl}\p{Zp}\uFFFE\uFFFF]+$")]
_TEXT: TypeAdapter[str] = TypeAdapter(Text)


def _beside_the_part(name: Any, info: ValidationInfo) -> Path:
    return Path(info.context or "", _TEXT.validate_python(name))


FilePath: TypeAlias = Annotated[Path, BeforeValidator(_beside_the_part)]
"""A file's name as an absolute path; the context of the validation is the part file's folder."""

Identifier: TypeAlias = Annotated[str, Field(pattern=r"^[A-Za-z_][A-Za-z0-9_]*$")]
Name: TypeAlias = Annotated[Identifier, AfterValidator(_unreserved)]
"""The first word of a variable's name."""
NAME = "a C identifier (letters, digits and _, no digit first) other than " + ", ".join(RESERVED)

Axis: TypeAlias = Literal["x", "y", "z"]
Direction: TypeAlias = Literal["x", "y", "z", "rx", "ry", "rz"]
LengthUnit: TypeAlias = Literal["m", "mm", "cm", "um", "in", "ft"]

Number: TypeAlias = Annotated[float, Field(strict=True, allow_inf_nan=False)]
NotNegative: TypeAlias = Annotated[Number, Field(ge=0)]
# Far beyond any part, and (2πf)², 1/(2h) and ratios of them stay far from overflow.
Hertz: TypeAlias = Annotated[Number, Field(ge=1e-9, le=1e12)]
Seconds: TypeAlias = Annotated[Number, Field(ge=1e-12, le=1e9)]
_UpTo: TypeAlias = Annotated[Number, Field(ge=0, le=1e12)]
Band: TypeAlias = Annotated[tuple[_UpTo, _UpTo], AfterValidator(_ascending)]
"""Lowest and highest frequency in Hz."""
BAND = "two frequencies [lowest, highest] in Hz, 0 ≤ lowest < highest (up to 1e12)"
