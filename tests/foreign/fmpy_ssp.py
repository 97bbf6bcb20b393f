"""FMPy's own simulate_ssp; prints as jacobi.py does.

python fmpy_ssp.py FILE.ssp STEPS STEP
"""

import json
import sys
from math import cos

from fmpy.ssp.simulation import simulate_ssp
from fmpy.ssp.ssd import read_ssd

path, steps, step = sys.argv[1], int(sys.argv[2]), float(sys.argv[3])
system = read_ssd(path).system
inputs = {c.name: lambda t: 2.0 * cos(30.0 * t) for c in system.connectors if c.kind == "input"}
result = simulate_ssp(path, stop_time=(steps - 0.5) * step, step_size=step, input=inputs)
print(
    json.dumps(
        {
            f"{component.name}.{connector.name}": result[f"{component.name}.{connector.name}"].tolist()
            for component in system.elements
            for connector in component.connectors
            if connector.kind == "output"
        }
    )
)
