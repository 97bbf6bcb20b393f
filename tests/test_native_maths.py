"""The maths of the C twin alone: coefficients and steps, against 60 digits and the Python twin."""

import ctypes
import math
from ctypes import c_void_p
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from driven import part, reduced
from examples import everything, legal
from native_maths import Run, maths, native_propagator
from native_outputs import measured
from native_reader import LAWS
from test_propagator import NAMES, PROMISE, assert_promise_is_kept

from fmu_src.runtime.coupled import coupled_propagator
from fmu_src.runtime.model import Floats, ReducedModel
from fmu_src.runtime.outputs import feedthrough, rows_by_law
from fmu_src.runtime.outputs import outputs as measure
from fmu_src.runtime.propagator import propagator
from fmu_src.runtime.resources import ARRAYS
from fmu_src.runtime.step import State, at_rest, coupled_step, keep_modes, static_solution, step

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
    """x … x⃜ (1 + steps, 5, n) and y, ẏ, ÿ (1 + steps, 3, p) before the first step and after each."""

    derivatives: Floats
    outputs: Floats


def run_file(model: ReducedModel, steps: int, *, held: bool) -> dict[str, Any]:
    """The arrays of a run, as they stand in an .npz file; every tenth step other modes are active."""
    rng = np.random.default_rng(4)
    m, k, r = len(model.inputs), model.k, model.r
    arrays = {key: getattr(model, key) for key in ARRAYS}
    h = 10.0 ** rng.uniform(-4, 0, steps)
    h[1::3] = 0.02  # kept coefficients too
    active = np.repeat(k + np.array([r, *rng.integers(1, r + 1, steps // 10 - 2), r]), 10)
    return {
        **arrays,
        "motions": model.motions.astype(np.uintp),
        "start": rng.standard_normal(2 * k),
        "u": rng.standard_normal((steps, 3, m)) * np.array([1.0, 5.0, 25.0])[:, None],
        "h": h,
        "laws": np.array([LAWS.index(law) for law in model.laws], dtype=np.int32),
        "active": active.astype(np.int32),
        "alpha": model.alpha,
        "beta": model.beta,
        "initial_static": int(model.initial == "static"),
        "residual": int(model.residual),
        "held": int(held),
    }


def native_run(path: Path) -> Motion:
    with np.load(path) as file:
        arrays = {name: np.ascontiguousarray(file[name]) for name in file.files}
    scalars = {k: arrays.pop(k).item() for k in ("alpha", "beta", "initial_static", "residual", "held")}
    (s, n), (steps, _, m), p = arrays["C"].shape, arrays["u"].shape, len(arrays["laws"])
    sizes = {"k": len(arrays["motions"]), "n": n, "m": m, "p": p, "s": s, "steps": steps}
    run = Run(**sizes, **{key: a.ctypes.data for key, a in arrays.items()}, **scalars)
    derivatives, outputs = np.full((1 + steps, 5, n), np.nan), np.full((1 + steps, 3, p), np.nan)
    made = maths().run_steps(
        ctypes.byref(run), c_void_p(derivatives.ctypes.data), c_void_p(outputs.ctypes.data)
    )
    assert made == steps
    return Motion(derivatives, outputs)


def python_run(model: ReducedModel, path: Path) -> Motion:
    """The functions of step.py, and the derivatives of ẍ + D̃ ẋ + λ x = f; y by outputs.py, with R u̇."""
    with np.load(path) as x:
        lam, B, start, held = x["lam"], x["B"], x["start"], bool(x["held"])
        inputs, sizes, levels = x["u"] * [[1.0], [0.0], [0.0]] if held else x["u"], x["h"], x["active"]
    n, k, N, damping = len(lam), model.k, model.drag(model.alpha), (model.alpha, model.beta)
    D = np.diag(model.damping(*damping))
    D[k:, k:] += model.D_rest[k:, k:] - np.diag(np.diag(model.D_rest[k:, k:]))
    state, (s, s_dot) = at_rest(n), np.split(start, 2)
    state.q[:k], state.v[:k] = s, s_dot
    if model.initial == "static":
        state.q[k:] = static_solution(lam[k:], (B @ inputs[0, 0] + N @ s_dot)[k:]).q
    derivatives, outputs = [], []

    def force(u: Floats, s_dot: Floats) -> Floats:
        """f, ḟ, f̈, f⃛ (4, n) of inputs with two rates, (3, m)."""
        rates = np.vstack([s_dot, u[:, model.motions]])
        return np.vstack([u, 0 * u[:1]]) @ B.T + rates @ N.T

    def note(u: Floats, active: int) -> None:
        on = np.arange(n) < active
        f = force(u, state.v[:k]) * on
        motion = [state.q, state.v]
        for order in range(3):
            motion.append((f[order] - D @ motion[-1] - lam * motion[-2]) * on)
        through = feedthrough(model, active)
        rows = rows_by_law(model, through.R)
        y = measure(model, rows, through.R_in, damping, State(*motion[:2]), motion[2], u[0])
        one = rows.get("velocity")
        if one is not None and one.R is not None:
            y[one.places] += one.R @ u[1]
        derivatives.append(motion)
        outputs.append(y)

    note(np.array([inputs[0, 0], *(0 * inputs[0, 1:])]), n)
    for h, (u, u1, u2), active in zip(sizes, inputs, levels, strict=True):
        state = keep_modes(state, active)
        alone = propagator(lam[:active], np.diag(D)[:active], float(h))
        f = force(np.array([u, u1, u2]), state.v[:k])[:, :active]
        moved = step(alone, State(state.q[:active], state.v[:active]), *f)
        off = D[:active, :active] - np.diag(np.diag(D[:active, :active]))
        group = np.flatnonzero(off.any(axis=1))
        if len(group):
            together = coupled_propagator(lam[group], D[np.ix_(group, group)], float(h))
            of_group = coupled_step(together, State(state.q[group], state.v[group]), *f[:, group])
            moved.q[group], moved.v[group] = of_group.q, of_group.v
        rest = np.zeros(n - active)
        state = State(np.concatenate([moved.q, rest]), np.concatenate([moved.v, rest]))
        note(np.array([u + h * u1 + h**2 / 2 * u2, u1 + h * u2, u2]), int(active))
    return Motion(np.array(derivatives), np.array(outputs))


def larger(copies: int, *, rigid: bool, coupled: bool) -> ReducedModel:
    """`everything` with several modes for one of its own."""
    rng = np.random.default_rng(6)
    lam = np.sort(np.repeat([3.0, 7.0, 30.0, 30.0, 400.0, 9000.0], copies))
    if rigid:
        lam[:copies] = 0.0
    r, s, ports = len(lam), len(everything().C), everything().ports
    w = rng.standard_normal((r, 2)) * coupled
    w[1::4] = 0.0
    return everything(
        D_rest=np.diag(rng.uniform(0.0, 2.0, r)) + w @ w.T,
        **legal(ports, lam, rng.standard_normal((r, 7)), rng.standard_normal((s, r))),
        initial="rest" if rigid else "static",
    )


@pytest.mark.parametrize("held", [True, False], ids=["held", "with rates"])
@pytest.mark.parametrize("start", ["rest", "static"])
@pytest.mark.parametrize("dashpots", [True, False], ids=["coupled", "alone"])
@pytest.mark.parametrize("k", [1, 3])
def test_driven_steps_agree_on_the_same_file(
    tmp_path: Path, held: bool, start: str, dashpots: bool, k: int
) -> None:
    """The same with ports that are moved."""
    model = reduced(part(k=k, dashpots=dashpots), initial=start)
    path = tmp_path / "run.npz"
    np.savez(path, **run_file(model, 60, held=held))
    native, python = native_run(path), python_run(model, path)
    bound = 60 * 100 * EPS
    for found, expected in (
        (native.derivatives, python.derivatives),
        (native.outputs[:, :1], python.outputs[:, None]),
    ):
        order = np.abs(expected).reshape(len(expected), -1, expected.shape[-1])
        peak = order.max(axis=(0, 2), keepdims=True)
        assert (np.abs(found.reshape(order.shape) - expected.reshape(order.shape)) <= bound * peak).all()


@pytest.mark.parametrize("held", [True, False], ids=["held", "with rates"])
@pytest.mark.parametrize("rigid", [True, False], ids=["from rest", "static start"])
@pytest.mark.parametrize("coupled", [True, False], ids=["coupled", "alone"])
@pytest.mark.parametrize("copies", [1, 4])  # 6 modes in one register, 24 in three
def test_steps_agree_on_the_same_file(
    tmp_path: Path, held: bool, rigid: bool, coupled: bool, copies: int
) -> None:
    """Identical .npz inputs: state, its derivatives and outputs after each of 60 steps of many sizes."""
    model = larger(copies, rigid=rigid, coupled=coupled)
    path = tmp_path / "run.npz"
    np.savez(path, **run_file(model, 60, held=held))
    native, python = native_run(path), python_run(model, path)
    # each step rounds by the promise of its coefficients, 1 + ωh ≤ 100 for the fastest mode
    bound = 60 * 100 * EPS
    for order in range(5):
        peak = np.abs(python.derivatives[:, order]).max(axis=0)
        peak = np.maximum(peak, peak.max() if coupled else 1e-300)
        assert (np.abs(native.derivatives[:, order] - python.derivatives[:, order]) <= bound * peak).all()
    peak = np.abs(python.outputs).max(axis=0)
    assert (np.abs(native.outputs[:, 0] - python.outputs) <= bound * peak).all()
    assert (peak > 0.01).all()
    first = np.abs(python.derivatives[0, 0])
    assert (first == 0).all() if rigid else (first > 0).all()


@pytest.mark.parametrize("coupled", [True, False], ids=["coupled", "alone"])
def test_derivatives_of_outputs_along_a_run(tmp_path: Path, coupled: bool) -> None:
    """ẏ and ÿ of every law from the states of the run itself, some modes being off."""
    model = larger(1, rigid=True, coupled=coupled)
    path = tmp_path / "run.npz"
    given = run_file(model, 30, held=False)
    np.savez(path, **given)
    found = native_run(path)
    for k in (3, 15, 28):
        h, (u, u1, u2) = given["h"][k], given["u"][k]
        ends = np.array([u + h * u1 + h**2 / 2 * u2, u1 + h * u2, u2])
        through = feedthrough(model, int(given["active"][k]))
        R_in = (through.R_in + through.R_in.T) / 2
        arrays = {key: given[key] for key in ("lam", "D_rest", "B", "C")}
        at_level = everything(**arrays, R=through.R, R_in=R_in)
        exact = measured(at_level, found.derivatives[1 + k], ends)
        difference = np.abs(found.outputs[1 + k] - exact)
        assert (difference <= 1e-11 * np.abs(exact).max(axis=1, keepdims=True)).all()
