"""Reduced models of a few modes for the tests of the FMU, and FMPy in a process of its own."""

import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np

from fmu_src.runtime.kinds import ROWS, outputs_of
from fmu_src.runtime.model import Floats, Port, ReducedModel, row_starts


def _model(given: dict[str, Any]) -> ReducedModel:
    """Without feed-through where none is given."""
    s, m = len(given["C"]), given["B"].shape[1]
    return ReducedModel(**{"R": np.zeros((s, m)), "R_in": np.zeros((m, m)), **given})


def oscillator(
    name: str = "oscillator",
    stiffness: float = 400.0,
    mass: float = 1.0,
    damping: float = 0.4,
    **changes: object,
) -> ReducedModel:
    """One spring, one mass, one port: mass-normalised, so B = C = 1/√m."""
    shape = np.full((1, 1), mass**-0.5)
    outputs = ("displacement.x", "velocity.x", "acceleration.x")
    given = {
        "name": name,
        "description": "one spring, one mass",
        "lam": np.array([stiffness / mass]),
        "alpha": damping / mass,
        "beta": 0.0,
        "D_rest": np.zeros((1, 1)),
        "B": shape,
        "C": np.repeat(shape, 3, axis=0),
        "ports": (Port("tip", ("force.x",), outputs),),
    }
    return _model({**given, **changes})


def two_ports(name: str = "two_ports", **changes: object) -> ReducedModel:
    """Six modes of every kind (two rigid) between two ports."""
    lam = np.array([0.0, 0.0, 30.0, 30.0, 400.0, 9000.0])
    rng = np.random.default_rng(7)
    given = {
        "name": name,
        "description": "six modes & two ports <test>",
        "lam": lam,
        "alpha": 0.3,
        "beta": 1e-3,
        "D_rest": np.diag([0.0, 0.1, 0.0, 0.5, 0.0, 300.0]),
        "B": rng.standard_normal((6, 3)),
        "C": rng.standard_normal((5, 6)),
        "ports": (
            Port("left", ("force.x", "force.z"), ("displacement.x", "velocity.z", "acceleration.z")),
            Port("right", ("force.y",), ("acceleration.y", "displacement.y")),
        ),
    }
    return _model({**given, **changes})


EVERYTHING = (
    Port(
        "left",
        ("force.x", "moment.z", "pressure"),
        ("displacement.x", "rotation.z", "velocity.x", "angular_velocity.z", "stress.mises", "stress.xy"),
    ),
    Port("right", ("force.y",), ("acceleration.y", "angular_acceleration.x", "absolute_acceleration.z")),
    Port("gap", (), ("displacement.x",)),
    Port("clamp", (), ("reaction.x", "reaction.z")),
    Port("gravity", ("z",), ()),
    Port("base", ("acceleration.x", "acceleration.z"), ()),
    Port("energy", (), ("kinetic", "strain")),
)


def everything(name: str = "everything", *, coupled: bool = True, **changes: object) -> ReducedModel:
    """Seven modes, two of them rigid, between ports with every kind of input and output; five are coupled."""
    lam = np.array([0.0, 0.0, 30.0, 30.0, 400.0, 9000.0, 2e4])
    rng = np.random.default_rng(11)
    D_rest = np.diag([0.0, 0.1, 0.0, 0.5, 0.0, 300.0, 2.0])
    if coupled:
        w = rng.standard_normal((7, 2)) * (3.0, 0.2)
        w[[1, 3]] = 0.0
        D_rest += w @ w.T
    S = rng.standard_normal((7, 7))
    rows = sum(ROWS[law] for law in LAWS)
    B, C = rng.standard_normal((7, 7)), rng.standard_normal((rows, 7))
    R = 1e-3 * rng.standard_normal((rows, 7))
    for first in np.array(row_starts(LAWS)[:-1])[[law == "reaction" for law in LAWS]]:
        R[first + 1 : first + 3] = 0.0  # of a reaction the first row alone has a feed-through
        C[first + 2] = 0.0  # and no mode a static force
    given = {
        "name": name,
        "description": "every kind of input and output",
        "lam": lam,
        "alpha": 0.3,
        "beta": 1e-3,
        "D_rest": D_rest,
        "B": B,
        "C": C,
        "R": R,
        "R_in": 1e-3 * (S @ S.T),
        "ports": EVERYTHING,
        "residual": True,
    }
    return _model({**given, **changes})


def legal(ports: tuple[Port, ...], lam: Floats, B: Floats, C: Floats) -> dict[str, Floats]:
    """These arrays with what a model must hold for prescribed motions and in the third rows of reactions."""
    keys = [key for port in ports for key in port.inputs]
    motions = [place for place, key in enumerate(keys) if "motion" in key]
    laws = [outputs_of(port.name)[key].law for port in ports for key in port.outputs]
    lam, B, C, k = lam.copy(), B.copy(), C.copy(), len(motions)
    lam[:k], B[:k] = 0.0, 0.0
    B[range(k), motions] = 1.0
    for first, law in zip(row_starts(laws), laws, strict=False):
        if law == "reaction":
            C[first + 2, k:] = 0.0
    return {"lam": lam, "B": B, "C": C}


LAWS = tuple(outputs_of(port.name)[key].law for port in EVERYTHING for key in port.outputs)


def run_master(script: str, *arguments: object, cwd: Path) -> str:
    """Run a master in a process of its own that sees installed packages only, no folder of ours."""
    done = subprocess.run(
        [sys.executable, "-I", "-c", script, *map(str, arguments)],
        capture_output=True,
        text=True,
        cwd=cwd,
        timeout=300,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


PRELUDE = '''
import json, sys
import numpy as np
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE, fmi2CallbackAllocateMemoryTYPE
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import fmi2CallbackFreeMemoryTYPE, calloc, free
LOG = []
@fmi2CallbackLoggerTYPE
def logger(environment, instance, status, category, message):
    LOG.append((status, message.decode()))
CALLBACKS = fmi2CallbackFunctions(
    logger, fmi2CallbackAllocateMemoryTYPE(calloc), fmi2CallbackFreeMemoryTYPE(free))

class Part:
    """An instance with its variables by name."""
    def __init__(self, path, name="one", folder=None):
        self.description = read_model_description(path)
        self.folder = folder or extract(path)
        self.vr = {v.name: v.valueReference for v in self.description.modelVariables}
        self.fmu = FMU2Slave(guid=self.description.guid, unzipDirectory=self.folder,
                             modelIdentifier=self.description.coSimulation.modelIdentifier, instanceName=name)
        self.fmu.instantiate(callbacks=CALLBACKS, loggingOn=True)
        self.fmu.setupExperiment(startTime=0.0)
    def initialise(self, **start):
        self.fmu.enterInitializationMode()
        for name, value in start.items():
            self.set(name.replace("__", "."), value)
        self.fmu.exitInitializationMode()
        return self
    def set(self, name, value):
        self.fmu.setReal([self.vr[name]], [value])
    def get(self, *names):
        return np.array(self.fmu.getReal([self.vr[n] for n in names]))
    def everything(self):
        return self.get(*[v.name for v in self.description.modelVariables if v.type == "Real"])
    def status(self, t, h):
        """2 is fmi2Discard; FMPy turns everything but OK and Warning into an exception."""
        try:
            self.step(t, h)
        except FMICallException as error:
            return error.status
        return 0
    def step(self, t, h):
        self.fmu.doStep(currentCommunicationPoint=t, communicationStepSize=h)
'''
