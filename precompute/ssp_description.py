"""SystemStructure.ssd of SSP 1.0: components, connectors, connections, units, the experiment.

The prefixes ssd, ssc and ssv are those of the standard's examples: libcosim and ecos look for them as text.
Source: Modelica Association, System Structure and Parameterization 1.0 (2019), chapter 5.
"""

from collections.abc import Iterable, Mapping, Sequence
from importlib.metadata import version
from xml.etree import ElementTree as ET

from .errors import SspError
from .ssp_elements import Element
from .ssp_file import SystemFile
from .ssp_units import BASES, Unit, same_unit, unit_of
from .ssp_wiring import Wire

NAMESPACES = {
    "ssd": "http://ssp-standard.org/SSP1/SystemStructureDescription",
    "ssc": "http://ssp-standard.org/SSP1/SystemStructureCommon",
    "ssv": "http://ssp-standard.org/SSP1/SystemStructureParameterValues",
    "osp": "http://opensimulationplatform.com/SSP/OSPAnnotations",
}
OSP = "com.opensimulationplatform"  # libcosim's annotation of the step size; SSP 1.0 has no place for it
START = "initialValues"  # one name for all parameter sets: ecos applies those of one name


def system_structure(file: SystemFile, elements: Mapping[str, Element], wires: Sequence[Wire]) -> bytes:
    """The XML file as UTF-8.

    Only those inputs are listed that are connected, as FMPy needs it, and all outputs.
    Raises SspError where two FMUs mean different things by one unit.
    """
    root = ET.Element(
        "ssd:SystemStructureDescription",
        {
            **{f"xmlns:{prefix}": name for prefix, name in NAMESPACES.items()},
            "name": file.system.name,
            "version": "1.0",
            "generationTool": f"modalfmu {version('modalfmu')}",
        },
    )
    about = {} if file.system.description is None else {"description": file.system.description}
    system = ET.SubElement(root, "ssd:System", {"name": file.system.name, **about})
    units: dict[str, Unit] = {}
    if file.input or file.output:
        _add_connectors(system, _of_the_system(wires), units)
    parent = ET.SubElement(system, "ssd:Elements")
    for name, element in elements.items():
        _add_component(parent, name, element, wires, units)
    if wires:
        parent = ET.SubElement(system, "ssd:Connections")
        for wire in wires:
            _add_connection(parent, wire)
    if units:
        parent = ET.SubElement(root, "ssd:Units")
        for name in sorted(units):
            _add_unit(parent, units[name])
    _add_experiment(root, file, elements)
    ET.indent(root)
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{ET.tostring(root, encoding="unicode")}\n'.encode()


Connectors = Iterable[tuple[str, str, Unit | None]]
"""Name, "input" or "output", and unit of each."""


def _of_the_system(wires: Sequence[Wire]) -> Connectors:
    found: dict[str, tuple[str, str, Unit | None]] = {}
    for wire in wires:
        for end, kind in ((wire.source, "input"), (wire.target, "output")):
            if not end.element:
                found[end.connector] = (end.connector, kind, wire.unit)
    return found.values()


def _add_component(
    parent: ET.Element, name: str, element: Element, wires: Sequence[Wire], units: dict[str, Unit]
) -> None:
    source = {
        "name": name,
        "type": "application/x-fmu-sharedlibrary",
        "source": fmu_name(name),
        "implementation": "CoSimulation",
    }
    component, face = ET.SubElement(parent, "ssd:Component", source), element.face
    connected = {wire.target.connector for wire in wires if wire.target.element == name}
    listed = [(key, "input") for key in face.inputs if key in connected]
    listed += [(key, "output") for key in face.outputs if face.variables[key].type == "Real"]
    if listed:
        _add_connectors(component, ((key, kind, unit_of(face, key)) for key, kind in listed), units)
    if element.start:
        _add_start(component, element)


def fmu_name(element: str) -> str:
    """Where the FMU of a component is in the package."""
    return f"resources/{element}.fmu"


def _add_connectors(parent: ET.Element, listed: Connectors, units: dict[str, Unit]) -> None:
    connectors = ET.SubElement(parent, "ssd:Connectors")
    for name, kind, unit in listed:
        connector = ET.SubElement(connectors, "ssd:Connector", name=name, kind=kind)
        real = ET.SubElement(connector, "ssc:Real")
        if unit is not None and unit.exponents is not None:  # a unit must be defined in the file
            if not same_unit(units.setdefault(unit.name, unit), unit):
                raise SspError(
                    f"two FMUs mean different things by the unit {unit.name}, one of them that of {name}, "
                    "expected one definition of it; mend the modelDescription.xml that is wrong"
                )
            real.set("unit", unit.name)


def _add_start(parent: ET.Element, element: Element) -> None:
    """Start values in the file itself."""
    binding = ET.SubElement(ET.SubElement(parent, "ssd:ParameterBindings"), "ssd:ParameterBinding")
    values = ET.SubElement(binding, "ssd:ParameterValues")
    parameters = ET.SubElement(
        ET.SubElement(values, "ssv:ParameterSet", version="1.0", name=START), "ssv:Parameters"
    )
    for name, value in element.start.items():
        kind = element.face.variables[name].type
        text = ("true" if value else "false") if kind == "Boolean" else repr(value)
        parameter = ET.SubElement(parameters, "ssv:Parameter", name=name)
        ET.SubElement(parameter, "ssv:Integer" if kind == "Enumeration" else f"ssv:{kind}", value=text)


def _add_connection(parent: ET.Element, wire: Wire) -> None:
    ends = {}
    for key, end in (("start", wire.source), ("end", wire.target)):
        if end.element:
            ends[f"{key}Element"] = end.element
        ends[f"{key}Connector"] = end.connector
    connection = ET.SubElement(parent, "ssd:Connection", ends)
    if wire.converted or not wire.is_plain:
        # The factor converts the units too, for masters that convert none; others must not do it again, not
        # even where a factor of the user makes 1 of it.
        connection.set("suppressUnitConversion", "true")
    if not wire.is_plain:
        values = {"factor": repr(wire.factor), "offset": repr(wire.offset)}
        ET.SubElement(connection, "ssc:LinearTransformation", values)


def _add_unit(parent: ET.Element, unit: Unit) -> None:
    exponents = {base: str(n) for base, n in zip(BASES, unit.exponents or (), strict=True) if n}
    scale = {
        key: repr(x)
        for key, x, usual in (("factor", unit.factor, 1.0), ("offset", unit.offset, 0.0))
        if x != usual
    }
    ET.SubElement(ET.SubElement(parent, "ssc:Unit", name=unit.name), "ssc:BaseUnit", exponents | scale)


def _add_experiment(root: ET.Element, file: SystemFile, elements: Mapping[str, Element]) -> None:
    """Left out: the longest time and the shortest step that the FMU of a component suggests."""
    faces = [elements[component.name].face for component in file.component]
    stops, steps = (
        [x for x in told if x and x > 0] for told in ([f.stop for f in faces], [f.step for f in faces])
    )
    stop = file.experiment.stop or max(stops, default=1.0)
    step = file.experiment.step or min(steps, default=stop / 1000)
    experiment = ET.SubElement(root, "ssd:DefaultExperiment", startTime="0.0", stopTime=repr(stop))
    annotations = ET.SubElement(experiment, "ssd:Annotations")
    annotation = ET.SubElement(annotations, "ssc:Annotation", type=OSP)
    algorithm = ET.SubElement(annotation, "osp:Algorithm")  # libcosim takes an attribute for an algorithm
    ET.SubElement(algorithm, "osp:FixedStepAlgorithm", baseStepSize=repr(step))
