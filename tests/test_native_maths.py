"""The maths of the C twin alone: coefficients and steps, against 60 digits and the Python twin."""

import ctypes
import math
from ctypes import c_void_p
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from examples import two_ports
from native_maths import Run, maths, native_propagator
from test_propagator import NAMES, PROMISE, assert_promise_is_kept

from fmu_src.runtime.model import OUTPUT_UNITS, Floats, ReducedModel
from fmu_src.runtime.propagator import propagator
from fmu_src.runtime.step import acceleration, at_rest, static_solution, step

EPS = np.finfo(float).eps


def test_coefficients_are_exact() -> None:
    """The promise of the Python twin, 3e-15·(1 + ωh), kept by other code with another exp, sin and cos."""
    assert_promise_is_kept(native_propagator, 600)


def test_coefficients_of_both_twins_agree() -> None:
    """Over all cases at once: each is within the promise of the truth, so within two of the other."""
    rng = np.random.default_rng(11)
    count, worst = 4000, dict.fromkeys(NAMES, 0.0)
    for h in 10.0 ** rng.uniform(-9, 2, 40):
        lam = 10.0 ** rng.uniform(-30, min(16, 18 - 2 * np.log10(h)), count)
        d = 2 * np.sqrt(lam) * 10.0 ** rng.uniform(-6, 6, count)
        near = slice(0, count // 4)
        d[near] = 2 * np.sqrt(lam[near]) * (1 + 10.0 ** rng.uniform(-17, -1, count // 4))
        lam[::97] = 0.0
        d = np.minimum(d, 1e9)
        ours, python = native_propagator(lam, d, h), propagator(lam, d, h)
        around = [propagator(lam, d, h * 2.0**k) for k in (-1, -0.5, 0, 0.5, 1)]
        for name in NAMES:
            scale = np.max([np.abs(getattr(P, name)) for P in around], axis=0)
            unit = 2 * PROMISE * (1 + np.sqrt(lam) * h) * scale
            difference = np.abs(getattr(ours, name) - getattr(python, name))[scale > 1e-290]
            worst[name] = max(worst[name], float((difference / unit[scale > 1e-290]).max()))
    assert max(worst.values()) <= 1.0, worst


@pytest.mark.parametrize("twin", [propagator, native_propagator], ids=["python", "native"])
@pytest.mark.parametrize(("lam", "d"), [(400.0, 0.4), (400.0, 40.0), (400.0, 100.0), (1e16, 1e3)])
def test_an_enormous_step_is_right_or_not_a_number(twin: Any, lam: float, d: float) -> None:
    """Up to where λh² or h² overflows: the equilibrium G₀ = 1/λ; then no number, never a wrong one."""
    for exponent in np.arange(100, 308.2, 0.5):
        h = 10.0 ** float(exponent)
        with np.errstate(all="ignore"):
            found = float(twin(np.array([lam]), np.array([d]), h).G0[0])
        if not math.isnan(found) or h < 1e140:
            assert found == pytest.approx(1 / lam, rel=1e-14, abs=0), h


@dataclass(frozen=True)
class Motion:
    """q, q̇, q̈, q⃛, q⃜ (1 + steps, 5, r) and y (1 + steps, p) before the first step and after each."""

    derivatives: Floats
    outputs: Floats


def inputs_of(model: ReducedModel, steps: int, *, held: bool) -> dict[str, Floats | int | float]:
    """The arrays of a run, as they stand in an .npz file."""
    rng = np.random.default_rng(4)
    u = rng.standard_normal((steps, 3, len(model.inputs))) * np.array([1.0, 5.0, 25.0])[:, None]
    kinds = np.array([[*OUTPUT_UNITS].index(kind) for kind in model.output_kinds], dtype=np.int32)
    arrays = {key: getattr(model, key) for key in ("lam", "D_rest", "B", "C")}
    h = 10.0 ** rng.uniform(-4, 0, steps)
    h[1::3] = 0.02  # kept coefficients too
    return {
        **arrays,
        "u": u,
        "h": h,
        "kinds": kinds,
        "alpha": model.alpha,
        "beta": model.beta,
        "initial_static": int(model.initial == "static"),
        "held": int(held),
    }


def native_run(path: Path) -> Motion:
    with np.load(path) as file:
        arrays = {name: np.ascontiguousarray(file[name]) for name in file.files}
    (p, r), (steps, _, m) = arrays["C"].shape, arrays["u"].shape
    scalars = {key: arrays.pop(key).item() for key in ("alpha", "beta", "initial_static", "held")}
    run = Run(r=r, m=m, p=p, steps=steps, **{k: a.ctypes.data for k, a in arrays.items()}, **scalars)
    derivatives, outputs = np.full((1 + steps, 5, r), np.nan), np.full((1 + steps, p), np.nan)
    made = maths().run_steps(
        ctypes.byref(run), c_void_p(derivatives.ctypes.data), c_void_p(outputs.ctypes.data)
    )
    assert made == steps
    return Motion(derivatives, outputs)


def python_run(path: Path) -> Motion:
    """The functions of step.py, and the derivatives of q̈ + d q̇ + λ q = f."""
    with np.load(path) as x:
        lam, B, C, kinds = x["lam"], x["B"], x["C"], x["kinds"]
        d = x["alpha"] + x["beta"] * lam + np.diag(x["D_rest"])
        f = np.array([[B @ order for order in u] for u in x["u"]])  # (steps, 3, r)
        if x["held"]:
            f[:, 1:] = 0.0
        sizes, static = x["h"], bool(x["initial_static"])
    state = static_solution(lam, f[0, 0]) if static else at_rest(len(lam))
    derivatives, now = [], np.array([f[0, 0], 0 * lam, 0 * lam])

    def note() -> None:
        a = acceleration(lam, d, state, now[0])
        jerk = now[1] - d * a - lam * state.v
        derivatives.append([state.q, state.v, a, jerk, now[2] - d * jerk - lam * a])

    note()
    for h, (f0, f1, f2) in zip(sizes, f, strict=True):
        state = step(propagator(lam, d, float(h)), state, f0, f1, f2)
        now = np.array([f0 + h * f1 + h**2 / 2 * f2, f1 + h * f2, f2])
        note()
    all_of_them = np.array(derivatives)
    outputs = np.array([[C[row] @ x[kind] for row, kind in enumerate(kinds)] for x in all_of_them])
    return Motion(all_of_them, outputs)


@pytest.mark.parametrize("held", [True, False], ids=["held", "with rates"])
@pytest.mark.parametrize("initial", ["rest", "static"])
@pytest.mark.parametrize("copies", [1, 4])  # 6 modes in one register, 24 in three
def test_steps_agree_on_the_same_file(tmp_path: Path, held: bool, initial: str, copies: int) -> None:
    """Identical .npz inputs: state, its derivatives and outputs after each of 60 steps of many sizes."""
    base = two_ports(initial="rest")
    lam = np.sort(np.repeat([3.0, 7.0, 30.0, 30.0, 400.0, 9000.0], copies))
    if initial == "rest":
        lam[:copies] = 0.0
    rng = np.random.default_rng(6)
    r = len(lam)
    model = two_ports(
        lam=lam,
        D_rest=np.diag(np.repeat(np.diag(base.D_rest), copies)),
        B=rng.standard_normal((r, 3)),
        C=rng.standard_normal((5, r)),
        initial=initial,
    )
    path = tmp_path / "run.npz"
    np.savez(path, **inputs_of(model, 60, held=held))
    native, python = native_run(path), python_run(path)
    # each step rounds by the promise of its coefficients, 1 + ωh ≤ 100 for the fastest mode
    bound = 60 * 100 * EPS
    for order in range(5):
        peak = np.abs(python.derivatives[:, order]).max(axis=0) + 1e-300
        assert (np.abs(native.derivatives[:, order] - python.derivatives[:, order]) <= bound * peak).all()
    peak = np.abs(python.outputs).max(axis=0)
    assert (np.abs(native.outputs - python.outputs) <= bound * peak).all()
    assert (peak > 0.01).all()
    first = np.abs(python.derivatives[0, 0])
    assert (first > 0).all() if initial == "static" else (first == 0).all()
