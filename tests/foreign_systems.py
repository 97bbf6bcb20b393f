"""Systems of two oscillators with a spring and a damper between them, as FMUs with a system file."""

from pathlib import Path

import numpy as np
from examples import oscillator

from fmu_src.native_fmu import build_native_fmu
from fmu_src.runtime.model import Port

LEFT, RIGHT = (400.0, 1.0), (100.0, 2.0)  # N/m, kg
DAMPING = 0.4  # N.s/m of each; `oscillator` turns it into alpha
STIFFNESS, DAMPER = 500.0, 3.0  # between them, N/m, N.s/m

OUTPUTS = ("displacement.x", "velocity.x", "acceleration.x")
PORTS = (Port("push", ("force.x",), ()), Port("tip", ("force.x",), OUTPUTS))

SYSTEM = f"""\
[system]
name = "pair"
description = "two oscillators"

[[component]]
name = "left"
fmu = "left.fmu"
start = {{ push.force.x = 2.0, damping.alpha = 0.6 }}

[[component]]
name = "right"
fmu = "right.fmu"

[[spring_damper]]
name = "mount"
ports = ["left.tip", "right.tip"]
stiffness = {{ x = {STIFFNESS} }}
damping = {{ x = {DAMPER} }}

[experiment]
stop = 1.0
step = 1e-3
"""

LINEAR = """
[[connection]]
from = "mount.a.force.x"
to = "right.push.force.x"
factor = -0.25
offset = 1.0
"""

CONNECTORS = """
[[input]]
name = "load"
to = ["left.push.force.x"]

[[output]]
name = "x_left"
from = "left.tip.displacement.x"

[[output]]
name = "x_right"
from = "right.tip.displacement.x"

[[output]]
name = "pull"
from = "mount.a.force.x"
"""


def write_pair(folder: Path, text: str = SYSTEM) -> Path:
    """left.fmu, right.fmu and the system file; gives the path of this."""
    for name, (stiffness, mass) in (("left", LEFT), ("right", RIGHT)):
        column = np.full((1, 1), mass**-0.5)
        model = oscillator(
            name,
            stiffness=stiffness,
            mass=mass,
            damping=DAMPING,
            ports=PORTS,
            B=np.repeat(column, 2, axis=1),
            C=np.repeat(column, 3, axis=0),
            R=np.zeros((3, 2)),
            R_in=np.zeros((2, 2)),
        )
        build_native_fmu(model, folder / f"{name}.fmu")
    system = folder / "system.toml"
    system.write_text(text, encoding="utf-8")
    return system
