"""libcosim (by libcosimpy) reads an SSP and runs it with its fixed-step algorithm; prints as jacobi.py does.

python libcosim.py FILE.ssp STEPS
"""

import json
import sys

from libcosimpy.CosimEnums import CosimVariableCausality
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
from libcosimpy.CosimObserver import CosimObserver

path, steps = sys.argv[1], int(sys.argv[2])
log_output_level(CosimLogLevel.WARNING)
execution = CosimExecution.from_ssp_file(path)
observer = CosimObserver.create_last_value()
execution.add_observer(observer)
outputs = [
    (f"{slave.name.decode()}.{variable.name.decode()}", slave.index, variable.reference)
    for slave in execution.slave_infos()
    for variable in execution.slave_variables(slave.index)
    if variable.causality == CosimVariableCausality.OUTPUT.value
]
record = {name: [] for name, _, _ in outputs}
for _ in range(steps):
    assert execution.step()
    for name, slave, reference in outputs:
        record[name].append(observer.last_real_values(slave, [reference])[0])
print(json.dumps(record))
