"""Two beams under every master: orders, the step as a matrix, where it becomes unstable, energy."""

from collections.abc import Iterator
from dataclasses import replace
from math import pi

import numpy as np
import pytest
from coupled import Coupled, Linear
from extrapolation import ORDER, Kind, observe
from fixed_point import MOST, TOLERANCE, NotConverged, fixed_point
from interface_newton import interface_newton, sensitivity
from jacobi import jacobi
from monolith import driven, output, sine, trajectory
from pair import (
    DAMPING,
    END,
    FORCE,
    INPUTS,
    NAMES,
    OUTPUTS,
    STIFFNESS,
    TOLERANCES,
    UNDAMPED,
    Pair,
    build,
    controlled,
)
from ready_parts import table
from run import points, run
from step_doubling import coarse
from step_map import spectral_radius, step_map
from table import Algorithm, errors
from threadpoolctl import threadpool_limits

from fmu_src.runtime.model import Floats
from fmu_src.runtime.propagator import propagator

README = {row["master"]: row for row in table("pair", "master")}
MASTERS = [*README]


@pytest.fixture(scope="module")
def pair(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Pair]:
    with threadpool_limits(1):  # for matrices this small, threads take longer than the work
        yield build(tmp_path_factory.mktemp("pair"))


def named(pair: Pair, name: str) -> Algorithm:
    return next(one for one in pair.masters() if one.name == name)


@pytest.mark.parametrize("name", MASTERS)
def test_order(pair: Pair, name: str) -> None:
    """Errors against the exponential of both parts as one, over more than a period, at two step sizes.

    ωh of the highest mode is 0.7 and 0.4 at them: what it has to do with the order is less than 0.15.
    """
    algorithm = named(pair, name)
    coarse, fine = errors(lambda h, count: pair.error(algorithm, h, count), END, (400, 800))
    assert np.log2(coarse / fine) == pytest.approx(algorithm.order, abs=0.15)
    assert algorithm.order == {"hold": 1, "linear": 2, "derivative": 3}[algorithm.kind] + (
        name == "power bond"
    )
    printed = float(README[name]["error, h = 0.025 ms"])
    assert fine == pytest.approx(printed, rel=0.06)  # two digits


CHANGING = ["Jacobi, derivative", "Gauss–Seidel, derivative", "interface Newton, derivative", "power bond"]


@pytest.mark.parametrize("name", CHANGING)
def test_a_force_that_changes_leaves_the_order(pair: Pair, name: str) -> None:
    """F sin ωt of 100 Hz, with its derivatives; without them the third order is lost."""
    omega, algorithm = 2 * pi * 100.0, named(pair, name)
    whole = driven(pair.free, {"left.tip.force.z": sine(FORCE, omega)})

    def error(count: int, known: int) -> float:
        def force(t: float, order: int) -> Floats:
            F = FORCE * omega**order * np.sin(omega * t + order * pi / 2)
            return np.array([F if order <= known else 0.0, 0.0])

        system = Coupled(pair.system().parts, Linear(pair.L, force))
        _, y = run(system, algorithm.step(), algorithm.kind, END / count, count)
        exact = output(whole, trajectory(whole, END / count, count), "left.tip.displacement.z")
        return float(np.abs(y[:, 0] - exact).max() / np.abs(exact).max())

    # ωh of the highest mode is 1.5 and 0.7
    assert np.log2(error(200, 2) / error(400, 2)) == pytest.approx(algorithm.order, abs=0.3)
    if algorithm.kind == "derivative":
        assert np.log2(error(200, 0) / error(400, 0)) < 2.5


def coefficients(pair: Pair, name: str, h: float) -> tuple[Floats, Floats, list[Floats]]:
    """E (2r, 2r), C (2, 2r) and [Gₖ; Gₖ₋₁] b, k = 0, 1, 2, G₋₁ = E₁₂, of a part, by the runtime."""
    model = pair.models[name]
    P = propagator(model.lam, model.damping(model.alpha, model.beta), h)
    E = np.block([[np.diag(P.E11), np.diag(P.E12)], [np.diag(P.E21), np.diag(P.E22)]])
    b = model.B[:, model.inputs.index(INPUTS[0])]
    G = [np.r_[g * b, rate * b] for g, rate in ((P.G0, P.E12), (P.G1, P.G0), (P.G2, P.G1))]
    c = np.array([model.C[model.outputs.index(name)] for name in OUTPUTS])
    zero = np.zeros_like(c[0])
    return E, np.array([np.r_[c[0], zero], np.r_[zero, c[1]]]), G


