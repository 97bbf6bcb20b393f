"""modelDescription.xml of FMI 2.0, generated from the reduced model: the same variables for every twin."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from xml.etree import ElementTree as ET

from .runtime.model import ReducedModel
from .runtime.variables import Variable, layout, variables
from .structure import structure

SI = {  # exponents of the SI base units
    "N": {"kg": 1, "m": 1, "s": -2},
    "N.m": {"kg": 1, "m": 2, "s": -2},
    "J": {"kg": 1, "m": 2, "s": -2},
    "Pa": {"kg": 1, "m": -1, "s": -2},
    "rad": {"rad": 1},
    "rad/s": {"rad": 1, "s": -1},
    "rad/s2": {"rad": 1, "s": -2},
    "m": {"m": 1},
    "m/s": {"m": 1, "s": -1},
    "m/s2": {"m": 1, "s": -2},
    "1/s": {"s": -1},
    "s": {"s": 1},
    "Hz": {"s": -1},
}
STEPS_PER_PERIOD = 20  # of the highest mode: enough to draw it
PERIODS = 10  # of the lowest elastic mode


@dataclass(frozen=True)
class Twin:
    """What the description says of the code that runs the model.

    interfaces: ModelExchange and CoSimulation in this order, or one of them → its attributes beside
    modelIdentifier; log_categories: name → description; sources: what to compile of the folder `sources/`.
    """

    generation_tool: str
    interfaces: Mapping[str, Mapping[str, str]]
    log_categories: Mapping[str, str]
    sources: tuple[str, ...] = ()


def model_description(model: ReducedModel, twin: Twin, guid: str) -> bytes:
    """The XML file as UTF-8."""
    listed = variables(model)
    root = ET.Element(
        "fmiModelDescription",
        {
            "fmiVersion": "2.0",
            "modelName": model.name,
            "guid": guid,
            "description": model.description,
            "generationTool": twin.generation_tool,
            "variableNamingConvention": "structured",
            "numberOfEventIndicators": "0",
        },
    )
    for name, capabilities in twin.interfaces.items():
        interface = ET.SubElement(root, name, {"modelIdentifier": model.name, **capabilities})
        if twin.sources:
            files = ET.SubElement(interface, "SourceFiles")
            for source in twin.sources:
                ET.SubElement(files, "File", name=source)
    units = ET.SubElement(root, "UnitDefinitions")
    for name in sorted({variable.unit for variable in listed if variable.unit}):
        ET.SubElement(
            ET.SubElement(units, "Unit", name=name), "BaseUnit", {k: str(v) for k, v in SI[name].items()}
        )
    categories = ET.SubElement(root, "LogCategories")
    for name, text in twin.log_categories.items():
        ET.SubElement(categories, "Category", name=name, description=text)
    stop, step = default_experiment(model)
    ET.SubElement(root, "DefaultExperiment", startTime="0", stopTime=repr(stop), stepSize=repr(step))
    _add_variables(root, listed)
    _add_structure(root, model, states=_knows_states(twin))
    ET.indent(root)
    text = ET.tostring(root, encoding="unicode")
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{text}\n'.encode()


def default_experiment(model: ReducedModel) -> tuple[float, float]:
    """Stop time and step size in s: ten periods of the lowest elastic mode, twenty steps in the highest.

    Both are 1, 2 or 5 times a power of ten; a body with rigid modes only gets 1 s in steps of 1 ms.
    """
    elastic = model.frequency[model.frequency > 0]
    if len(elastic) == 0:
        return 1.0, 1e-3
    step = _round_number(1 / (STEPS_PER_PERIOD * elastic[-1]), down=True)
    return max(_round_number(PERIODS / elastic[0], down=False), step), step


def _round_number(x: float, *, down: bool) -> float:
    """The nearest 1, 2 or 5 times a power of ten that is not above (below) x."""
    exponent = math.floor(math.log10(x))
    candidates = [float(f"{digit}e{exponent + k}") for k in (-1, 0, 1) for digit in (1, 2, 5)]
    return max(c for c in candidates if c <= x) if down else min(c for c in candidates if c >= x)


def _add_variables(root: ET.Element, listed: Sequence[Variable]) -> None:
    parent = ET.SubElement(root, "ModelVariables")
    references = {"Real": 0, "Integer": 0}
    for variable in listed:
        face: dict[str, str | None] = {
            "name": variable.name,
            "valueReference": str(references[variable.type]),
            "description": variable.description,
            "causality": variable.causality,
            "variability": variable.variability,
            "initial": variable.initial,
        }
        element = ET.SubElement(parent, "ScalarVariable", {k: v for k, v in face.items() if v is not None})
        references[variable.type] += 1
        attributes = {
            "unit": variable.unit,
            "start": variable.start,
            "min": variable.minimum,
            "max": variable.maximum,
            "nominal": variable.nominal,
            "derivative": None if variable.derivative is None else variable.derivative + 1,
        }
        ET.SubElement(
            element,
            variable.type,
            {k: _number(v) for k, v in attributes.items() if v is not None},
        )


def _number(value: str | float) -> str:
    """A unit as it is, a number so that it is read back exactly."""
    if isinstance(value, str):
        return value
    return repr(int(value)) if isinstance(value, int) else repr(float(value))


def _knows_states(twin: Twin) -> bool:
    """Whether states are among the knowns that outputs depend on.

    A co-simulation FMU has them as knowns with providesDirectionalDerivative only (FMI 2.0.4, 2.2.8): without
    it <Derivatives>, which tells what the states are, is ignored.
    """
    flags = twin.interfaces.get("CoSimulation", {})
    return "ModelExchange" in twin.interfaces or flags.get("providesDirectionalDerivative") == "true"


def _add_structure(root: ET.Element, model: ReducedModel, *, states: bool) -> None:
    found, place = structure(model), layout(model)
    inner = set() if states else {*range(place.q.start, place.q.stop), *range(place.v.start, place.v.stop)}
    parent = ET.SubElement(root, "ModelStructure")
    for name, unknowns in (
        ("Outputs", found.outputs),
        ("Derivatives", found.derivatives),
        ("InitialUnknowns", found.initial),
    ):
        if not unknowns:
            continue  # the schema knows no empty list
        group = ET.SubElement(parent, name)
        for index, known in unknowns.items():
            hidden = inner if name == "Outputs" else set()
            dependencies = " ".join(str(i + 1) for i in known if i not in hidden)
            ET.SubElement(group, "Unknown", index=str(index + 1), dependencies=dependencies)
