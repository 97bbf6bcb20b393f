"""Nodes and elements of a deck: the data lines of *NODE and *ELEMENT as arrays."""

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .arrays import Floats, Ints
from .deck_lines import Keyword, Line
from .errors import MeshError
from .mesh import FAMILIES
from .notice import notice

_SOLID = re.compile(r"C3D(4|6|8|10|20)(R?)([A-Z]*)")
_FAMILY = {
    "4": "tet4",
    "6": "wedge6",
    "8": "hex8",
    "8R": "hex8r",
    "10": "tet10",
    "20": "hex20",
    "20R": "hex20r",
}
_OTHER_SOLID = re.compile(r"(C3D|AC3D|DC3D|F3D|Q3D|COH3D|CSS|SC[68]).*")


@dataclass(frozen=True)
class Elements:
    """Elements of one *ELEMENT: ids (c,), nodes (c, k) by number; family: None where they are no solids."""

    kind: str
    family: str | None
    ids: Ints
    nodes: Ints


def parse_nodes(keyword: Keyword) -> tuple[Ints, Floats]:
    """ids (n,), points (n, 3) of a *NODE; coordinates that are left out are 0.

    Raises MeshError: a line that is not "id, x, y, z", cylindrical or spherical coordinates.
    """
    system = keyword.options.get("SYSTEM", "R").upper()
    if system != "R":
        raise MeshError(f"{keyword.where}: *NODE has SYSTEM={system}; write rectangular coordinates x, y, z")
    table = _plain_table([line.text for line in keyword.data])
    if table is None:
        table = np.array([_node(line) for line in keyword.data], dtype=float).reshape(-1, 4)
    return table[:, 0].astype(np.int64), table[:, 1:]


def _plain_table(texts: Sequence[str]) -> Floats | None:
    """All lines at once, several times as fast as one by one; None where one is not plainly id, x, y, z."""
    if not all(text.count(",") == 3 for text in texts):
        return None
    try:
        numbers = list(map(float, _decimal(",".join(texts)).split(",")))
    except ValueError:
        return None
    return np.array(numbers, dtype=float).reshape(-1, 4) if all(map(_is_id, numbers[::4])) else None


def _node(line: Line) -> list[float]:
    """id, x, y, z; coordinates may be missing, and Abaqus allows the direction of a normal behind them."""
    try:
        values = [float(token) if token.strip() else 0.0 for token in _decimal(line.text).split(",")]
    except ValueError:
        values = []
    if not values or not _is_id(values[0]):
        raise MeshError(f"{line.where}: expected a node: id, x, y, z, got {line.text[:60]!r}")
    return [*values, 0.0, 0.0, 0.0][:4]


def _decimal(text: str) -> str:
    """Fortran may write 1.0D+00."""
    return text.upper().replace("D", "E")


def _is_id(number: float) -> bool:
    return number.is_integer() and 0.0 < number < 2.0**53  # beyond, doubles skip integers


def parse_elements(keyword: Keyword) -> Elements:
    """The elements of an *ELEMENT.

    A solid goes on over as many lines as its nodes need, any other element while its line ends in a comma.
    Raises MeshError: no type, no element, a solid that cannot be integrated, an element with more or fewer
        nodes than its type has.
    """
    kind = keyword.options.get("TYPE", "").upper()
    if not kind:
        raise MeshError(f"{keyword.where}: *ELEMENT without a type; write e.g. *ELEMENT, TYPE=C3D10")
    if not keyword.data:
        raise MeshError(f"{keyword.where}: *ELEMENT without elements; is the file cut off?")
    family = solid_family(kind, keyword.where)
    numbers = _others(keyword.data) if family is None else _solids(keyword.data, kind, FAMILIES[family])
    return Elements(kind, family, numbers[:, 0], numbers[:, 1:])


def solid_family(kind: str, where: str) -> str | None:
    """The family of an element type, None where it is no solid; a notice where the type says more."""
    match = _SOLID.fullmatch(kind)
    if match is None:
        if _OTHER_SOLID.fullmatch(kind):
            raise MeshError(
                f"{where}: {kind} elements cannot be integrated; write C3D4, C3D6, C3D8(R), C3D10 or C3D20(R)"
            )
        return None
    count, reduced, variant = match.groups()
    family = _FAMILY.get(count + reduced, _FAMILY[count])
    if variant or count + reduced not in _FAMILY:
        notice(f"{where}: {kind} is taken as {family}")
    return family


def whole_numbers(data: Sequence[Line], expected: str) -> Ints:
    """All numbers of the lines; a comma at the end of a line is allowed.

    Raises MeshError: the line that holds something else, and what was expected.
    """
    texts = [line.text.rstrip(", \t") for line in data]
    try:
        return np.array(list(map(int, ",".join(texts).split(","))) if texts else [], dtype=np.int64)
    except (ValueError, OverflowError):
        bad = next(line for line, text in zip(data, texts, strict=True) if not _WHOLE.fullmatch(text))
        raise MeshError(f"{bad.where}: expected {expected}, got {bad.text[:60]!r}") from None


_WHOLE = re.compile(r"\s*[+-]?\d{1,18}\s*(,\s*[+-]?\d{1,18}\s*)*")


def _solids(data: Sequence[Line], kind: str, k: int) -> Ints:
    """(c, 1 + k): id and nodes of each element; no line holds parts of two elements."""
    counts = [line.text.rstrip(", \t").count(",") + 1 for line in data]
    ends = np.cumsum(counts, dtype=np.int64)
    element = (ends - 1) // (k + 1)  # that of the last number of each line
    if ((ends - counts) // (k + 1) != element).any() or sum(counts) % (k + 1):
        raise _wrong_count(data, counts, kind, k)
    return whole_numbers(data, f"{kind}: id and {k} nodes").reshape(-1, k + 1)


def _wrong_count(data: Sequence[Line], counts: Sequence[int], kind: str, k: int) -> MeshError:
    """The error that names the first element which does not end where a line ends."""
    first = total = 0
    for number, count in enumerate(counts):
        if total + count > k + 1:
            break
        total += count
        if total == k + 1:
            first, total = number + 1, 0
    got = (total or counts[first]) - 1
    element = data[first].text.split(",")[0].strip()
    return MeshError(
        f"{data[first].where}: element {element} of type {kind} has {got} nodes, expected {k}; "
        + ("is the file cut off?" if got < k else "is the type right?")
    )


def _others(data: Sequence[Line]) -> Ints:
    """(c, 1 + k): id and nodes of each element; shorter ones repeat their last number."""
    rows: list[list[int]] = []
    goes_on = False
    for line in data:
        tokens = [token for token in line.text.split(",") if token.strip()]
        numbers = whole_numbers([Line(",".join(tokens), line.where)], "an element: id and nodes").tolist()
        if goes_on:
            rows[-1] += numbers
        else:
            rows.append(numbers)
        goes_on = line.text[-1] == ","
    k = max(map(len, rows), default=1)
    return np.array([row + row[-1:] * (k - len(row)) for row in rows], dtype=np.int64).reshape(-1, k)
