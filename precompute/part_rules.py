"""What the tables of a part file must be to one another.

Each check raises a mistake whose place is relative to the whole file.
"""

from collections.abc import Iterable, Sequence
from typing import TypeAlias

from .damping_table import DampingForm
from .load_tables import Loads
from .mode_tables import Basis
from .part_tables import Heading, Material, Support, SystemTable
from .port_rows import DRIVEN
from .port_tables import Energy, Pair, Port
from .toml_table import mistake, nearest, shown

Reference: TypeAlias = tuple[str, tuple[str | int, ...]]
"""The name of a port, and the place where it is named."""


def check_source(
    part: Heading, materials: Sequence[Material], system: SystemTable | None, supports: Sequence[Support]
) -> None:
    """The body is a mesh with materials, or [system], to which a mesh may be added."""
    if system is not None and materials:
        words = "got materials beside [system], expected one of the two: matrices have their material in them"
        raise mistake(f"{words}; remove [[material]] or [system]", "material")
    if system is not None:
        return
    if part.mesh is None:
        words = "missing, expected the path of a mesh file, relative to the part file (or a table [system])"
        raise mistake(f'{words}; write e.g. mesh = "beam.msh"', "part", "mesh")
    if not materials:
        words = "missing, expected one table [[material]] (two brackets) or more"
        raise mistake(f'{words}; write e.g. [[material]], name = "steel"', "material")
    for k, support in enumerate(supports):
        for i, direction in enumerate(support.fix):
            if direction.startswith("r"):
                words = f'got "{direction}" without [system], expected "x", "y" or "z": solid cells have no'
                raise mistake(f"{words} rotations; hold several nodes in x, y, z", "support", k, "fix", i)


def check_materials(materials: Sequence[Material], damping: DampingForm) -> None:
    """Names of their own, cells in all but one; their damping adds to α and β and to no other form."""
    own_names(("material", k, material.name) for k, material in enumerate(materials))
    rest = [k for k, material in enumerate(materials) if material.cells is None]
    if len(rest) > 1:
        words = f"missing here and in material[{rest[0] + 1}], expected it in all materials but one"
        raise mistake(f'{words}; add e.g. cells = "body"', "material", rest[1], "cells")
    if damping.other_form is None:
        return
    for k, material in enumerate(materials):
        for key in sorted(material.model_fields_set & {"alpha", "beta"}):
            words = f"got {shown(getattr(material, key))} beside damping.{damping.other_form}, expected one"
            raise mistake(
                f"{words} of the two: ratios hold for the whole part; remove one", "material", k, key
            )


def check_names(ports: Sequence[Port], pairs: Sequence[Pair], supports: Sequence[Support]) -> None:
    """Ports, pairs and named supports are the first words of variables: each name once."""
    tables: tuple[tuple[str, Sequence[Port | Pair | Support]], ...] = (
        ("port", ports),
        ("pair", pairs),
        ("support", supports),
    )
    own_names(
        (table, k, item.name)
        for table, items in tables
        for k, item in enumerate(items)
        if item.name is not None
    )


def check_ports(ports: Sequence[Port], references: Iterable[Reference]) -> None:
    """The ports that others name exist, and each port has a purpose."""
    known = [port.name for port in ports]
    used = set()
    for name, place in references:
        if name not in known:
            mend = f"did you mean {nearest(name, known)}?" if known else "add a [[port]]"
            raise mistake(f"got {shown(name)}, expected the name of a [[port]]; {mend}", *place)
        used.add(name)
    for k, port in enumerate(ports):
        if not (port.inputs or port.outputs or port.name in used):
            words = "got neither inputs nor outputs, nor a pair, spring, dashpot or mass at it, expected"
            raise mistake(f'{words} at least one of them; write e.g. inputs = ["force.z"]', "port", k)


def check_variables(
    ports: Sequence[Port],
    supports: Sequence[Support],
    loads: Loads,
    energy: Energy,
    system: SystemTable | None,
) -> None:
    """There is an input or an output, and each of the ports' is to be had."""
    if not (ports or loads.gravity or loads.base or energy.outputs or any(s.outputs for s in supports)):
        words = "missing, expected one table [[port]] (two brackets) or more"
        raise mistake(f'{words}; write e.g. [[port]], name = "tip"', "port")
    for k, port in enumerate(ports):
        places = [(name, ("port", k, "inputs", i)) for i, name in enumerate(port.inputs)]
        places += [(name, ("port", k, "outputs", i)) for i, name in enumerate(port.outputs)]
        for name, place in places:
            kind, _, axis = name.partition(".")
            if system is not None and kind in ("pressure", "stress"):
                words = f"got {shown(name)} with [system], expected a force, moment or motion"
                raise mistake(f"{words}: {kind} needs a mesh with materials; remove it", *place)
            if kind == "absolute_acceleration" and not loads.base:
                words = f"got {shown(name)} but no base in [loads], expected both"
                mend = f'write acceleration.{axis}, or add [loads], base = ["{axis}"]'
                raise mistake(f"{words}; {mend}", *place)


def check_motions(ports: Sequence[Port], basis: Basis) -> None:
    """Polynomials know nothing of ports that are held."""
    moved = [
        f"{port.name}.{key}" for port in ports for key in port.inputs if key.split(".")[0] in DRIVEN.values()
    ]
    if moved and basis.kind == "polynomial":
        words = (
            f'got "polynomial" with the input {shown(moved[0])}, expected a basis in which ports can be held'
        )
        raise mistake(f'{words}; write e.g. kind = "craig-bampton"', "basis", "kind")


def own_names(named: Iterable[tuple[str, int, str]]) -> None:
    """Raise where two of (table, place, name) have one name."""
    seen: dict[str, str] = {}
    for table, k, name in named:
        if name in seen:
            words = f"got {shown(name)}, the name of {seen[name]} too, expected a new one; rename one of them"
            raise mistake(words, table, k, "name")
        seen[name] = f"{table}[{k + 1}]"
