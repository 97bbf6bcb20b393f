"""The column under its controller: the monolithic solution in closed form, then the masters against it."""

from functools import cache

import numpy as np
import pytest
import servo
from body import point_mass, reduced_body
from fixed_point import NotConverged
from fmu import Fmu
from monolith import monolith, output
from ready_parts import reduction, table
from run import run
from sampled import Held, Pid, controlled, dividing, landing, straying
from servo import PERIOD, SAMPLES, Servo
from table import Algorithm, algorithms

from precompute.arrays import Floats
from precompute.pipeline import package

MASTERS = {algorithm.name: algorithm for algorithm in algorithms()}
ROWS = {row["master"]: row for row in table("servo", "master")}
STEPS = {row["steps"]: row for row in table("servo", "steps")}


@pytest.fixture(scope="module")
def column(tmp_path_factory: pytest.TempPathFactory) -> Servo:
    found = reduction("servo")
    path = package(found, tmp_path_factory.mktemp("servo") / "column.fmu")
    return Servo(found.model, Fmu(path, [servo.FORCE], servo.OUTPUTS))


@cache
def exact(*, voltage: bool) -> Floats:
    whole = servo.Exact(monolith(reduced_body(reduction("servo").model)))
    return whole.by_voltage() if voltage else whole.by_force()


def test_a_mass_under_a_sampled_controller() -> None:
    """x₊ = x + vT + uT²/2m, v₊ = v + uT/m with u held, the controller written out."""
    pid = Pid(300.0, 900.0, 40.0, 0.01, 0.2)
    m, T, x, v, total, before = 2.0, 0.01, 0.0, 0.0, 0.0, 0.0
    expected = [x]
    for _ in range(50):
        u = 300.0 * (0.2 - x) + 900.0 * T * total - 40.0 * (x - before) / T
        total, before = total + 0.2 - x, x
        expected += [x + v * T / 2 + u * T**2 / (8 * m), x + v * T + u * T**2 / (2 * m)]
        x, v = expected[-1], v + u * T / m
    mass = monolith(point_mass(m, "slide.x"))
    found = output(mass, controlled(mass, pid, servo.SLIDE, servo.FORCE, 2, 50), servo.SLIDE)
    np.testing.assert_allclose(found, expected, atol=1e-14)


def test_a_mass_with_the_coil() -> None:
    """λ (λ² + λ R/L + k²/mL) = 0."""
    plant = servo.with_coil(monolith(point_mass(1.3, "slide.x")))
    expected = np.roots([1.0, servo.R / servo.L, servo.MOTOR**2 / (1.3 * servo.L), 0.0])
    np.testing.assert_allclose(np.sort(np.linalg.eigvals(plant.A)), np.sort(expected), atol=1e-10)


@pytest.mark.parametrize("n", [1, 4])
def test_a_held_force_is_exact_at_any_steps_that_end_at_the_samples(column: Servo, n: int) -> None:
    for lengths in dividing(PERIOD, n, SAMPLES), landing(PERIOD, 0.7 * PERIOD / n, SAMPLES):
        assert servo.error(*column.by_force(lengths), exact(voltage=False)) < 1e-13  # ε, 50 to 300 steps
    assert servo.error(*column.by_force(straying(PERIOD, n, SAMPLES)), exact(voltage=False)) > 1e-3


def test_steps_that_pass_over_the_samples_are_of_order_one(column: Servo) -> None:
    """Controller and column hear of each other later by h/2 in the mean; a term of h² is seen up to T/64."""
    wrong = [
        servo.error(*column.by_force(straying(PERIOD, n, SAMPLES)), exact(voltage=False)) for n in (64, 128)
    ]
    assert np.log2(wrong[0] / wrong[1]) == pytest.approx(1.0, abs=0.1)
    row = STEPS["pass over the samples"]
    assert float(row["error, n = 128"]) == pytest.approx(wrong[1], rel=0.05)  # two digits


DIRECT = [name for name in MASTERS if not name.startswith("fixed point")]


