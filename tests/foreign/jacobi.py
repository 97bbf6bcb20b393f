"""The reference: FMPy's FMU2Slave in a plain loop over the FMUs of an SSP (Jacobi, held inputs).

    python jacobi.py FILE.ssp STEPS STEP MASTER [EXCHANGES]

In each step every FMU gets its inputs, steps, and gives its outputs; then the outputs go over to the inputs.
MASTER names the one whose habits are to be followed: those of HABITS. EXCHANGES: how often outputs go over to
inputs before the first step; left out: as often as it takes a value to pass through all FMUs, which is enough
where they form no loop.
Prints JSON: "COMPONENT.CONNECTOR" of each output → its values after each step.
"""

import json
import sys
from math import cos
from pathlib import Path
from tempfile import TemporaryDirectory

from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave
from fmpy.ssp.ssd import read_ssd
from lxml import etree

HABITS = {
    # starts: start values are set, and outputs go over to inputs before the first step; else inputs are 0
    # nanoseconds: times are whole numbers of them, a step is the difference of two; else steps are added up
    # fresh: outputs are noted when the next step's inputs are set, so that what is fed through is of these
    # at_once: what comes in at connectors of the system reaches the step that begins then, not the next one
    "fmpy": {"starts": False, "nanoseconds": False, "fresh": False, "at_once": False},
    "libcosim": {"starts": True, "nanoseconds": True, "fresh": False, "at_once": False},
    "ecos": {"starts": True, "nanoseconds": False, "fresh": True, "at_once": False},
    "container": {"starts": True, "nanoseconds": False, "fresh": False, "at_once": True},
}
SSC = "{http://ssp-standard.org/SSP1/SystemStructureCommon}"
SSD = "{http://ssp-standard.org/SSP1/SystemStructureDescription}"


class Part:
    def __init__(self, component, folder):
        path = extract(str(folder / component.source), str(folder / component.name))
        self.name, self.description = component.name, read_model_description(path)
        self.variables = {v.name: v for v in self.description.modelVariables}
        self.outputs = [c.name for c in component.connectors if c.kind == "output"]
        self.start = {
            p.name: p.value
            for binding in component.parameterBindings
            for values in binding.parameterValues
            for p in values.parameters
        }
        self.fmu = FMU2Slave(
            guid=self.description.guid,
            unzipDirectory=path,
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName=self.name,
        )
        self.fmu.instantiate()
        self.fmu.setupExperiment(startTime=0.0)

    def set(self, name, value):
        variable = self.variables[name]
        if variable.type == "Integer":
            self.fmu.setInteger([variable.valueReference], [int(value)])
        else:
            self.fmu.setReal([variable.valueReference], [float(value)])

    def get(self, name):
        return self.fmu.getReal([self.variables[name].valueReference])[0]


def connections(folder):
    """(component, connector) of source and target, factor, offset; read here, as FMPy skips the last two.

    The component of a connector of the system itself is None; its outputs are left out.
    """
    for element in etree.parse(str(folder / "SystemStructure.ssd")).iter(f"{SSD}Connection"):
        linear = element.find(f"{SSC}LinearTransformation")
        numbers = (1.0, 0.0) if linear is None else (float(linear.get("factor")), float(linear.get("offset")))
        source, target = (
            (element.get(f"{end}Element"), element.get(f"{end}Connector")) for end in ("start", "end")
        )
        if target[0]:
            yield source, target, *numbers


def signal(t):
    """What comes in at the connectors of the system."""
    return 2.0 * cos(30.0 * t)


def times(steps, step, nanoseconds):
    t, nano = 0.0, round(step * 1e9)
    for k in range(steps):
        if nanoseconds:
            yield k * nano / 1e9, (k + 1) * nano / 1e9 - k * nano / 1e9
        else:
            yield t, step
            t += step


def run(path, steps, step, exchanges, *, starts, nanoseconds, fresh, at_once):
    with TemporaryDirectory() as name:
        folder = Path(name)
        extract(path, name)
        parts = {c.name: Part(c, folder) for c in read_ssd(path).system.elements}
        joined = list(connections(folder))
        record = {f"{part.name}.{key}": [] for part in parts.values() for key in part.outputs}

        def transfer(t=0.0):
            values = [signal(t) if a is None else parts[a].get(x) for (a, x), *_ in joined]
            for value, (_, (b, y), factor, offset) in zip(values, joined, strict=True):
                parts[b].set(y, factor * value + offset)

        def note():
            for key, values in record.items():
                element, _, connector = key.partition(".")
                values.append(parts[element].get(connector))

        for part in parts.values():
            part.fmu.enterInitializationMode()
            for key, value in part.start.items() if starts else ():
                part.set(key, value)
        for _ in range(exchanges or len(parts) + 1) if starts else ():
            transfer()
        for part in parts.values():
            part.fmu.exitInitializationMode()
        for t, h in times(steps, step, nanoseconds):
            for (a, _), (b, y), *_ in joined if at_once else ():
                if a is None:
                    parts[b].set(y, signal(t))
            for part in parts.values():
                part.fmu.doStep(currentCommunicationPoint=t, communicationStepSize=h)
            if not fresh:
                note()
            transfer(t)
            if fresh:
                note()
        for part in parts.values():
            part.fmu.terminate()
            part.fmu.freeInstance()
        return record


if __name__ == "__main__":
    path, steps, step, master, *exchanges = sys.argv[1:]
    print(json.dumps(run(path, int(steps), float(step), sum(map(int, exchanges)), **HABITS[master])))
