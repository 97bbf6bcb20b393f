"""The lines of an Abaqus or CalculiX deck, gathered under their keywords.

A keyword line begins with *, commas separate its options; the data lines below belong to it; ** is a comment.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from .errors import MeshError

_MESH_DATA = ("NODE", "ELEMENT", "NSET", "ELSET", "SURFACE")  # these may take their data lines from a file


class Line(NamedTuple):
    """One line without surrounding blanks; where: its number, and its file unless that is the deck itself."""

    text: str
    where: str


@dataclass(frozen=True)
class Keyword:
    """name and the keys of options in capitals without blanks, values as written; data: the lines below.

    level: "" in a flat deck, else "part" or "assembly".
    """

    name: str
    options: Mapping[str, str]
    data: Sequence[Line]
    where: str
    level: str = ""


def read_keywords(path: Path) -> list[Keyword]:
    """All keywords of the deck and the files it includes, in order.

    Lines before the first keyword are passed over.
    Raises MeshError: a file that cannot be read or includes itself, no keyword at all.
    """
    keywords: list[Keyword] = []
    data: list[Line] = []
    for line in _joined(_read_lines(path, path.parent, ())):
        if line.text[0] == "*":
            data = []
            keywords.append(_keyword(line, data))
        else:
            data.append(line)
    if not keywords:
        raise MeshError("got no keyword; expected a deck with *NODE and *ELEMENT")
    return keywords


def _read_lines(path: Path, folder: Path, above: tuple[Path, ...]) -> Iterator[Line]:
    """The lines that are no comments, with included files (relative to the deck's folder) in their place."""
    if path.resolve() in above:
        raise MeshError(f"{path.name} includes itself; take out that *INCLUDE")
    file = f"{path.name} line" if above else "line"
    above = (*above, path.resolve())
    try:
        lines = path.read_text(encoding="utf-8-sig", errors="replace").splitlines()
    except OSError as error:
        raise MeshError(
            f"cannot read {path}: {error.strerror}; give the path of a file relative to the deck"
        ) from None
    for number, text in enumerate(lines, 1):
        text = text.strip()
        if not text or text.startswith("**"):
            continue
        line = Line(text, f"{file} {number}")
        if text[0] != "*":
            yield line
            continue
        keyword = _keyword(line, ())
        if keyword.name != "INCLUDE":
            yield line
        if keyword.name == "INCLUDE" or (keyword.name in _MESH_DATA and "INPUT" in keyword.options):
            if not keyword.options.get("INPUT"):
                raise MeshError(f"{line.where}: expected *INCLUDE, INPUT=file, got {text!r}")
            yield from _read_lines(folder / keyword.options["INPUT"].replace("\\", "/"), folder, above)


def _joined(lines: Iterator[Line]) -> Iterator[Line]:
    """A keyword line that ends in a comma goes on in the next line if that holds an option."""
    held: Line | None = None
    for line in lines:
        if held is not None:
            if "=" in line.text and line.text[0] != "*":
                line = Line(held.text + line.text, held.where)
            else:
                yield held
            held = None
        if line.text[0] == "*" and line.text[-1] == ",":
            held = line
        else:
            yield line
    if held is not None:
        yield held


def _keyword(line: Line, data: Sequence[Line]) -> Keyword:
    name, *options = line.text[1:].split(",")
    pairs = (option.partition("=") for option in options)
    return Keyword(
        name="".join(name.split()).upper(),
        options={"".join(key.split()).upper(): value.strip().strip("\"'") for key, _, value in pairs},
        data=data,
        where=line.where,
    )


def part_level(keywords: Sequence[Keyword]) -> list[Keyword]:
    """A deck with *PART, *ASSEMBLY and *INSTANCE as a flat one; a flat deck stays as it is.

    Nodes and elements of the assembly itself (reference points, connectors) have numbers of their own and are
    left out, as are these numbers in its sets; sets of the assembly that name the instance stay.
    Raises MeshError: more than one part or instance, an instance that is moved.
    """
    flat: list[Keyword] = []
    count = {"PART": 0, "INSTANCE": 0}
    level = ""
    for keyword in keywords:
        if keyword.name in count:
            count[keyword.name] += 1
            if count[keyword.name] > 1:
                raise MeshError(
                    f"{keyword.where}: got a second *{keyword.name}, expected one part; write it alone"
                )
        if keyword.name == "INSTANCE" and any(_moves(line) for line in keyword.data):
            raise MeshError(
                f"{keyword.where}: the instance is translated or rotated; place the part itself instead"
            )
        if keyword.name in ("PART", "INSTANCE"):
            level = "part"
        elif keyword.name in ("ASSEMBLY", "ENDINSTANCE"):
            level = "assembly"
        elif keyword.name in ("ENDPART", "ENDASSEMBLY"):
            level = ""
        of_assembly = level == "assembly" and "INSTANCE" not in keyword.options
        if of_assembly and keyword.name in ("NODE", "ELEMENT"):
            continue
        data = keyword.data
        if of_assembly and keyword.name in ("NSET", "ELSET"):
            data = [line for line in data if "." in line.text]  # instance.set: the part's
        flat.append(Keyword(keyword.name, keyword.options, data, keyword.where, level))
    return flat


def _moves(line: Line) -> bool:
    """Data of *INSTANCE: a translation of 3 numbers, then two points and an angle about their axis."""
    try:
        numbers = [float(token) for token in line.text.split(",") if token.strip()]
    except ValueError:
        return False
    return any(numbers[6:] if len(numbers) > 6 else numbers)
