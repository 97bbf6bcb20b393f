"""The exact step against time integration of the same oscillators, at equal accuracy."""

import ctypes
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from fmpy.fmi2 import FMU2Model
from fmpy.sundials import CVodeSolver
from fmpy.sundials.cvode import sundials_cvode
from parts import Unpacked, run

from fmu_src.runtime.model import Floats, ReducedModel

OMEGA = 2 * np.pi * 20.0  # rad/s: the force is sin(OMEGA t) newton on the first input, from rest, for 1 s
SAMPLES = 50  # where the first output is compared
ACCURACY = 1e-6  # of its peak


@dataclass(frozen=True)
class Effort:
    """What a method needed: steps in all, ns in all, and the error that it reached, of the peak."""

    method: str
    steps: int
    nanoseconds: float
    error: float


def exact(model: ReducedModel) -> Floats:
    """q = Im(A e^(iΩt)) + e^(-dt/2)(c cos wt + s sin wt), A = b/(λ − Ω² + iΩd), from q = v = 0; y = C q."""
    t = np.arange(1, SAMPLES + 1)[:, None] / SAMPLES
    d = model.damping(model.alpha, model.beta)
    A = model.B[:, 0] / (model.lam - OMEGA**2 + 1j * OMEGA * d)
    w = np.sqrt(model.lam - d**2 / 4)  # every mode of the part is under-damped
    c = -A.imag
    s = (c * d / 2 - OMEGA * A.real) / w
    q = (A * np.exp(1j * OMEGA * t)).imag + np.exp(-d * t / 2) * (c * np.cos(w * t) + s * np.sin(w * t))
    y: Floats = q @ model.C[0]
    return y


def in_steps(native: Unpacked, scratch: Path, method: str, reference: Floats) -> Effort:
    """The fewest steps between two samples, in factors of 1.1, that reach the accuracy."""
    steps = 1
    while True:
        arguments = (native.folder / "resources", method, repr(OMEGA), SAMPLES, steps)
        found = run("oscillators", scratch, *native.arguments, *arguments)
        y = np.array([found[f"y{k}"] for k in range(SAMPLES)])
        error = float(np.abs(y - reference).max() / np.abs(reference).max())
        if error <= ACCURACY:
            return Effort(method, SAMPLES * steps, found["time"], error)
        steps = max(steps + 1, int(steps * 1.1))


def by_cvode(native: Unpacked, reference: Floats) -> Effort:
    """FMPy's CVode (BDF) on the model-exchange side, the tolerance lowered until the accuracy is reached."""
    for tolerance in 10.0 ** -np.arange(4.0, 13.0, 0.1):
        start = time.perf_counter()
        y, steps = _cvode(native, float(tolerance))
        taken = time.perf_counter() - start
        error = float(np.abs(y - reference).max() / np.abs(reference).max())
        if error <= ACCURACY:
            return Effort("CVode", steps, 1e9 * taken, error)
    raise RuntimeError("CVode does not reach the accuracy")


def _cvode(native: Unpacked, tolerance: float) -> tuple[Floats, int]:
    model = native.model
    _, guid, _ = native.arguments
    fmu = FMU2Model(
        guid=guid, unzipDirectory=str(native.folder), modelIdentifier=model.name, instanceName="one"
    )
    fmu.instantiate()
    fmu.setupExperiment(startTime=0.0)
    fmu.enterInitializationMode()
    fmu.exitInitializationMode()
    fmu.enterContinuousTimeMode()

    def set_time(t: float) -> None:
        fmu.setTime(t)
        fmu.setReal([0], [np.sin(OMEGA * t)])  # in every evaluation, not only between steps

    nothing: Callable[..., None] = lambda *_: None  # noqa: E731  # the solver asks for event indicators: none
    solver = CVodeSolver(
        nx=2 * len(model.lam),
        nz=0,
        get_x=fmu.getContinuousStates,
        set_x=fmu.setContinuousStates,
        get_dx=fmu.getDerivatives,
        get_z=nothing,
        get_nominals=fmu.getNominalsOfContinuousStates,
        set_time=set_time,
        input=None,
        startTime=0.0,
        relativeTolerance=tolerance,
        maxNumSteps=10_000_000,
    )
    y = np.zeros(SAMPLES)
    for k in range(SAMPLES):
        solver.step(k / SAMPLES, (k + 1) / SAMPLES)
        y[k] = fmu.getReal([len(model.inputs)])[0]
    steps = ctypes.c_long()
    sundials_cvode.CVodeGetNumSteps(ctypes.c_void_p(solver.cvode_mem), ctypes.byref(steps))
    fmu.terminate()
    fmu.freeInstance()
    return y, steps.value
