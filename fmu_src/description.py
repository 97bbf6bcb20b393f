"""modelDescription.xml of FMI 2.0, generated from the reduced model alone: the same for every twin."""

import math
from collections.abc import Iterable, Mapping, Sequence
from xml.etree import ElementTree as ET

import numpy as np
from numpy.typing import NDArray

from .runtime.model import Floats, ReducedModel
from .runtime.variables import Layout, Variable, layout, variables

SI = {  # exponents of the SI base units
    "N": {"kg": 1, "m": 1, "s": -2},
    "m": {"m": 1},
    "m/s": {"m": 1, "s": -1},
    "m/s2": {"m": 1, "s": -2},
    "1/s": {"s": -1},
    "s": {"s": 1},
    "Hz": {"s": -1},
}
STEPS_PER_PERIOD = 20  # of the highest mode: enough to draw it
PERIODS = 10  # of the lowest elastic mode
LOG_CATEGORIES = {
    "logStatusWarning": "Log messages with fmi2Warning status.",
    "logStatusDiscard": "Log messages with fmi2Discard status.",
    "logStatusError": "Calls that were refused, with the reason.",
    "logStatusFatal": "Log messages with fmi2Fatal status.",
    "logAll": "Log all messages.",
}


def model_description(
    model: ReducedModel, *, guid: str, generation_tool: str, capabilities: Mapping[str, str]
) -> bytes:
    """The XML file as UTF-8; `capabilities` are the attributes of CoSimulation beside modelIdentifier."""
    listed = variables(model)
    root = ET.Element(
        "fmiModelDescription",
        {
            "fmiVersion": "2.0",
            "modelName": model.name,
            "guid": guid,
            "description": model.description,
            "generationTool": generation_tool,
            "variableNamingConvention": "structured",
            "numberOfEventIndicators": "0",
        },
    )
    ET.SubElement(root, "CoSimulation", {"modelIdentifier": model.name, **capabilities})
    units = ET.SubElement(root, "UnitDefinitions")
    for name in sorted({variable.unit for variable in listed if variable.unit}):
        ET.SubElement(
            ET.SubElement(units, "Unit", name=name), "BaseUnit", {k: str(v) for k, v in SI[name].items()}
        )
    categories = ET.SubElement(root, "LogCategories")
    for name, text in LOG_CATEGORIES.items():
        ET.SubElement(categories, "Category", name=name, description=text)
    stop, step = default_experiment(model)
    ET.SubElement(root, "DefaultExperiment", startTime="0", stopTime=repr(stop), stepSize=repr(step))
    _add_variables(root, listed)
    _add_structure(root, model, listed)
    ET.indent(root)
    text = ET.tostring(root, encoding="unicode")
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{text}\n'.encode()


def default_experiment(model: ReducedModel) -> tuple[float, float]:
    """Stop time and step size in s: ten periods of the lowest elastic mode, twenty steps in the highest.

    Both are 1, 2 or 5 times a power of ten; a body with rigid modes only gets 1 s in steps of 1 ms.
    """
    elastic = model.frequency[model.lam > 0]
    if len(elastic) == 0:
        return 1.0, 1e-3
    step = _round_number(1 / (STEPS_PER_PERIOD * elastic[-1]), down=True)
    return max(_round_number(PERIODS / elastic[0], down=False), step), step


def _round_number(x: float, *, down: bool) -> float:
    """The nearest 1, 2 or 5 times a power of ten that is not above (below) x."""
    exponent = math.floor(math.log10(x))
    candidates = [float(f"{digit}e{exponent + k}") for k in (0, 1) for digit in (1, 2, 5)]
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
            {k: v if isinstance(v, str) else repr(v) for k, v in attributes.items() if v is not None},
        )


