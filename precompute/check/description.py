"""modelDescription.xml as the checks need it. A description that is not valid is read as far as it goes."""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree as ET

from ..errors import ModalFmuError

DESCRIPTION = "modelDescription.xml"
TYPES = ("Real", "Integer", "Boolean", "String", "Enumeration")
Value = float | int | bool | str
# initial, where it is left out: FMI 2.0.4, section 2.2.7
_EXACT = {("parameter", "fixed"), ("parameter", "tunable"), ("output", "constant"), ("local", "constant")}


@dataclass(frozen=True, eq=False)  # each is itself, and quick to look up
class Variable:
    """A ScalarVariable; what is left out of the file has its default, numbers that are none are None.

    derivative: place of the variable that this one is the derivative of, from 0.
    """

    name: str
    reference: int
    type: str
    causality: str
    variability: str
    initial: str | None
    start: Value | None
    minimum: float | None
    maximum: float | None
    nominal: float | None
    unit: str | None
    derivative: int | None

    @property
    def getter(self) -> str:
        """The type by which it is set and got."""
        return "Integer" if self.type == "Enumeration" else self.type


@dataclass(frozen=True)
class Unknown:
    """An entry of ModelStructure by places in the list of variables, from 0; dependencies: None is all."""

    place: int
    dependencies: tuple[int, ...] | None


@dataclass(frozen=True)
class Unit:
    """name; exponents of its BaseUnit by base unit, None where it has none; factor, offset."""

    name: str
    exponents: tuple[tuple[str, int], ...] | None
    factor: float
    offset: float


@dataclass(frozen=True)
class Description:
    """The co-simulation face of an FMU; flags: the attributes of <CoSimulation>."""

    name: str
    guid: str
    flags: tuple[tuple[str, str], ...]
    variables: tuple[Variable, ...]
    outputs: tuple[Unknown, ...]
    derivatives: tuple[Unknown, ...]
    initial_unknowns: tuple[Unknown, ...]
    units: tuple[Unit, ...]
    categories: tuple[str, ...]
    sources: tuple[str, ...]
    start: float | None
    stop: float | None
    step: float | None

    @property
    def identifier(self) -> str:
        """modelIdentifier"""
        return dict(self.flags).get("modelIdentifier", "")

    def can(self, flag: str) -> bool:
        """Whether a capability is declared."""
        return dict(self.flags).get(flag, "false") in ("true", "1")

    @property
    def indexed(self) -> bool:
        """Whether ModelStructure and the attribute derivative tell of variables that are there."""
        places = {u.place for u in (*self.outputs, *self.derivatives, *self.initial_unknowns)}
        places |= {v.derivative for v in self.variables if v.derivative is not None}
        return all(0 <= place < len(self.variables) for place in places)

    @property
    def output_order(self) -> int:
        """maxOutputDerivativeOrder"""
        return int(_number(dict(self.flags).get("maxOutputDerivativeOrder")) or 0)

    @property
    def inputs(self) -> tuple[Variable, ...]:
        """All inputs."""
        return tuple(v for v in self.variables if v.causality == "input")

    @property
    def real_inputs(self) -> tuple[Variable, ...]:
        """The inputs that are continuous Reals."""
        return tuple(v for v in self.inputs if v.type == "Real" and v.variability == "continuous")

    @property
    def real_outputs(self) -> tuple[Variable, ...]:
        """The outputs that are continuous Reals."""
        return tuple(
            v
            for v in self.variables
            if (v.causality, v.type, v.variability) == ("output", "Real", "continuous")
        )


def read_description(folder: Path) -> Description:
    """Of an unpacked FMU. Raises ModalFmuError: not XML, not FMI 2.0, no co-simulation."""
    try:
        root = ET.parse(folder / DESCRIPTION).getroot()
    except (ET.ParseError, LookupError, ValueError) as error:  # the latter of encodings
        raise ModalFmuError(f"its {DESCRIPTION} cannot be read ({error}); is it whole?") from None
    version = root.get("fmiVersion")
    if root.tag != "fmiModelDescription" or version != "2.0":
        raise ModalFmuError(f"got FMI {version or 'of no version'}, expected FMI 2.0")
    face = root.find("CoSimulation")
    if face is None:
        raise ModalFmuError("got FMI 2.0 model exchange only, expected co-simulation")
    types = {
        simple.get("name"): simple[0] for simple in root.findall("TypeDefinitions/SimpleType") if len(simple)
    }
    experiment = root.find("DefaultExperiment")
    start, stop, step = (
        _number(None if experiment is None else experiment.get(key))
        for key in ("startTime", "stopTime", "stepSize")
    )
    return Description(
        root.get("modelName", ""),
        root.get("guid", ""),
        tuple(face.attrib.items()),
        tuple(_variable(element, types) for element in root.findall("ModelVariables/ScalarVariable")),
        tuple(_unknowns(root.findall("ModelStructure/Outputs/Unknown"))),
        tuple(_unknowns(root.findall("ModelStructure/Derivatives/Unknown"))),
        tuple(_unknowns(root.findall("ModelStructure/InitialUnknowns/Unknown"))),
        tuple(_unit(element) for element in root.findall("UnitDefinitions/Unit")),
        tuple(element.get("name", "") for element in root.findall("LogCategories/Category")),
        tuple(element.get("name", "") for element in face.findall("SourceFiles/File")),
        start,
        stop,
        step,
    )


def _variable(element: ET.Element, types: dict[str | None, ET.Element]) -> Variable:
    value = next((child for child in element if child.tag in TYPES), None)
    kind = "Real" if value is None else value.tag
    own = {} if value is None else value.attrib
    declared = types.get(own.get("declaredType"))
    face = {**({} if declared is None else declared.attrib), **own}
    causality = element.get("causality", "local")
    variability = element.get("variability", "continuous" if kind == "Real" else "discrete")
    initial = element.get("initial")
    if initial is None and causality not in ("input", "independent"):
        initial = "exact" if (causality, variability) in _EXACT else "calculated"
    derivative = _number(face.get("derivative"))
    return Variable(
        element.get("name", ""),
        int(_number(element.get("valueReference")) or 0),
        kind,
        causality,
        variability,
        initial,
        _value(kind, face.get("start")),
        _number(face.get("min")),
        _number(face.get("max")),
        _number(face.get("nominal")),
        face.get("unit"),
        None if derivative is None else int(derivative) - 1,
    )


def _unknowns(elements: Iterable[ET.Element]) -> Iterable[Unknown]:
    for element in elements:
        listed = element.get("dependencies")
        known = None if listed is None else tuple(int(_number(text) or 0) - 1 for text in listed.split())
        yield Unknown(int(_number(element.get("index")) or 0) - 1, known)


def _unit(element: ET.Element) -> Unit:
    base = element.find("BaseUnit")
    given = {} if base is None else dict(base.attrib)
    factor, offset = _number(given.pop("factor", "1")), _number(given.pop("offset", "0"))
    exponents = tuple((name, int(_number(text) or 0)) for name, text in given.items())
    return Unit(element.get("name", ""), None if base is None else exponents, factor or 1.0, offset or 0.0)


def _value(kind: str, text: str | None) -> Value | None:
    if text is None or kind == "String":
        return text
    if kind == "Boolean":
        return text in ("true", "1")
    number = _number(text)
    return number if number is None or kind == "Real" else int(number)


def _number(text: str | None) -> float | None:
    """None for what is no finite number."""
    try:
        number = float(text or "")
    except ValueError:
        return None
    return number if math.isfinite(number) else None
