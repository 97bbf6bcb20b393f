"""A part and a spring–damper on its port, two FMUs under a master: first order, second if iterated."""

import json
from math import cos, exp, sin, sqrt
from pathlib import Path

import numpy as np
import pytest
from examples import PRELUDE, oscillator, run_master
from pythonfmu import FmuBuilder

from fmu_src.python_fmu import build_python_fmu

# The part: m ẍ + d ẋ + k x = F + f; the spring–damper: f = −κ x − c ẋ; F from t = 0.
K, M, D = 400.0, 1.0, 0.4
KAPPA, C = 500.0, 3.0
F = 2.0
END = 0.21  # s, a period of the coupled system
STEPS = [100, 200, 400, 800]

MASTER = """
paths, counts, end, iterate, F = json.loads(sys.argv[1])
part, spring = Part(paths[0], "part").initialise(), Part(paths[1], "spring").initialise()

def spring_force(t, h):
    x, v = part.get("tip.displacement.x", "tip.velocity.x")
    spring.set("x", x)
    spring.set("v", v)
    spring.step(t, h)
    return spring.get("force")[0]

def run(count):
    h, t, f = end / count, 0.0, 0.0
    for k in range(count):
        t = k * h
        if iterate:
            before, mean = part.fmu.getFMUState(), f
            for _ in range(6):  # each brings the error down by κh²/4 + ch/2 ~ 4e-3
                part.fmu.setFMUState(before)
                part.set("tip.force.x", F + mean)
                part.step(t, h)
                after = spring_force(t, h)
                mean = (f + after) / 2
            part.fmu.freeFMUState(before)
            f = after
        else:
            part.set("tip.force.x", F + spring_force(t, h))
            part.step(t, h)
    return part.get("tip.displacement.x")[0]

start = part.fmu.getFMUState()
ends = []
for count in counts:
    part.fmu.setFMUState(start)
    ends.append(run(count))
print(json.dumps(ends))
"""


def coupled(t: float, stiffness: float = K + KAPPA, damping: float = D + C) -> float:
    """x(t) of m ẍ + (d + c) ẋ + (k + κ) x = F from rest, under-damped [2.34]."""
    a = damping / (2 * M)
    w = sqrt(stiffness / M - a**2)
    return F / stiffness * (1 - exp(-a * t) * (cos(w * t) + a / w * sin(w * t)))


@pytest.fixture(scope="module")
def fmus(tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    folder = tmp_path_factory.mktemp("coupled")
    part = build_python_fmu(oscillator(stiffness=K, mass=M, damping=D), folder / "part.fmu")
    spring = folder / "spring.fmu"
    FmuBuilder.build_FMU(Path(__file__).with_name("spring_damper_slave.py"), dest=spring)
    return [str(part), str(spring)]


def errors(fmus: list[str], folder: Path, iterate: bool) -> np.ndarray:
    """x(END) − closed form for each number of steps."""
    argument = json.dumps([fmus, STEPS, END, iterate, F])
    return np.array(json.loads(run_master(PRELUDE + MASTER, argument, cwd=folder))) - coupled(END)


def test_held_force_is_first_order(fmus: list[str], tmp_path: Path) -> None:
    """Gauss–Seidel with hold: the spring's force lags by half a step, so e ∝ h and nothing else is wrong."""
    e = errors(fmus, tmp_path, iterate=False)
    assert np.log2(e[:-1] / e[1:]) == pytest.approx(1.0, abs=0.1)
    # one order extrapolated away leaves O(h²): ω²h² = 6e-5 at the finest step
    extrapolated = 2 * e[1:] - e[:-1]
    assert abs(extrapolated[-1]) < 1e-4 * F / (K + KAPPA)
    assert np.log2(extrapolated[:-1] / extrapolated[1:]) == pytest.approx(2.0, abs=0.3)
    # the control: without the spring the part would be elsewhere by far more
    assert abs(coupled(END, K, D) - coupled(END)) > 0.1 * F / (K + KAPPA)


def test_iterated_mean_force_is_second_order(fmus: list[str], tmp_path: Path) -> None:
    """With the state rolled back until the force over the step is the mean of its ends: e ∝ h²."""
    e = errors(fmus, tmp_path, iterate=True)
    assert np.log2(e[:-1] / e[1:]) == pytest.approx(2.0, abs=0.1)
    assert abs(e[-1]) < 1e-4 * F / (K + KAPPA)
