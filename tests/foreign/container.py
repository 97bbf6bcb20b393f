"""fmucontainer makes one FMU of an SSP, which FMPy runs; prints the outputs of the system as jacobi.py does.

python container.py FILE.ssp STEPS STEP
"""

import json
import subprocess
import sys
from math import cos
from pathlib import Path
from tempfile import TemporaryDirectory

from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave

path, steps, step = Path(sys.argv[1]), int(sys.argv[2]), float(sys.argv[3])
with TemporaryDirectory() as folder:
    (Path(folder) / path.name).write_bytes(path.read_bytes())
    made = subprocess.run(
        [
            *(sys.executable, "-m", "fmu_manipulation_toolbox.cli.fmucontainer"),
            *("-fmu-directory", folder, "-container", f"{path.name}:{step}"),
        ],
        capture_output=True,
        text=True,
        encoding="utf-8",
    )
    sys.stderr.write(made.stdout + made.stderr)
    unpacked = extract(str(Path(folder, path.with_suffix(".fmu").name)), str(Path(folder, "unpacked")))
    description = read_model_description(unpacked)
    reference = {v.name: v.valueReference for v in description.modelVariables}
    inputs = [v.valueReference for v in description.modelVariables if v.causality == "input"]
    outputs = [v.name for v in description.modelVariables if v.causality == "output"]
    fmu = FMU2Slave(
        guid=description.guid,
        unzipDirectory=unpacked,
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName="container",
    )
    fmu.instantiate()
    fmu.setupExperiment(startTime=0.0)
    fmu.enterInitializationMode()
    fmu.exitInitializationMode()
    record = {name: [] for name in outputs}
    for k in range(steps):
        fmu.setReal(inputs, [2.0 * cos(30.0 * k * step)] * len(inputs))
        fmu.doStep(currentCommunicationPoint=k * step, communicationStepSize=step)
        for name in outputs:
            record[name].append(fmu.getReal([reference[name]])[0])
    fmu.terminate()
    fmu.freeInstance()
print(json.dumps(record))
