"""What every master is made of: FMUs by their names, input polynomials, iterations, step-size control."""

from collections.abc import Callable

import numpy as np
import pytest
from coupled import Coupled, Linear
from examples import oscillator
from extrapolation import ORDER, Kind, observe, polynomial, predicted
from fixed_point import NotConverged, fixed_point
from fmu import Fmu
from gauss_seidel import gauss_seidel
from interface_newton import interface_newton
from jacobi import jacobi
from linear_part import LinearPart, state_space
from monolith import Monolith, after, output
from run import Step, points, run
from step_doubling import Control, step_doubling

from fmu_src.native_fmu import build_native_fmu
from fmu_src.runtime.model import Floats, ReducedModel

INPUTS, OUTPUTS = ["tip.force.x"], ["tip.displacement.x", "tip.velocity.x"]
K, C = 500.0, 3.0  # N/m, N·s/m between both oscillators
L = np.array([[-K, -C, K, C], [K, C, -K, -C]])
OMEGA = 30.0  # rad/s of the force


def models() -> tuple[ReducedModel, ReducedModel]:
    return oscillator("first"), oscillator("second", stiffness=900.0, mass=2.0, damping=0.6)


@pytest.fixture(scope="module")
def fmus(tmp_path_factory: pytest.TempPathFactory) -> tuple[Fmu, ...]:
    folder = tmp_path_factory.mktemp("masters")
    paths = [build_native_fmu(model, folder / f"{model.name}.fmu") for model in models()]
    return tuple(Fmu(path, INPUTS, OUTPUTS) for path in paths)


def force(t: float, order: int) -> Floats:
    """1 − cos ωt and its derivatives, on the first."""
    w = OMEGA
    return np.array([[1 - np.cos(w * t), w * np.sin(w * t), w**2 * np.cos(w * t)][order], 0.0])


def coupled(fmus: tuple[Fmu, ...]) -> Coupled:
    for fmu in fmus:
        fmu.restart()
    return Coupled(fmus, Linear(L, force))


def whole() -> Monolith:
    """Both oscillators, the spring, the damper and the force as one: ẋ = A x, y = C x."""
    M, D, S = (np.array(m) for m in ([1.0, 2.0], [0.4, 0.6], [400.0, 900.0]))
    joint = np.array([[1.0, -1.0], [-1.0, 1.0]])
    A = np.zeros((7, 7))  # x, x of both; v, v; 1, cos, sin
    A[:2, 2:4] = np.eye(2)
    A[2:4, :2] = -(np.diag(S) + K * joint) / M[:, None]
    A[2:4, 2:4] = -(np.diag(D) + C * joint) / M[:, None]
    A[2, 4:6] = 1.0, -1.0
    A[5, 6], A[6, 5] = -OMEGA, OMEGA
    rows = dict(zip(["x", "v", "x2", "v2"], np.eye(7)[[0, 2, 1, 3]], strict=True))
    return Monolith(A, np.r_[np.zeros(4), 1.0, 1.0, 0.0], {}, rows)


def exact(t: float) -> Floats:
    one = whole()
    x = after(one, t)
    return np.array([output(one, x, name) for name in one.outputs])


def exact_step(t: float, y: Floats, h: float) -> Floats:
    """y after a step from anywhere: displacements and velocities are all the state there is."""
    x, v, x2, v2 = y
    start = np.array([x, x2, v, v2, 1.0, np.cos(OMEGA * t), np.sin(OMEGA * t)])
    one = whole()
    end = after(one, h, start)
    return np.array([output(one, end, name) for name in one.outputs])


@pytest.mark.parametrize("rows", [1, 2, 3])
def test_an_fmu_is_the_linear_part_of_its_model(fmus: tuple[Fmu, ...], rows: int) -> None:
    """Three steps under polynomials: outputs and their two derivatives, against the matrix exponential."""
    model, fmu = models()[1], fmus[1]
    fmu.restart()
    part = LinearPart(state_space(model, INPUTS, OUTPUTS), np.zeros(2))
    for k, h in enumerate((0.01, 0.02, 0.04)):
        U = np.array([[1.0], [-30.0], [4000.0]])[:rows] * (k + 1)
        for one in (fmu, part):
            one.set(U)
            one.step((0.0, 0.01, 0.03)[k], h)
        for found, expected in (
            (fmu.outputs(), part.outputs()),
            (fmu.rates(1), part.rates(1)),
            (fmu.rates(2), part.rates(2)),
        ):
            np.testing.assert_allclose(found, expected, rtol=1e-11)


def test_a_roll_back_replays_to_the_bit(fmus: tuple[Fmu, ...]) -> None:
    system = coupled(fmus)
    run(system, jacobi("linear"), "linear", 0.01, 5)
    U = np.array([[1.0, 2.0], [30.0, -40.0]])
    with system.saved() as roll_back:
        first = system.stepped(0.05, 0.01, U)
        moved = system.stepped(0.06, 0.03, U)
        roll_back()
        assert (system.y() != first).all()
        np.testing.assert_array_equal(system.stepped(0.05, 0.01, U), first)
        np.testing.assert_array_equal(system.stepped(0.06, 0.03, U), moved)


