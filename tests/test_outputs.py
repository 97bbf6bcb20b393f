"""What is measured, of a model with every kind of input and output: laws, feed-through, level of detail."""

import numpy as np
import pytest
from examples import everything
from scipy.linalg import expm

from fmu_src.runtime.instance import Instance
from fmu_src.runtime.model import Floats, ReducedModel, row_starts
from fmu_src.runtime.outputs import mises

U = np.array([1.0, -2.0, 3.0, 0.5, -9.81, 2.0, 1.0])


def started(model: ReducedModel, u: Floats = U) -> Instance:
    instance = Instance(model)
    instance.initialising = False
    instance.set_inputs(np.arange(len(u)), u)
    return instance


def measured(instance: Instance) -> dict[str, float]:
    model, y = instance.model, instance.reals()[instance.layout.outputs]
    return dict(zip(model.outputs, y.tolist(), strict=True))


def by_hand(model: ReducedModel, q: Floats, v: Floats, u: Floats) -> dict[str, float]:
    """Every output from the displayed equations, row by row, with D̃ as one full matrix."""
    D = model.alpha * np.eye(len(q)) + model.beta * np.diag(model.lam) + model.D_rest
    a = model.B @ u - D @ v - model.lam * q
    C, R, start = model.C, model.R, dict(zip(model.outputs, row_starts(model.laws), strict=False))

    def row(name: str, x: Floats, k: int = 0) -> float:
        return float(C[start[name] + k] @ x + R[start[name] + k] @ u)

    xx, yy, zz, xy, yz, zx = (row("left.stress.mises", q, k) for k in range(6))
    deviator = np.array([[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]]) - np.eye(3) * (xx + yy + zz) / 3
    values = {
        name: row(name, q) for name in model.outputs if name.split(".")[1] in ("displacement", "rotation")
    }
    values |= {n: float(C[start[n]] @ v) for n in ("left.velocity.x", "left.angular_velocity.z")}
    values |= {name: row(name, a) for name in model.outputs if "acceleration" in name}
    values["left.stress.xy"] = row("left.stress.xy", q)
    values["left.stress.mises"] = float(np.sqrt(1.5 * np.sum(deviator**2)))  # √(3 J₂)
    for name in ("clamp.reaction.x", "clamp.reaction.z"):
        values[name] = row(name, a + model.alpha * v) + float(C[start[name] + 1] @ v)
    values["energy.kinetic"] = 0.5 * float(v @ v)
    values["energy.strain"] = 0.5 * float(q @ (model.lam * q) + u @ model.R_in @ u)
    return values


@pytest.mark.parametrize("coupled", [True, False])
def test_every_output_follows_its_equation(coupled: bool) -> None:
    """After two steps, against expm of the full state matrix and the laws written out."""
    model = everything(coupled=coupled)
    instance, h, r = started(model), 0.013, len(model.lam)
    D = model.alpha * np.eye(r) + model.beta * np.diag(model.lam) + model.D_rest
    A = np.block(
        [[np.zeros((r, r)), np.eye(r)], [-np.diag(model.lam), -D]],
    )
    force = np.concatenate([np.zeros(r), model.B @ U])
    full = np.block([[A, force[:, None]], [np.zeros((1, 2 * r + 1))]])
    x = np.concatenate([np.zeros(2 * r), [1.0]])
    for k in range(2):
        assert instance.advance(k * h, h) is None
        x = expm(full * h) @ x
    expected = by_hand(model, x[:r], x[r : 2 * r], U)
    found = measured(instance)
    assert found.keys() == expected.keys()
    for name, value in expected.items():
        # expm loses ε‖Ah‖ = 2e-16 · 260 of the largest state, which accelerations enlarge by λ ≈ 2e4
        assert found[name] == pytest.approx(value, rel=1e-9, abs=1e-9), name


def test_modes_that_are_off_follow_statically() -> None:
    """With the residual, displacements and energy at rest in equilibrium do not depend on modes.active."""
    lam = np.array([3.0, 7.0, 30.0, 30.0, 400.0, 9000.0, 2e4])
    model = everything(lam=lam, initial="static")
    full = Instance(model)
    full.set_inputs(np.arange(7), U)
    whole = measured(full)
    still = [n for n in model.outputs if n.split(".")[1] in ("displacement", "rotation", "stress", "strain")]
    assert len(still) == 6
    for active in (6, 3, 0):
        full.set_active(active)
        assert full.state.q[active:].any() == 0
        part = measured(full)
        for name in still:
            assert part[name] == pytest.approx(whole[name], rel=1e-12), name
    truncated = Instance(everything(lam=lam, initial="static", residual=False))
    truncated.set_inputs(np.arange(7), U)
    truncated.set_active(3)
    assert abs(measured(truncated)["left.displacement.x"] / whole["left.displacement.x"] - 1) > 1e-3


def test_modes_that_are_off_do_not_couple() -> None:
    """With four active modes the model moves as if it had these four alone."""
    model, n = everything(residual=False), 4
    few = everything(
        lam=model.lam[:n],
        D_rest=model.D_rest[:n, :n],
        B=model.B[:n],
        C=model.C[:, :n].copy(),
        residual=False,
    )
    instances = [started(model), started(few)]
    instances[0].set_active(n)
    for instance in instances:
        for k in range(3):
            assert instance.advance(0.05 * k, 0.05) is None
    large, small = map(measured, instances)
    for name, value in small.items():
        assert large[name] == pytest.approx(value, rel=1e-12, abs=1e-14), name


def test_a_saved_state_brings_back_the_level_of_detail() -> None:
    model = everything()
    instance = started(model)
    instance.set_active(5)
    instance.advance(0.0, 0.02)
    saved, before = instance.save(), measured(instance)
    instance.set_active(7)
    instance.advance(0.02, 0.02)
    assert measured(instance) != before
    instance.restore(saved)
    assert measured(instance) == before


@pytest.mark.parametrize(
    ("stress", "expected"),
    [
        ([5.0, 0, 0, 0, 0, 0], 5.0),
        ([4.0, 4.0, 4.0, 0, 0, 0], 0.0),
        ([0, 0, 0, 2.0, 0, 0], 2 * np.sqrt(3)),
        ([0, 0, 0, 0, 0, 2.0], 2 * np.sqrt(3)),
        ([3.0, -3.0, 0, 0, 1.0, 0], np.sqrt(30)),
    ],
)
def test_von_mises_of_textbook_states(stress: list[float], expected: float) -> None:
    assert mises(np.array([stress]))[0] == pytest.approx(expected, rel=1e-15)
