"""Names of node and cell sets, and what to say where there is none of the name."""

from collections.abc import Iterable, Mapping
from difflib import get_close_matches
from typing import Protocol

from .arrays import Floats, Ints


class Source(Protocol):
    """What nodes are selected from: a Mesh, or the NodeTable of imported matrices.

    points: (n, 3) in m, NaN where a place is not known; node_ids: (n,); cells and sets as in Mesh, empty
    where there is no mesh.
    """

    @property
    def points(self) -> Floats:
        """(n, 3), m."""

    @property
    def node_ids(self) -> Ints:
        """(n,)."""

    @property
    def cells(self) -> Mapping[str, Ints]:
        """Family → (c, k) rows of points."""

    @property
    def node_sets(self) -> Mapping[str, Ints]:
        """Name → rows of points."""

    @property
    def cell_sets(self) -> Mapping[str, Mapping[str, Ints]]:
        """Name → family → rows of its cells."""


def spelled(name: str, names: Iterable[str]) -> str | None:
    """The name as the mesh spells it; decks know no case, so one that differs in case alone will do."""
    names = list(names)
    if name in names:
        return name
    alike = [known for known in names if known.casefold() == name.casefold()]
    return alike[0] if len(alike) == 1 else None


def sets_of(source: Source, wanted: str = "") -> str:
    """The names of all sets, the one meant by `wanted` first; what else to do where there is no set."""
    if not source.cells:
        return "matrices bring no sets; select by nodes = [numbers], or give their mesh"
    return choice("set", list(dict.fromkeys([*source.node_sets, *source.cell_sets])), wanted)


def choice(what: str, names: Iterable[str], wanted: str) -> str:
    """did you mean 'clamp'? the mesh has the sets 'clamp', 'tip'."""
    names = sorted(names)
    if not names:
        return (
            f"the mesh has no {what}: name groups where it is made, or select by point, box, plane or nodes"
        )
    near = get_close_matches(wanted.casefold(), [name.casefold() for name in names], n=1)
    meant = [name for name in names if near and name.casefold() == near[0]]
    hint = f"did you mean {meant[0]!r}? " if meant else ""
    return f"{hint}the mesh has the {what}s {shortened([repr(name) for name in names])}"


def shortened(items: list[str] | list[int], most: int = 20) -> str:
    """The first of them, and how many there are."""
    more = f" … ({len(items)} in all)" if len(items) > most else ""
    return ", ".join(map(str, items[:most])) + more
