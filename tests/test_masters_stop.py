"""The reed and its stop: the monolithic solution in closed form, then the masters against it."""

import re
from functools import cache

import numpy as np
import pytest
import stop
from body import full_body, modal, point_mass, reduced_body
from bounces import Bounces, Stop, bounces
from coupled import Coupled, Linear
from fmu import Fmu
from ready_parts import MODELS, reduction, table
from run import run
from table import Algorithm

from precompute.part import read_part
from precompute.pipeline import package

MASTERS = {algorithm.name: algorithm for algorithm in stop.ALGORITHMS}
ROWS = {(row["master"], row["contacts"]): row for row in table("stop", "master")}


@pytest.fixture(scope="module")
def reed(tmp_path_factory: pytest.TempPathFactory) -> Fmu:
    path = package(reduction("stop"), tmp_path_factory.mktemp("stop") / "reed.fmu")
    return Fmu(path, stop.INPUTS, stop.OUTPUTS)


@cache
def reference() -> Bounces:
    return bounces(reduced_body(reduction("stop").model), stop.STOP, stop.STEP * stop.COUNT)


def test_a_mass_and_a_stop_in_closed_form() -> None:
    """F t²/2m to the stop, then F/k (1 − cos ωt) + v/ω sin ωt beyond g, until tan(ωt/2) = −vk/ωF."""
    m, k, g, force = 2.0, 5000.0, 0.01, 30.0
    found = bounces(point_mass(m, "tip.z"), Stop(k, g, force), 0.3)
    meets, omega = np.sqrt(2 * g * m / force), np.sqrt(k / m)
    stays = 2 * (np.pi - np.arctan(force * meets / m * k / (omega * force))) / omega
    period = 2 * meets + stays  # it comes back to rest where it began
    expected = [meets, meets + stays, period + meets, period + meets + stays]
    np.testing.assert_allclose(found.events, expected[: len(found.events)], atol=1e-13)
    assert len(found.events) == 4
    deepest = g + force / k + np.hypot(force / k, force * meets / m / omega)
    assert found.tip(np.array([meets + stays / 2]))[0] == pytest.approx(deepest, rel=1e-12)


def test_contacts_of_the_reduced_and_the_full_reed_as_printed() -> None:
    """The full one's frequencies are those of LAPACK to 1e-7: ε λ_max/λ."""
    text = (MODELS / "stop" / "README.md").read_text(encoding="utf-8")
    printed = {digits: re.findall(rf"\b\d\.\d{{{digits}}}\b", text) for digits in (9, 6)}
    body = modal(full_body(read_part(MODELS / "stop")), stop.FULL_MODES)
    full = bounces(body, stop.STOP, stop.STEP * stop.COUNT)
    np.testing.assert_allclose(np.array(printed[9], float), 1e3 * reference().events, rtol=1e-7)
    np.testing.assert_allclose(np.array(printed[6], float), 1e3 * full.events, rtol=2e-6)
    np.testing.assert_allclose(full.events, reference().events, rtol=2e-4)  # three modes of the reed


@pytest.mark.parametrize("name", MASTERS)
def test_orders_with_contacts_located(reed: Fmu, name: str) -> None:
    """1, 2, 3 by what is known of the force; the first contact is the FMU's own, to rounding."""
    algorithm = MASTERS[name]
    expected = reference().tip(stop.STEP * np.arange(stop.COUNT + 1))
    errors, late = [], []
    for finer in (4, 8):
        reed.restart()
        _, y, events = stop.bounced(reed, algorithm, finer)
        errors.append(stop.error(y, expected))
        late.append(np.abs(events - reference().events))
    # the fastest mode turns by 0.4 and 0.2 in a step: the next term of the error is a tenth of the first
    assert np.log2(errors[0] / errors[1]) == pytest.approx(algorithm.order, abs=0.12)
    assert late[1][0] < 1e-13  # s; the tip comes at 1 m/s, ε of 1 mm
    assert (late[1][1:] > 1e-12).all()  # later ones know what the contact was computed by
    row = ROWS[name, "located"]
    assert float(row["error, h = 6.25 µs"]) == pytest.approx(errors[1], rel=0.05)  # two digits
    assert float(row["order"]) == pytest.approx(algorithm.order, abs=0.07)
    assert float(row["second departure / s"]) == pytest.approx(late[1][3], rel=0.4)  # one digit


