"""What is joined to what: every connection resolved and checked against the FMUs."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import isfinite

from .errors import SspError
from .notice import notice
from .spring_damper import ENDS
from .ssp_elements import Element
from .ssp_file import SystemFile
from .ssp_units import Unit, conversion, same_unit, unit_of
from .toml_table import nearest


@dataclass(frozen=True)
class End:
    """A connector of a component, or of the system itself (element "")."""

    element: str
    connector: str

    def __str__(self) -> str:
        return f"{self.element}.{self.connector}" if self.element else self.connector


@dataclass(frozen=True)
class Wire:
    """target = factor · source + offset.

    unit: of the target, of the source where that is the system's; converted: source and target have different
    units, and factor and offset go from one to the other; where: the key in the system file.
    """

    source: End
    target: End
    factor: float
    offset: float
    unit: Unit | None
    where: str
    converted: bool = False

    @property
    def is_plain(self) -> bool:
        """The value goes over as it is."""
        return self.factor == 1.0 and self.offset == 0.0


def wires_of(file: SystemFile, elements: Mapping[str, Element]) -> list[Wire]:
    """All connections, in the order connection, spring_damper, input, output of the file.

    Raises SspError: a variable that a component does not have, one that is no output or input or no Real,
    units that do not measure the same, an input with two sources.
    """
    wires = [*_connections(file, elements), *_joints(file, elements), *_connectors(file, elements)]
    sources: dict[End, Wire] = {}
    for wire in wires:
        if wire.target in sources:
            other = sources[wire.target]
            raise SspError(
                f"{wire.where}: {wire.target} gets {wire.source}, and {other.source} by {other.where} too, "
                "expected one source for an input; remove one of them"
            )
        sources[wire.target] = wire
        if not wire.is_plain:
            notice(
                f"{wire.where}: {wire.target} = {wire.factor:g} · {wire.source} + {wire.offset:g}: FMPy and "
                "fmucontainer do not do that, they pass on the value as it is"
            )
    return wires


def _connections(file: SystemFile, elements: Mapping[str, Element]) -> Iterator[Wire]:
    for k, connection in enumerate(file.connection):
        where = f"connection[{k + 1}]"
        source = _end(elements, connection.source, "output", f"{where}.from")
        target = _end(elements, connection.target, "input", f"{where}.to")
        yield _wire(elements, source, target, where, connection.factor, connection.offset)


def _joints(file: SystemFile, elements: Mapping[str, Element]) -> Iterator[Wire]:
    """The motions of both ports into a spring–damper, its forces out to the ports."""
    for k, joint in enumerate(file.spring_damper):
        face = elements[joint.name].face
        for i, (end, port) in enumerate(zip(ENDS, joint.ports or (), strict=False)):
            where = f"spring_damper[{k + 1}].ports[{i + 1}]"
            for name in face.inputs:
                if name.startswith(f"{end}."):
                    there = _at_port(elements, port, name.partition(".")[2], "output", where)
                    yield _wire(elements, there, End(joint.name, name), where)
            for name in face.outputs:
                if name.startswith(f"{end}."):
                    there = _at_port(elements, port, name.partition(".")[2], "input", where)
                    yield _wire(elements, End(joint.name, name), there, where)


def _at_port(elements: Mapping[str, Element], port: str, key: str, causality: str, where: str) -> End:
    """The variable `key` of a port that a spring takes hold of."""
    element, _, name = port.partition(".")
    variables = elements[element].face.variables
    if f"{name}.{key}" in variables:
        return _end(elements, f"{port}.{key}", causality, where)
    ports = [
        f"{element}.{name.removesuffix(f'.{key}')}"
        for name, variable in variables.items()
        if name.endswith(f".{key}") and variable.causality == causality
    ]
    near = f", or did you mean {nearest(port, ports)}?" if ports else ""
    raise SspError(
        f"{where}: {port} has no {causality} {key!r}, which the spring or damper needs in that direction; "
        f'add "{key}" to the {causality}s of the port, or leave the direction out{near}'
    )


def _connectors(file: SystemFile, elements: Mapping[str, Element]) -> Iterator[Wire]:
    """From and to the connectors of the system itself, whose units are those of what they go to."""
    for k, entry in enumerate(file.input):
        for i, text in enumerate(entry.to):
            where = f"input[{k + 1}].to[{i + 1}]"
            target = _end(elements, text, "input", where)
            unit = unit_of(elements[target.element].face, target.connector)
            first = _end(elements, entry.to[0], "input", where)
            other = unit_of(elements[first.element].face, first.connector)
            if unit != other and not (unit and other and same_unit(unit, other)):
                raise SspError(
                    f"{where}: {target} is in {_name(unit)}, {first} in {_name(other)}, expected one unit "
                    f"for the input {entry.name}; make two inputs of it"
                )
            yield Wire(End("", entry.name), target, 1.0, 0.0, unit, where)
    for k, exit_ in enumerate(file.output):
        where = f"output[{k + 1}].from"
        source = _end(elements, exit_.source, "output", where)
        unit = unit_of(elements[source.element].face, source.connector)
        yield Wire(source, End("", exit_.name), 1.0, 0.0, unit, where)


def _end(elements: Mapping[str, Element], text: str, causality: str, where: str) -> End:
    """The Real input or output that `text` names."""
    element, _, name = text.partition(".")
    face = elements[element].face
    known = [v.name for v in face.variables.values() if v.causality == causality and v.type == "Real"]
    if name in known:
        return End(element, name)
    variable = next((v for v in face.description.modelVariables if v.name == name), None)
    if variable is None:
        got = f"{element} has no {causality} {name!r}"
    elif variable.causality != causality:
        got = f"got {text}, of causality {variable.causality}, expected an {causality} of {element}"
    else:
        got = f"got {text}, of type {variable.type}, expected a Real"
    mend = (
        f"did you mean {element}.{nearest(name, known)}?" if known else f"{element} has no Real {causality}"
    )
    raise SspError(f"{where}: {got}; {mend}")


def _wire(
    elements: Mapping[str, Element],
    source: End,
    target: End,
    where: str,
    factor: float = 1.0,
    offset: float = 0.0,
) -> Wire:
    """A connection whose units fit: what converts them comes before `factor` and `offset`."""
    a, b = (unit_of(elements[end.element].face, end.connector) for end in (source, target))
    if a is None or b is None:
        if (a is None) != (b is None):
            which, unit = (source, b) if a is None else (target, a)
            notice(f"{where}: {which} has no unit; taken as {_name(unit)}")
        return Wire(source, target, factor, offset, b or a, where)
    found = conversion(a, b)
    if found is None:
        raise SspError(f"{where}: {source} is in {a.name}, {target} in {b.name}, {_mend(a, b, target)}")
    f, o = factor * found[0], factor * found[1] + offset
    if not (isfinite(f) and isfinite(o)):
        raise SspError(
            f"{where}: from {a.name} to {b.name} factor and offset are beyond all numbers; lower them"
        )
    return Wire(source, target, f, o, b, where, not same_unit(a, b))


def _mend(a: Unit, b: Unit, target: End) -> str:
    if a.is_motion and b.is_load:
        return (
            "expected a force or moment; to join two ports that take forces put a [[spring_damper]] between "
            f'them, or give that of {target.element} inputs = ["motion.…"], which tell it how to move'
        )
    if a.is_load and b.is_motion:
        return f"expected a motion: this input tells {target.element} how to move"
    if a.exponents is None or b.exponents is None:
        return "expected one unit: an FMU does not define its own, so it cannot be converted"
    return "expected units of one quantity"


def _name(unit: Unit | None) -> str:
    return "no unit" if unit is None else unit.name