@pytest.mark.parametrize("kind", [*ORDER])
def test_polynomials_end_where_they_should(fmus: tuple[Fmu, ...], kind: Kind) -> None:
    """They end at û, and begin with u and u̇ as far as their degree lets them."""
    system, h = coupled(fmus), 0.02
    *_, point = points(system, jacobi(kind), kind, 0.01, 4)
    u_end = np.array([3.0, -5.0])
    U = polynomial(kind, point, h, u_end)
    assert len(U) == ORDER[kind]
    end = sum(row * factor for row, factor in zip(U, (1.0, h, h**2 / 2), strict=False))
    np.testing.assert_allclose(end, u_end, rtol=1e-12)
    if kind != "hold":
        np.testing.assert_array_equal(U[0], system.law(point.t, point.y))
    if kind == "derivative":
        before, later = (system.law(point.t + s, exact_step(point.t, point.y, s)) for s in (-1e-5, 1e-5))
        np.testing.assert_allclose(U[1], (later - before) / 2e-5, rtol=1e-6)  # the third derivative, s²/6
        # Taylor's polynomial of the outputs: wrong by h³/6 of the third derivative
        wrong = [predicted(kind, point, s) - exact_step(point.t, point.y, s) for s in (1e-3, 5e-4)]
        assert np.log2(np.abs(wrong[0] / wrong[1])) == pytest.approx(3.0, abs=0.1)


@pytest.mark.parametrize("kind", [*ORDER])
def test_step_doubling_knows_its_error(fmus: tuple[Fmu, ...], kind: Kind) -> None:
    """The true error of every step that is kept is below the tolerance, and seldom far below.

    Of velocities: displacements are one order better, for them the estimate is on the safe side. It is wrong
    by O(h) itself: a tenth.
    """
    order, tolerance = ORDER[kind], 1e-4 if kind == "hold" else 1e-5
    control = Control(order, np.array([np.inf, tolerance, np.inf, tolerance]))
    found = step_doubling(coupled(fmus), jacobi(kind), kind, control, 0.02, 0.4)
    assert found[-1].t == pytest.approx(0.4)
    wrong = [
        np.abs(end.y - exact_step(begin.t, begin.y, end.t - begin.t))[[1, 3]].max()
        for begin, end in zip(found[:-2:2], found[2::2], strict=True)
    ]
    wrong = wrong[1:-1]  # linear extrapolation begins with a hold; the last step ends where it is told to
    assert max(wrong) < 1.1 * tolerance
    assert np.median(wrong) > tolerance * 2.0 ** -(order + 3)
    sizes = np.array([end.t - begin.t for begin, end in zip(found[:-2:2], found[2::2], strict=True)])
    assert sizes[:-1].max() > 1.9 * sizes[:-1].min()  # they follow the motion


def test_step_doubling_takes_the_steps_that_the_tolerance_asks_for(fmus: tuple[Fmu, ...]) -> None:
    """A hundredth of the tolerance, 100^(1/(p+1)) times the steps: to the factor two that steps have."""
    counts = []
    for tolerance in (1e-4, 1e-6):
        control = Control(3, tolerance)
        found = step_doubling(coupled(fmus), jacobi("derivative"), "derivative", control, 0.02, 0.4)
        counts.append(len(found))
        # all errors add up at most
        assert np.abs(found[-1].y - exact(0.4)).max() < tolerance * len(found) / 2
    assert counts[1] / counts[0] == pytest.approx(100**0.25, rel=0.5)


@pytest.fixture
def stiff(fmus: tuple[Fmu, ...]) -> Coupled:
    """Coupled so stiffly that at h = 0.05 no fixed point is found."""
    system = coupled(fmus)
    return Coupled(system.parts, Linear(100 * L, force))


def test_what_does_not_converge_is_told_and_undone(stiff: Coupled) -> None:
    run(stiff, interface_newton("linear"), "linear", 0.05, 2)
    before, point = stiff.y(), observe(stiff, "linear", 0.1)
    with pytest.raises(NotConverged, match=r"t = 0\.1, h = 0\.05"):
        fixed_point("linear")(stiff, point, 0.05)
    np.testing.assert_array_equal(stiff.y(), before)
    # Newton's method does it, and what it finds is a fixed point
    end = interface_newton("linear")(stiff, point, 0.05)
    np.testing.assert_allclose(end.u, stiff.law(end.t, stiff.y()), rtol=1e-12)


@pytest.mark.parametrize("kind", [*ORDER])
@pytest.mark.parametrize("master", [jacobi, gauss_seidel, fixed_point, interface_newton])
def test_orders_under_a_force_in_time(
    fmus: tuple[Fmu, ...], master: Callable[[Kind], Step], kind: Kind
) -> None:
    """1, 2, 3 against the exponential; the derivatives of the force are given like those of the parts."""
    wrong = []
    for count in (100, 200):
        _, y = run(coupled(fmus), master(kind), kind, 0.4 / count, count)
        wrong.append(np.abs(y[-1] - exact(0.4)).max())
    assert np.log2(wrong[0] / wrong[1]) == pytest.approx(ORDER[kind], abs=0.2)  # ωh = 0.08