def test_a_contact_that_is_passed_over_costs_the_third_order(reed: Fmu) -> None:
    """Within the step the force bends by O(h): O(h²) in the motion, whatever the master knows of it."""
    algorithm = MASTERS["interface Newton, derivative"]
    expected = reference().tip(stop.STEP * np.arange(stop.COUNT + 1))
    reed.restart()
    _, located, _ = stop.bounced(reed, algorithm, 8)
    reed.restart()
    _, blind, _ = stop.blindly(reed, algorithm, 8)
    assert stop.error(blind, expected) > 20 * stop.error(located, expected)
    assert float(ROWS[algorithm.name, "passed over"]["order"]) < 2.5


def test_what_each_master_does_to_the_energy(reed: Fmu) -> None:
    """A bond neither takes nor gives; a held force gives, that of the end takes, about as much."""
    assert stop.drift(reed, MASTERS["power bond"], 2) < 1e-12
    ends = {}
    for name in ("Jacobi, hold", "interface Newton, hold"):
        reed.restart({"damping.beta": 0.0})
        _, y, _ = stop.bounced(reed, MASTERS[name], 4)
        ends[name] = stop.energy(y)[-1] / (stop.FORCE * stop.GAP)
    assert ends["Jacobi, hold"] > 0.05
    assert ends["interface Newton, hold"] < -0.05


@pytest.mark.parametrize("name", MASTERS)
def test_stability_limits_of_the_table(name: str) -> None:
    """Half a per cent below the printed one (three digits) a step of contact is stable, above it is not."""
    model, algorithm = reduction("stop").model, MASTERS[name]
    printed = ROWS[name, "located"]["largest stable h / µs"]
    if printed == "any":
        assert max(stop.radius(model, algorithm, h) for h in np.geomspace(1e-6, 1e-3, 20)) < 1 + 1e-9
    else:
        assert stop.radius(model, algorithm, 0.995e-6 * float(printed)) < 1
        assert stop.radius(model, algorithm, 1.005e-6 * float(printed)) > 1


def swings(reed: Fmu, algorithm: Algorithm, h: float, count: int) -> float:
    """How the tip's largest motion over `count` steps differs from that over as many before, in contact."""
    contact = Linear(np.array([[-stop.STIFFNESS, 0.0, 0.0]]))
    reed.restart({f"modes.velocity[{i}]": 1e-6 for i in (1, 2, 3)})
    _, y = run(Coupled((reed,), contact), algorithm.step(), algorithm.kind, h, 3 * count)
    motion = np.abs(y[:, 0])
    return float(motion[2 * count :].max() / motion[count : 2 * count].max())


@pytest.mark.parametrize("name", ["Jacobi, derivative", "interface Newton, linear"])
def test_the_fmu_confirms_the_limits(reed: Fmu, name: str) -> None:
    """Below the limit contact dies down, 2 % above it grows by the spectral radius."""
    model, algorithm = reduction("stop").model, MASTERS[name]
    limit = 1e-6 * float(ROWS[name, "located"]["largest stable h / µs"])
    assert swings(reed, algorithm, 0.9 * limit, 150) < 1
    radius = stop.radius(model, algorithm, 1.02 * limit)
    count = int(np.ceil(3 / np.log(radius)))
    # the largest of the motion falls between two steps: by no more than a few per cent
    assert np.log(swings(reed, algorithm, 1.02 * limit, count)) == pytest.approx(
        count * np.log(radius), rel=0.1
    )