@pytest.mark.parametrize("kind", [*ORDER])
def test_a_probing_step_gives_the_sensitivity_of_the_coefficients(pair: Pair, kind: Kind) -> None:
    """∂y(t+h)/∂û = C G₀ B for a hold, C G₁ B/h and 2 C G₂ B/h² for the polynomials."""
    h = 3e-4
    system = pair.system()
    point = observe(system, kind, 0.0)
    S = sensitivity(system, kind, replace(point, t=-h), h)
    for k, name in enumerate(NAMES):
        _, C, G = coefficients(pair, name, h)
        exact = {"hold": C @ G[0], "linear": C @ G[1] / h, "derivative": 2 * C @ G[2] / h**2}[kind]
        # the difference of two steps, under forces of 100 N and 101 N
        np.testing.assert_allclose(S[2 * k : 2 * k + 2, k], exact, rtol=1e-11)
    assert (S[:2, 1] == 0).all()
    assert (S[2:, 0] == 0).all()


def by_hand(pair: Pair, name: str, h: float) -> Floats:
    """The map of x = q, q̇ of both, for held inputs: x₊ = E x + G₀B û, y = C x, û = L y of some y."""
    blocks = [coefficients(pair, one, h) for one in NAMES]
    n = [len(E) for E, _, _ in blocks]
    E, C, GB = np.zeros((sum(n), sum(n))), np.zeros((4, sum(n))), np.zeros((sum(n), 2))
    for k, (e, c, g) in enumerate(blocks):
        own = slice(n[0] * k, n[0] * k + n[k])
        E[own, own], C[2 * k : 2 * k + 2, own], GB[own, k] = e, c, g[0]
    L, one = pair.L, np.eye(sum(n))
    match name:
        case "Jacobi, hold":  # û of y
            return E + GB @ L @ C
        case "Gauss–Seidel, hold":  # the right part has y₊ of the left one
            left = E + GB[:, :1] @ L[:1] @ C
            mixed = C.copy()
            mixed[:2] = C[:2] @ left
            return E + GB[:, :1] @ L[:1] @ C + GB[:, 1:] @ L[1:] @ mixed
        case "interface Newton, hold":  # û of y₊
            return np.linalg.solve(one - GB @ L @ C, E)
        case "power bond":  # û = −Gᵀ(k (δ + δ₊)/2 + c (δ₊ − δ)/h), δ = x_left − x_right
            delta = C[0] - C[2]
            W, k, c = GB @ [-1.0, 1.0], STIFFNESS / 2, DAMPING / h
            return np.linalg.solve(one - np.outer(W, delta) * (k + c), E + np.outer(W, delta) * (k - c))
    raise AssertionError(name)


