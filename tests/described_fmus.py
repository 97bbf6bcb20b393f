"""FMUs that are nothing but a modelDescription.xml: enough to be packaged and checked."""

from collections.abc import Mapping
from pathlib import Path

from fmu_src.archive import write_archive

UNITS = {
    "m": 'm="1"',
    "mm": 'm="1" factor="0.001"',
    "m/s2": 'm="1" s="-2"',
    "N": 'kg="1" m="1" s="-2"',
    "kN": 'kg="1" m="1" s="-2" factor="1000"',
    "K": 'K="1"',
    "degC": 'K="1" offset="273.15"',
    "rad": 'rad="1"',
}


def describe_fmu(
    path: Path,
    inputs: Mapping[str, str] | None = None,
    outputs: Mapping[str, str] | None = None,
    *,
    depends: Mapping[str, list[str]] | None = None,
    others: str = "",
    units: Mapping[str, str] = UNITS,
    capabilities: str = "",
    experiment: str | None = None,
    tool: str = "another tool",
) -> Path:
    """inputs, outputs: name → unit, "" for none. depends: output → inputs, where the FMU tells.

    tool: what made it; capabilities, experiment: attributes of <CoSimulation> and <DefaultExperiment>.
    """
    inputs, outputs, depends = inputs or {}, outputs or {}, depends or {}
    variables, listed = "", ""
    for k, (name, unit) in enumerate({**inputs, **outputs}.items()):
        has_unit = f' unit="{unit}"' if unit else ""
        causality, start = ("input", ' start="0"') if name in inputs else ("output", "")
        variables += f'<ScalarVariable name="{name}" valueReference="{k}" causality="{causality}">'
        variables += f"<Real{has_unit}{start}/></ScalarVariable>"
        if name in outputs:
            indices = " ".join(str([*inputs].index(one) + 1) for one in depends.get(name, []))
            told = f' dependencies="{indices}"' if name in depends else ""
            listed += f'<Unknown index="{k + 1}"{told}/>'
    defined = "".join(f'<Unit name="{name}"><BaseUnit {base}/></Unit>' for name, base in units.items())
    suggested = "" if experiment is None else f"<DefaultExperiment {experiment}/>"
    text = (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        f'<fmiModelDescription fmiVersion="2.0" modelName="{path.stem}" guid="1" generationTool="{tool}">'
        f'<CoSimulation modelIdentifier="{path.stem}" {capabilities}/>'
        f"<UnitDefinitions>{defined}</UnitDefinitions>{suggested}<ModelVariables>{variables}{others}</ModelVariables>"
        f"<ModelStructure><Outputs>{listed}</Outputs></ModelStructure></fmiModelDescription>"
    )
    write_archive(path, {"modelDescription.xml": text.encode()})
    return path
