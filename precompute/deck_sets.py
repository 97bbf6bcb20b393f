"""Named sets of a deck: *NSET and *ELSET, and the options NSET and ELSET of *NODE and *ELEMENT."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from .arrays import Ints
from .deck_cells import whole_numbers
from .deck_lines import Keyword, Line
from .errors import MeshError
from .notice import notice

_NUMBERS = frozenset("0123456789, \t")
Lookup = Callable[[str], Ints | None]  # name of a set, in any case → its ids, None where there is no such set


def lookup(sets: Mapping[str, Ints]) -> Lookup:
    """A deck knows no case: clamp finds CLAMP."""
    return {name.upper(): ids for name, ids in sets.items()}.get


def named_ids(
    keywords: Sequence[Keyword],
    kind: str,
    members: Mapping[int, Ints],
    existing: Ints,
    nodes_of: Lookup,
) -> dict[str, Ints]:
    """name, spelt as at its first appearance → sorted unique ids: all sets of a kind, "NSET" or "ELSET".

    members: number of a keyword → the ids it defines itself (*NODE, *ELEMENT); existing: all of these ids;
    nodes_of: the nodes of an element set (for *NSET, ELSET=name).
    A set of the assembly hides the part's of the same name.
    Raises MeshError: a set without a name, or of a set that is not defined above it.
    """
    found: dict[str, Ints] = {}
    spelling: dict[str, tuple[str, str]] = {}
    for number, keyword in enumerate(keywords):
        name = keyword.options.get(kind, "")
        if number in members and not name:
            continue
        if number in members:
            ids = members[number]
        elif keyword.name != kind:
            continue
        elif not name:
            raise MeshError(f"{keyword.where}: *{kind} without a name; write *{kind}, {kind}=name")
        elif kind == "NSET" and "ELSET" in keyword.options:
            ids = _known(nodes_of, keyword.options["ELSET"], keyword.where)
        elif "GENERATE" in keyword.options:
            ids = _generated(keyword.data, existing)
        else:
            ids = _listed(keyword.data, found.get)
        key = name.upper()
        spelt, level = spelling.setdefault(key, (name, keyword.level))
        if level != keyword.level:
            notice(f"{keyword.where}: the assembly's set {name!r} hides the part's set of that name")
            spelling[key] = (spelt, keyword.level)
        elif key in found:
            ids = np.concatenate([found[key], ids])
        found[key] = np.unique(ids)
    return {spelling[key][0]: ids for key, ids in found.items()}


def _known(sets: Lookup, name: str, where: str) -> Ints:
    ids = sets(name.upper())
    if ids is None:
        raise MeshError(
            f"{where}: got the set {name!r}, which is not defined above; define it before it is used"
        )
    return ids


def _generated(data: Sequence[Line], existing: Ints) -> Ints:
    """first, last, step (1 where left out) on each line: those of the ids that exist."""
    parts = [np.zeros(0, np.int64)]
    for line in data:
        numbers = whole_numbers([line], "first, last, step of GENERATE").tolist()
        first, last, step = [*numbers, 1][:3] if len(numbers) in (2, 3) else (0, 0, 0)
        if step < 1:
            raise MeshError(f"{line.where}: expected first, last, step of GENERATE, got {line.text!r}")
        parts.append(existing[(existing >= first) & (existing <= last) & ((existing - first) % step == 0)])
    return np.concatenate(parts)


def _listed(data: Sequence[Line], sets: Lookup) -> Ints:
    """Ids and names of other sets; "instance.name" stands for the name."""
    plain = [set(line.text) <= _NUMBERS for line in data]
    ids = whole_numbers([line for line, is_plain in zip(data, plain, strict=True) if is_plain], "numbers")
    parts = [ids]
    for line in (line for line, is_plain in zip(data, plain, strict=True) if not is_plain):
        for token in filter(None, (token.strip().strip("\"'") for token in line.text.split(","))):
            name = token.rpartition(".")[2]
            parts.append(
                np.array([int(name)], np.int64) if name.isdecimal() else _known(sets, name, line.where)
            )
    return np.concatenate(parts)