@pytest.mark.parametrize(
    "name", ["Jacobi, hold", "Gauss–Seidel, hold", "interface Newton, hold", "power bond"]
)
def test_step_map_by_the_coefficients_of_the_runtime(pair: Pair, name: str) -> None:
    """The master run on matrices and exponentials, beside the same map put together from E, G₀, B, C, L."""
    algorithm, h = named(pair, name), 6e-4
    M, exact = step_map(pair.spaces, pair.L, algorithm.step(), "hold", h), by_hand(pair, name, h)
    n = len(exact)
    omega = np.concatenate([np.tile(np.sqrt(pair.models[k].lam), 2) for k in NAMES])
    r = len(pair.models["left"].lam)
    scale = np.concatenate(
        [omega[:r], np.ones(r), omega[2 * r : -(n - 2 * r) // 2], np.ones((n - 2 * r) // 2)]
    )
    alike = M[:n, :n] * scale[:, None] / scale, exact * scale[:, None] / scale  # q times ω is like q̇
    np.testing.assert_allclose(*alike, atol=1e-10)
    assert not M[:n, n:].any()  # no memory of inputs and outputs before
    assert np.abs(alike[1] - np.eye(n)).max() > 0.1


def restarted(pair: Pair) -> Coupled:
    """Both parts in some motion, no force."""
    rng = np.random.default_rng(3)
    for fmu, name in zip(pair.fmus, NAMES, strict=True):
        omega = np.sqrt(pair.models[name].lam)
        start = {f"modes.velocity[{i + 1}]": rng.standard_normal() for i in range(len(omega))}
        start |= {f"modes.amplitude[{i + 1}]": rng.standard_normal() / w for i, w in enumerate(omega)}
        fmu.restart(start)
    return Coupled(pair.fmus, Linear(pair.L))


def states(pair: Pair, algorithm: Algorithm, h: float, count: int) -> Iterator[Floats]:
    """z = x of both FMUs, 0 for the inputs, which the map does not need, and y at the point before."""
    before = None
    for point in points(restarted(pair), algorithm.step(), algorithm.kind, h, count):
        x = [
            fmu.get(*(f"modes.{what}[{i + 1}]" for what in ("amplitude", "velocity") for i in range(r)))
            for fmu, r in ((f, len(pair.models[name].lam)) for f, name in zip(pair.fmus, NAMES, strict=True))
        ]
        yield np.concatenate([*x, np.zeros(2), point.y if before is None else before])
        before = point.y


def multiplier(pair: Pair, algorithm: Algorithm, h: float) -> tuple[float, float]:
    """How much a step multiplies the critical motion of the coupled FMUs, measured; and the spectral radius.

    A left eigenvector w of the map takes out one motion: wᵀz(t+h) = λ wᵀz(t).
    """
    M = step_map(pair.spaces, pair.L, algorithm.step(), algorithm.kind, h)
    lam, W = np.linalg.eig(M.T)
    w = W[:, np.argmax(np.abs(lam))]
    z = np.array([*states(pair, algorithm, h, 20)]) @ w
    return float(np.abs(z[-1] / z[5]) ** (1 / 15)), float(np.abs(lam).max())


@pytest.mark.parametrize("name", [name for name in MASTERS if README[name]["largest stable h / ms"] != "any"])
def test_the_fmus_are_stable_up_to_the_predicted_step(pair: Pair, name: str) -> None:
    """At 0.5 % below the README's largest stable step the critical motion decays, 0.5 % above it grows.

    The multiplier of the FMUs is the spectral radius of the map to the iteration's tolerance.
    """
    algorithm, limit = named(pair, name), 1e-3 * float(README[name]["largest stable h / ms"])
    found, radius = multiplier(pair, algorithm, 0.995 * limit)
    assert found == pytest.approx(radius, rel=1e-8)
    assert found < 1
    if name == "fixed point, hold":  # here it is the iteration that ends, see below
        with pytest.raises(NotConverged):
            pair.error(algorithm, 1.02 * limit, 3)
    else:
        found, radius = multiplier(pair, algorithm, 1.005 * limit)
        assert found == pytest.approx(radius, rel=1e-8)
        assert found > 1
    if not name.startswith("fixed point"):  # whose map is that of Newton's method
        for h in np.geomspace(1e-6, 0.99, 12) * limit:  # and it is the first
            assert pair.radius(algorithm, h) <= 1 + 1e-9


def test_runs_grow_beyond_the_largest_stable_step(pair: Pair) -> None:
    """A long run 1 % below and above it, whatever the analysis says."""
    algorithm = named(pair, "Jacobi, derivative")
    limit = 1e-3 * float(README[algorithm.name]["largest stable h / ms"])
    sizes = []
    for h in (0.99 * limit, 1.01 * limit):
        _, y = run(restarted(pair), algorithm.step(), "derivative", h, 400)
        sizes.append([np.abs(y[part, 0]).max() for part in (slice(0, 50), slice(-50, None))])
    assert sizes[0][1] < 0.1 * sizes[0][0]
    assert sizes[1][1] > 1e6 * sizes[1][0]


def test_fixed_points_are_found_where_the_iteration_contracts(pair: Pair) -> None:
    """|eigenvalues of L S| ≤ ρ, ρⁿ = tolerance after all n iterations that are made; within 2 %.

    What was left before the first of them is a few times û: so many iterations are one part in a hundred.
    """
    system = pair.system()
    point = observe(system, "hold", 0.0)

    def contraction(h: float) -> float:
        return spectral_radius(pair.L @ sensitivity(system, "hold", replace(point, t=-h), h))

    limit = 1e-3 * float(README["fixed point, hold"]["largest stable h / ms"])
    assert contraction(0.98 * limit) < TOLERANCE ** (1 / MOST) < contraction(1.02 * limit)
    # beyond, nothing has happened to the parts
    with pytest.raises(NotConverged):
        fixed_point("hold")(system, point, 1.02 * limit)
    np.testing.assert_array_equal(system.y(), point.y)
    # below, û is that of Newton's method to the tolerance, over the contraction's distance from 1
    ends = [
        run(pair.system(), make("hold"), "hold", 0.8 * limit, 3)[1]
        for make in (fixed_point, interface_newton)
    ]
    np.testing.assert_allclose(*ends, atol=100 * TOLERANCE * np.abs(ends[0]).max())


def test_newton_takes_one_correction(pair: Pair) -> None:
    """Two steps of each part: the try and the one with û that is right; besides the probing, once for all."""
    system = pair.system()
    made = []
    for fmu in pair.fmus:
        fmu.step = lambda t, h, fmu=fmu: made.append(h) or type(fmu).step(fmu, t, h)
    try:
        for _ in points(system, interface_newton("derivative"), "derivative", 2e-3, 10):
            pass
    finally:
        for fmu in pair.fmus:
            del fmu.step
    assert len(made) == 2 * (10 * 2 + 2)


def test_power_bonds_make_no_energy(pair: Pair) -> None:
    """Nothing damped: T + V + ½kδ² − F x keeps to rounding at any step size; the others make energy."""
    free = replace(pair, c=0.0)
    bond = named(free, "power bond")
    for h, count in ((5e-5, 100), (2e-3, 100), (0.1, 30)):
        # a rounding a step, of forces that are a few times those of a static deflection
        assert np.abs(free.energy(bond, h, count)).max() < 1e-12
    for name in ("Jacobi, hold", "Gauss–Seidel, linear", "interface Newton, derivative"):
        drift = np.abs(free.energy(named(free, name), END / 800, 800)).max()
        assert drift > 1e-8
        assert drift == pytest.approx(float(README[name]["energy drift"]), rel=0.06)
    # a damper takes c Δδ²/h in a step, no more and no less
    h, bond = 1e-3, named(pair, "power bond")
    made = points(pair.system(start=UNDAMPED), bond.step(), "hold", h, 50)
    found = [(pair.inside(), point.y[0] - point.y[2]) for point in made]
    inside, delta = np.array(found).T
    lost = pair.energy(bond, h, 50)
    np.testing.assert_allclose(np.diff(lost), -DAMPING * np.diff(delta) ** 2 / h / inside.max(), atol=1e-13)
    assert lost[-1] < -0.1


def test_power_bonds_are_stable_at_every_step(pair: Pair) -> None:
    bond = named(pair, "power bond")
    assert README["power bond"]["largest stable h / ms"] == "any"
    for h in np.geomspace(1e-6, 1e2, 25):
        assert pair.radius(bond, h) <= 1 + 1e-9


def test_a_whole_step_errs_four_times_as_much_as_two_halves(pair: Pair) -> None:
    """2ᵖ, p = 2, of linear inputs by the slope of a step as long; by that over h/2 it would be 2.8."""
    system, step, h = pair.system(), jacobi("linear"), 1e-5
    made = [*points(system, step, "linear", h / 2, 500)]
    with system.saved() as roll_back:
        halves = step(system, step(system, made[-1], h / 2), h / 2).y
        roll_back()
        whole = step(system, coarse(made), h).y
        roll_back()
        fine = observe(system, "derivative", made[-1].t)
        for _ in range(16):
            fine = interface_newton("derivative")(system, fine, h / 16)
    velocities = slice(1, None, 2)
    errors = [np.abs(y - fine.y)[velocities] for y in (whole, halves)]
    np.testing.assert_allclose(errors[0] / errors[1], 4.0, rtol=0.1)  # ωh of the highest mode is 0.2


def test_steps_of_a_tolerance(pair: Pair) -> None:
    """The README's; a hundredth of the tolerance takes 100^¼ times the steps, to the factor two of steps."""
    rows = [controlled(pair, tolerance) for tolerance in TOLERANCES[:2]]
    for found, printed in zip(rows, table("pair", "tolerance"), strict=False):
        assert int(found["steps"]) == pytest.approx(
            int(printed["steps"]), rel=0.05
        )  # one step more or less in 20
        assert float(found["error"]) == pytest.approx(float(printed["error"]), rel=0.2)
        assert float(found["error"]) < float(found["tolerance"])
    assert int(rows[1]["steps"]) / int(rows[0]["steps"]) == pytest.approx(100**0.25, rel=0.5)