def _add_structure(root: ET.Element, model: ReducedModel, listed: Sequence[Variable]) -> None:
    place = layout(model)
    running = _running_dependencies(model, place)
    structure = ET.SubElement(root, "ModelStructure")
    outputs = ET.SubElement(structure, "Outputs")
    for i in range(place.outputs.start, place.outputs.stop):
        _add_unknown(outputs, i, running[i])
    derivatives = ET.SubElement(structure, "Derivatives")
    for i in range(place.q_dot.start, place.size):
        _add_unknown(derivatives, i, running[i])
    initial = ET.SubElement(structure, "InitialUnknowns")
    for i, variable in enumerate(listed):
        if variable.initial == "calculated":
            _add_unknown(initial, i, _initial_dependencies(model, place, running, i))


def _running_dependencies(model: ReducedModel, place: Layout) -> dict[int, list[int]]:
    """Outputs and derivatives on inputs and states: y = C q, C q̇ or C q̈ with q̈ = B u − d q̇ − λ q."""
    r = len(model.lam)
    q, v = place.q.start + np.arange(r), place.v.start + np.arange(r)
    stiff = model.lam > 0
    found: dict[int, list[int]] = {}
    for row, name in enumerate(model.outputs):
        kind, modes = name.split(".")[1], model.C[row] != 0
        if kind == "displacement":
            known = q[modes]
        elif kind == "velocity":
            known = v[modes]
        else:
            known = np.concatenate([_reaching(model.B[modes]), q[modes & stiff], v[modes]])
        found[place.outputs.start + row] = known.tolist()
    for i in range(r):
        found[place.q_dot.start + i] = [int(v[i])]
        found[place.v_dot.start + i] = [
            *_reaching(model.B[i : i + 1]).tolist(),
            *q[i : i + 1][stiff[i : i + 1]].tolist(),
            int(v[i]),
        ]
    return found


def _reaching(B: Floats) -> NDArray[np.intp]:
    """The inputs with an entry in these rows of B."""
    return np.flatnonzero((B != 0).any(axis=0))


def _initial_dependencies(
    model: ReducedModel, place: Layout, running: Mapping[int, list[int]], unknown: int
) -> list[int]:
    """The same at initialisation, where α, β and modes.active are knowns, and q is none if static.

    In static equilibrium B u − λ q = 0: then only −d q̇ is left of an acceleration.
    """
    r, static = len(model.lam), model.initial == "static"
    if place.damping_ratio.start <= unknown < place.damping_ratio.stop:
        stiff = model.lam[unknown - place.damping_ratio.start] > 0
        return [place.alpha, place.beta] if stiff else []
    if place.q.start <= unknown < place.q.stop:  # an unknown if static only
        known, loaded = set[int](), [unknown - place.q.start]
    else:
        known, loaded = set(running[unknown]), []
    if _is_acceleration(model, place, unknown):
        damped = [i for i in range(r) if place.v.start + i in known]
        known |= {place.alpha} if damped else set()
        known |= {place.beta} if (model.lam[damped] > 0).any() else set()
        known -= {*range(place.q.stop)} - {place.alpha, place.beta} if static else set()
    elif static:
        loaded += [i for i in range(r) if place.q.start + i in known]
        known -= {*range(place.q.start, place.q.stop)}
    known |= {int(i) for i in _reaching(model.B[loaded])}
    return [*sorted(known), place.size] if known else []  # modes.active stands behind the Reals


def _is_acceleration(model: ReducedModel, place: Layout, unknown: int) -> bool:
    """Whether the unknown is v̇ or C q̈."""
    if unknown in range(place.outputs.start, place.outputs.stop):
        name = model.outputs[unknown - place.outputs.start]
        return str(name.split(".")[1]) == "acceleration"
    return unknown in range(place.v_dot.start, place.v_dot.stop)


def _add_unknown(parent: ET.Element, index: int, dependencies: Iterable[int]) -> None:
    ET.SubElement(
        parent, "Unknown", index=str(index + 1), dependencies=" ".join(str(i + 1) for i in dependencies)
    )
