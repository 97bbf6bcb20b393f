"""The sections of a Gmsh file as numbers in a row, whether they are written as text or binary."""

import re
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from .arrays import Floats, Ints
from .errors import MeshError

_CUT = "is the file cut off? export it again"


@dataclass(frozen=True)
class MshFile:
    """data: the whole file; version: its format; size: bytes of a node or element tag in binary 4.1."""

    data: bytes
    version: str
    binary: bool
    size: int


def open_msh(data: bytes) -> MshFile:
    """Read $MeshFormat. Raises MeshError: no Gmsh file, neither version 2.2 nor 4.1, the other byte order."""
    header = re.search(
        rb"^\$MeshFormat\s+([\d.]+) ([01]) ([48])[ \r]*\n(.{4})?", data, re.MULTILINE | re.DOTALL
    )
    if header is None:
        raise MeshError("got no $MeshFormat; expected a Gmsh mesh of version 2.2 or 4.1")
    version, binary = header[1].decode(), header[2] == b"1"
    if version not in ("2", "2.2", "4.1"):
        raise MeshError(
            f"got Gmsh format {version}, expected 2.2 or 4.1; convert: gmsh OLD -save -format msh41 -o NEW"
        )
    if binary and header[4] != b"\x01\0\0\0":
        raise MeshError("the binary Gmsh file is of the other byte order; write it as text (Mesh.Binary = 0)")
    return MshFile(data, version, binary, int(header[3]))


def section(msh: MshFile, name: str) -> bytes | None:
    """What stands between $name and $Endname; None where there is no such section."""
    start = re.search(rb"^\$%s[ \r]*\n" % name.encode(), msh.data, re.MULTILINE)
    if start is None:
        return None
    end = msh.data.find(b"$End" + name.encode(), start.end())
    if end < 0:
        raise MeshError(f"${name} has no $End{name}; {_CUT}")
    return msh.data[start.end() : end]


class Numbers:
    """Takes the numbers of a section one after the other; MeshError where they run out or are none."""

    def __init__(self, msh: MshFile, name: str) -> None:
        body = section(msh, name)
        if body is None:
            raise MeshError(f"got no ${name}; {_CUT}")
        self._name = name
        self._size = f"<u{msh.size}"
        self._body = body
        self._tokens = None if msh.binary else body.split()
        self._at = 0

    def line(self) -> int:
        """One number on a line of its own, which version 2 writes as text in binary files too."""
        if self._tokens is not None:
            return int(self.ints(1)[0])
        end = self._body.find(b"\n", self._at)
        text, self._at = self._body[self._at : end].strip(), end + 1
        if not text.isdigit():
            raise self._cut()
        return int(text)

    def ints(self, count: int) -> Ints:
        """C ints."""
        return self._take(count, "<i4").astype(np.int64, copy=False)

    def sizes(self, count: int) -> Ints:
        """Counts, and the tags of nodes and elements."""
        return self._take(count, self._size).astype(np.int64, copy=False)

    def floats(self, count: int) -> Floats:
        """Doubles."""
        return self._take(count, "<f8").astype(np.float64, copy=False)

    def tagged_points(self, count: int) -> tuple[Ints, Floats]:
        """tag x y z, `count` times, as version 2 writes nodes."""
        if self._tokens is not None:
            table = self.floats(4 * count).reshape(-1, 4)
            return table[:, 0].astype(np.int64), table[:, 1:]
        record = self._take(count, [("tag", "<i4"), ("x", "<f8", (3,))])
        return record["tag"].astype(np.int64), record["x"]

    def rest(self) -> Ints:
        """All ints that are left of a text."""
        return self.ints(len(self._tokens or ()) - self._at)

    @property
    def is_text(self) -> bool:
        return self._tokens is not None

    def _take(self, count: int, dtype: DTypeLike) -> NDArray[Any]:
        if self._tokens is None:
            return self._take_binary(max(count, 0), np.dtype(dtype))
        tokens = self._tokens[self._at : self._at + count]
        self._at += count
        if len(tokens) < count:
            raise self._cut()
        try:
            if dtype == "<f8":
                return np.array(list(map(float, tokens)), np.float64)
            return np.array(list(map(int, tokens)), np.int64)
        except (ValueError, OverflowError):
            raise self._cut() from None

    def _take_binary(self, count: int, dtype: np.dtype[Any]) -> NDArray[Any]:
        if self._at + count * dtype.itemsize > len(self._body):
            raise self._cut()
        taken = np.frombuffer(self._body[self._at : self._at + count * dtype.itemsize], dtype)
        self._at += taken.nbytes
        return taken

    def _cut(self) -> MeshError:
        return MeshError(f"${self._name} has fewer numbers than it announces, or something else; {_CUT}")
