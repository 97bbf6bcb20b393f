"""Both FMUs of a part under one master with the same inputs: how far their numbers are apart.

python tests/twins.py --steps 100000 prints a line for each part.
"""

import argparse
import tempfile
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from pathlib import Path

import numpy as np
from driven import driven
from examples import PRELUDE, everything, run_master, two_ports
from numpy.typing import NDArray
from ready_parts import reduction

from fmu_src.native_fmu import build_native_fmu
from fmu_src.python_fmu import build_python_fmu
from fmu_src.runtime.model import Floats, ReducedModel, row_starts

EPS = float(np.finfo(float).eps)
DAMPED = 1e-12  # of the peak: roundings die down with the motion

MASTER = """
part = Part(sys.argv[1])
begin = [v.name for v in part.description.modelVariables if v.variability == "fixed"]
part.initialise(**{name.replace(".", "__"): 0.1 * (k + 1) for k, name in enumerate(begin)})
with np.load(sys.argv[2]) as file:
    h, u, settings = file["h"], file["u"].tolist(), file["settings"]
reals = [v for v in part.description.modelVariables if v.type == "Real"]
outputs = [v.valueReference for v in reals if v.causality == "output"]
states = [v.valueReference for v in reals if v.name.startswith(("modes.amplitude", "modes.velocity"))
          or ".prescribed_" in v.name and not v.name.startswith("der(")]
inputs = [v.valueReference for v in reals if v.causality == "input"]
damping = [part.vr["damping.alpha"], part.vr["damping.beta"]]
rows, t, last = np.empty((len(h), len(outputs + states))), 0.0, None
for k, size in enumerate(h.tolist()):
    if last is None or (settings[k] != last).any():
        last = settings[k]
        part.fmu.setReal(damping, last[:2].tolist())
        part.fmu.setInteger([part.vr["modes.active"]], [int(last[2])])
    part.fmu.setReal(inputs, u[k])
    part.step(t, size)
    t += size
    rows[k] = part.fmu.getReal(outputs + states)
np.save(sys.argv[3], rows)
"""


@dataclass(frozen=True)
class Difference:
    """|native − Python| of outputs, amplitudes, modal velocities over a run, as parts of each one's peak.

    damped: the largest where every mode is elastic and damped; other: the largest of the rest, in units of
    N·ε·(1 + ωh); NaN where there is no such variable.
    """

    damped: float
    other: float


