"""ecos (by ecospy) reads an SSP and runs it; prints as jacobi.py does.

    python ecos.py FILE.ssp STEPS STEP [until]

until: by one call that is told the time of the end, and the values there.
Its library needs libtbb.so.12: the one of the package tbb, which comes with MKL, or the system's.
"""

import ctypes
import json
import sys
from importlib.metadata import PackageNotFoundError, distribution

try:
    for file in distribution("tbb").files or ():
        if file.name == "libtbb.so.12":
            ctypes.CDLL(str(file.locate()), mode=ctypes.RTLD_GLOBAL)
except PackageNotFoundError:
    pass  # then the system's

from ecospy import EcosSimulation
from ecospy.lib import EcosLib
from fmpy.ssp.ssd import read_ssd

path, steps, step = sys.argv[1], float(sys.argv[2]), float(sys.argv[3])
EcosLib.set_log_level("warn")
outputs = [
    (component.name, connector.name)
    for component in read_ssd(path).system.elements
    for connector in component.connectors
    if connector.kind == "output"
]
record = {f"{component}.{connector}": [] for component, connector in outputs}
with EcosSimulation(step_size=step, ssp_path=path) as simulation:
    assert simulation.init(parameter_set="initialValues"), EcosLib.get_last_error()
    for _ in range(1 if "until" in sys.argv else int(steps)):
        if "until" in sys.argv:
            simulation.step_until(steps * step)
        else:
            simulation.step()
        for component, connector in outputs:
            record[f"{component}.{connector}"].append(simulation.get_real(f"{component}::{connector}"))
    simulation.terminate()
print(json.dumps(record))
