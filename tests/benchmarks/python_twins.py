"""One ctypes driver for three FMUs of the same part: native, Python twin, pythonfmu with getters."""

import ctypes
import time
from ctypes import c_double, c_uint
from pathlib import Path

import numpy as np
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave
from parts import HERE, Unpacked
from pythonfmu import FmuBuilder

from fmu_src.python_fmu import build_python_fmu
from fmu_src.runtime.model import Floats, ReducedModel
from fmu_src.runtime.propagator import propagator

H = 1e-3  # s
PATTERNS = 16


class Driven:
    """An FMU with everything that its calls need made beforehand."""

    def __init__(self, fmu: Path, m: int, p: int, patterns: Floats) -> None:
        description = read_model_description(str(fmu), validate=False)
        place = {v.name: v.valueReference for v in description.modelVariables}
        inputs = [v.name for v in description.modelVariables if v.causality == "input"]
        outputs = [v.name for v in description.modelVariables if v.causality == "output"]
        self.slave = FMU2Slave(
            guid=description.guid,
            unzipDirectory=extract(str(fmu)),
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName="one",
        )
        self.slave.instantiate()
        self.slave.setupExperiment(startTime=0.0)
        self.slave.enterInitializationMode()
        self.slave.exitInitializationMode()
        self.references = (c_uint * m)(*(place[name] for name in inputs))
        self.asked = (c_uint * p)(*(place[name] for name in outputs))
        self.values = (c_double * p)()
        self.patterns = [(c_double * m)(*row) for row in patterns]
        self.library = ctypes.CDLL(
            self.slave.dll._name
        )  # functions without argument types: nothing is converted
        self.m, self.p, self.step = ctypes.c_size_t(m), ctypes.c_size_t(p), 0

    def cycles(self, count: int) -> float:
        """Seconds for a cycle of set, step and get."""
        library, component = self.library, ctypes.c_void_p(self.slave.component)
        set_real, do_step, get_real = library.fmi2SetReal, library.fmi2DoStep, library.fmi2GetReal
        h, status, start = c_double(H), 0, time.perf_counter()
        for k in range(self.step, self.step + count):
            status |= set_real(component, self.references, self.m, self.patterns[k % PATTERNS])
            status |= do_step(component, c_double(k * H), h, 1)
            status |= get_real(component, self.asked, self.p, self.values)
        taken = time.perf_counter() - start
        self.step += count
        if status != 0:
            raise RuntimeError("a call was refused")
        return taken / count


def empty_cycles(one: Driven, count: int) -> float:
    """Seconds for three calls that do nothing, with as many arguments: what ctypes itself costs."""
    component, h, nothing = ctypes.c_void_p(None), c_double(H), one.library.fmi2FreeInstance
    zero, start = ctypes.c_size_t(0), time.perf_counter()
    for k in range(count):
        nothing(component, one.references, zero, one.patterns[k % PATTERNS])
        nothing(component, c_double(k * H), h, 1)
        nothing(component, one.asked, zero, one.values)
    return (time.perf_counter() - start) / count


def getter_fmu(model: ReducedModel, scratch: Path) -> Path:
    """The slave of getter_slave.py with the numbers of this part."""
    P = propagator(model.lam, model.damping(model.alpha, model.beta), H)
    data = scratch / "getter_part.npz"
    moving = np.array([law == "velocity" for law in model.laws])
    np.savez(data, coefficients=[P.E11, P.E12, P.E21, P.E22, P.G0], B=model.B, C=model.C, moving=moving)
    script = scratch / f"getter_{model.name}.py"  # pythonfmu finds an FMU's code by its module name
    script.write_text((HERE / "getter_slave.py").read_text(encoding="utf-8"), encoding="utf-8")
    target = scratch / f"getter_{model.name}.fmu"
    return Path(FmuBuilder.build_FMU(script, dest=target, project_files=[data]))


def compare(native: Unpacked, scratch: Path, batches: int) -> dict[str, float]:
    """Medians over the batches, in µs a cycle, and of the ratios to the native FMU."""
    model = native.model
    m, p = len(model.inputs), len(model.outputs)
    patterns = np.random.default_rng(2).standard_normal((PATTERNS, m))
    twin = build_python_fmu(model, scratch / f"python_{model.name}.fmu")
    fmus = [native.fmu, twin, getter_fmu(model, scratch)]
    driven = [Driven(fmu, m, p, patterns) for fmu in fmus]
    times = np.array(
        [[*(one.cycles(100) for one in driven), empty_cycles(driven[0], 100)] for _ in range(batches)]
    )
    values = [np.array(one.values) for one in driven]
    scale = np.abs(values[0]).max()
    if max(np.abs(other - values[0]).max() for other in values[1:]) > 1e-9 * scale:
        raise RuntimeError("the three FMUs do not compute the same")
    native_us, twin_us, getter_us, empty_us = np.median(times, axis=0) * 1e6
    ratios = np.median(times / times[:, :1], axis=0)
    return {
        "native": native_us,
        "twin": twin_us,
        "getters": getter_us,
        "empty": empty_us,
        "twin ratio": ratios[1],
        "getters ratio": ratios[2],
    }