def tuned_steps(model: ReducedModel, steps: int) -> Floats:
    """α, β, modes.active for each step, changed every 50."""
    rng = np.random.default_rng(9)
    r = model.r
    changes = -(-steps // 50)
    table = np.column_stack(
        [rng.uniform(0.1, 1.0, changes), rng.uniform(1e-4, 1e-2, changes), rng.integers(0, r + 1, changes)]
    )
    return np.repeat(table, 50, axis=0)[:steps]


def inputs(model: ReducedModel, steps: int, *, tuned: bool) -> Mapping[str, Floats]:
    """Random forces and step sizes from a twentieth of the shortest to twice the longest 1/ω.

    Every other size is one of 24, more than are kept.
    """
    rng = np.random.default_rng(8)
    omega = np.sqrt(model.lam[model.lam > 0])
    low, high = np.log10([0.05 / omega[-1], 2 / omega[0]])
    h = 10.0 ** rng.uniform(low, high, steps)
    h[::2] = (10.0 ** rng.uniform(low, high, 24))[rng.integers(0, 24, len(h[::2]))]
    own = np.tile([model.alpha, model.beta, float(model.r)], (steps, 1))
    return {
        "h": h,
        "u": rng.standard_normal((steps, len(model.inputs))),
        "settings": tuned_steps(model, steps) if tuned else own,
    }


def run(fmu: Path, given: Mapping[str, Floats]) -> Floats:
    """Outputs, x and ẋ after each step, (steps, p + 2n), in a process of its own."""
    folder = fmu.parent
    np.savez(folder / "inputs.npz", **given)
    run_master(PRELUDE + MASTER, fmu, folder / "inputs.npz", folder / "rows.npy", cwd=folder)
    rows: Floats = np.load(folder / "rows.npy")
    assert np.isfinite(rows).all()
    return rows


def modes_of(model: ReducedModel) -> NDArray[np.bool_]:
    """Which coordinates each output, entry of x and of ẋ is made of, (p + 2n, n); coupled modes all alike.

    A prescribed motion drags all modes.
    """
    starts, one = row_starts(model.laws), np.eye(len(model.lam), dtype=bool)
    rows = [(model.C[a:b] != 0).any(axis=0) | (a == b) for a, b in pairwise(starts)]  # energies of all
    modes = np.vstack([*rows, one, one])
    modes[:, model.coupled] |= modes[:, model.coupled].any(axis=1, keepdims=True)
    modes[:, : model.k] = True
    return modes


def difference(model: ReducedModel, h: Floats, native: Floats, python: Floats) -> Difference:
    """Of two runs of this model with these step sizes."""
    modes = modes_of(model)
    still = ~((model.lam > 0) & (model.damping(model.alpha, model.beta) > 0))
    undamped = modes[:, still].any(axis=1)
    phase = np.where(modes & still, np.sqrt(model.lam) * h.max(), 0.0).max(axis=1)
    peak = np.abs(python).max(axis=0)
    apart = np.abs(native - python).max(axis=0) / np.where(peak > 0, peak, 1.0)
    return Difference(
        float(apart[~undamped].max()) if not undamped.all() else np.nan,
        float((apart / (len(h) * EPS * (1 + phase)))[undamped].max()) if undamped.any() else np.nan,
    )


def difference_of_twins(model: ReducedModel, steps: int, folder: Path, *, tuned: bool = False) -> Difference:
    """Build and run both FMUs."""
    given = inputs(model, steps, tuned=tuned)
    native = run(build_native_fmu(model, folder / "native.fmu"), given)
    python = run(build_python_fmu(model, folder / "python.fmu"), given)
    return difference(model, given["h"], native, python)


def undamped() -> ReducedModel:
    """Six modes, two of them rigid, that nothing brakes."""
    return two_ports("undamped", alpha=0.0, beta=0.0, D_rest=np.zeros((6, 6)))


def elastic() -> ReducedModel:
    """Every law and coupled modes, none of them rigid."""
    return everything("elastic", lam=np.array([3.0, 7.0, 30.0, 30.0, 400.0, 9000.0, 2e4]))


def ready_model(name: str) -> ReducedModel:
    return reduction(name).model


PARTS: Mapping[str, Callable[[], ReducedModel]] = {
    **{name: partial(ready_model, name) for name in ("bracket", "cantilever", "ring", "tuning_fork")},
    "two_ports": two_ports,
    "undamped": undamped,
    "everything": everything,
    "everything elastic": elastic,
    "driven": driven,
    "driven, dragged by α": partial(driven, dashpots=False, k=2),
}

TUNED = ("two_ports", "everything", "driven")  # also with α, β and modes.active changed while running


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--steps", type=int, default=100_000)
    steps = parser.parse_args().steps
    print(f"{'part':30}{'of the peak':>14}{'of N ε (1 + ωh)':>18}{'s':>8}")
    for name, make in PARTS.items():
        for tuned in (False, True) if name in TUNED else (False,):
            with tempfile.TemporaryDirectory() as folder:
                start = time.perf_counter()
                found = difference_of_twins(make(), steps, Path(folder), tuned=tuned)
                label = name + (", tuned while running" if tuned else "")
                took = time.perf_counter() - start
                print(f"{label:30}{found.damped:14.1e}{found.other:18.1e}{took:8.1f}", flush=True)


if __name__ == "__main__":
    main()