@pytest.mark.parametrize("name", DIRECT)
def test_orders_of_column_and_coil(column: Servo, name: str) -> None:
    algorithm, expected = MASTERS[name], exact(voltage=True)
    wrong = [
        servo.error(*column.by_voltage(algorithm, dividing(PERIOD, n, SAMPLES)), expected) for n in (4, 8)
    ]
    order = np.log2(wrong[0] / wrong[1])
    # R h/L is 1/4 and 1/8: the next term of the error is some per cent of the first
    assert order == pytest.approx(algorithm.order, abs=0.08)
    printed = ROWS[name]
    assert float(printed["order"]) == pytest.approx(algorithm.order, abs=0.05)
    assert float(printed["error, h = 0.0625 ms"]) == pytest.approx(wrong[1] / 2**order, rel=0.1)


def test_fixed_points_are_what_newton_finds(column: Servo) -> None:
    lengths = dividing(PERIOD, 4, 10)
    ends = [
        column.by_voltage(MASTERS[f"{way}, linear"], lengths)[1][-1]
        for way in ("fixed point", "interface Newton")
    ]
    np.testing.assert_allclose(ends[0], ends[1], atol=1e-9 * np.abs(ends[0]).max())  # both stop at 1e-11
    for kind in ("hold", "linear", "derivative"):
        rows = [[*ROWS[f"{way}, {kind}"].values()][1:4] for way in ("fixed point", "interface Newton")]
        assert rows[0] == rows[1]


@pytest.mark.parametrize("name", MASTERS)
def test_stability_limits_of_the_table(column: Servo, name: str) -> None:
    """Half a per cent below the printed one (three digits) a step is stable, above it is not."""
    algorithm, printed = MASTERS[name], ROWS[name]["largest stable h / ms"]
    if printed == "any":
        worst = max(column.radius(algorithm, h) for h in np.geomspace(1e-4, servo.LIMIT, 20))
        assert worst < 1 + 1e-9  # the slide's place is a mode of radius 1
        return
    assert column.radius(algorithm, 0.995e-3 * float(printed)) < 1 + 1e-9
    try:
        assert column.radius(algorithm, 1.005e-3 * float(printed)) > 1 + 1e-6
    except NotConverged:
        assert name.startswith("fixed point")


def swings(column: Servo, algorithm: Algorithm, h: float, count: int) -> float:
    """The largest current over `count` steps, of the largest over as many before; 1 A at t = 0."""
    column.column.restart()
    system = column.system(servo.coil(), Held(), current=1.0)
    _, y = run(system, algorithm.step(), algorithm.kind, h, 3 * count)
    current = np.abs(y[:, 5])
    return float(current[2 * count :].max() / current[count : 2 * count].max())


@pytest.mark.parametrize("name", ["Jacobi, hold", "Gauss–Seidel, linear"])
def test_the_fmu_confirms_the_limits(column: Servo, name: str) -> None:
    """5 % below the limit the current dies down, 5 % above it grows by the spectral radius."""
    algorithm = MASTERS[name]
    limit = 1e-3 * float(ROWS[name]["largest stable h / ms"])
    assert swings(column, algorithm, 0.95 * limit, 200) < 0.9
    radius = column.radius(algorithm, 1.05 * limit)
    count = int(np.ceil(5 / np.log(radius)))
    grown = swings(column, algorithm, 1.05 * limit, count)
    assert np.log(grown) == pytest.approx(count * np.log(radius), rel=0.1)  # peaks fall between steps


def test_energy_of_column_and_coil(column: Servo) -> None:
    """Held forces of the step's beginning make energy, those of its end take it; as printed."""
    h, count = PERIOD / 16, 16 * SAMPLES
    made = {
        name: column.energy(MASTERS[name], h, count) for name in ("Jacobi, hold", "interface Newton, hold")
    }
    assert made["Jacobi, hold"][-1] > 1.1
    assert made["interface Newton, hold"][-1] < 0.9
    for name, energy in made.items():
        assert float(ROWS[name]["energy drift"]) == pytest.approx(np.abs(energy - 1).max(), rel=0.05)
