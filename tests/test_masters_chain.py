"""The chain of ten links: its monolithic solution in closed form, then the masters against it."""

from collections.abc import Iterator
from dataclasses import replace

import chain
import numpy as np
import pytest
from body import Body, reduced_body
from chain import Chain
from fmu import Fmu
from ready_parts import reduction, table
from run import run
from systems import chain_held
from table import Algorithm
from threadpoolctl import threadpool_limits

from precompute.pipeline import package

ROWS = {row["master"]: row for row in table("chain", "master")}


@pytest.fixture(scope="module")
def ten(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Chain]:
    found = reduction("chain")
    path = package(found, tmp_path_factory.mktemp("chain") / "link.fmu")
    links = tuple(Fmu(path, chain.INPUTS, chain.OUTPUTS) for _ in range(chain.LINKS))
    with threadpool_limits(1):  # for matrices this small, threads take longer than the work
        yield Chain(found.model, links)


def master(ten: Chain, name: str) -> Algorithm:
    return next(algorithm for algorithm in ten.masters() if algorithm.name == name)


def test_rigid_links_in_closed_form() -> None:
    """λ = 4 (k/m) sin²((2j+1)π/(4n+2)) of equal masses and springs, the first one held."""
    w = np.ones(1)
    mass = Body(np.array([[0.112]]), np.zeros((1, 1)), np.zeros((1, 1)), {"left.x": w, "right.x": w})
    K = chain.coupled(mass, chain.STIFFNESS, 0.0).K
    expected = chain.STIFFNESS / 0.112 * chain_held(chain.LINKS, chain.LINKS)
    np.testing.assert_allclose(np.linalg.eigvalsh(K) / 0.112, expected, rtol=1e-12)


def test_the_law_is_the_couplings_of_the_monolithic_solution(ten: Chain) -> None:
    """K and D of all links as one are their own less W L of the law; so is the energy of the bonds."""
    body = reduced_body(ten.model)
    whole = chain.coupled(body, ten.k, ten.c)
    alone = chain.coupled(body, 0.0, 0.0)
    ends = [f"link{j}.{end}.x" for j in range(chain.LINKS) for end in ("left", "right")]
    W = np.column_stack([alone.ports[end] for end in ends])
    np.testing.assert_allclose(alone.K - W @ ten.L[:, 0::2] @ W.T, whole.K, atol=1e-9 * whole.K.max())
    np.testing.assert_allclose(alone.D - W @ ten.L[:, 1::2] @ W.T, whole.D, atol=1e-9 * whole.D.max())


@pytest.mark.parametrize("name", ROWS)
def test_orders(ten: Chain, name: str) -> None:
    """1, 2, 3 by what is known of the inputs; the error and the order as printed."""
    algorithm, printed = master(ten, name), ROWS[name]
    wrong = [ten.error(algorithm, chain.END / count, count) for count in chain.COUNTS[1:]]
    order = np.log2(wrong[0] / wrong[1])
    # the fastest mode turns by 0.7 and 0.35 in a step: the next term is a tenth of the first
    assert order == pytest.approx(algorithm.order, abs=0.15)
    assert float(printed["order"]) == pytest.approx(order, abs=0.011)
    assert float(printed["error, h = 0.00625 ms"]) == pytest.approx(wrong[1], rel=0.05)  # two digits


@pytest.mark.parametrize("name", ROWS)
def test_stability_limits_of_the_table(ten: Chain, name: str) -> None:
    """Half a per cent below the printed one (three digits) a step of the chain is stable, above it is not."""
    algorithm, printed = master(ten, name), ROWS[name]["largest stable h / ms"]
    if printed == "any":
        assert max(ten.radius(algorithm, h) for h in np.geomspace(1e-6, 2e-4, 12)) < 1
    else:
        assert ten.radius(algorithm, 0.995e-3 * float(printed)) < 1
        assert ten.radius(algorithm, 1.005e-3 * float(printed)) > 1


def swings(ten: Chain, algorithm: Algorithm, h: float, count: int) -> float:
    """The largest velocity over `count` steps, of the largest over as many before; no force."""
    system = ten.system(
        0.0, {"modes.velocity[1]": 1e-3, "modes.velocity[2]": 1e-3, "modes.velocity[3]": 1e-3}
    )
    _, y = run(system, algorithm.step(), algorithm.kind, h, 3 * count)
    speed = np.abs(y[:, 1::2]).max(axis=1)
    return float(speed[2 * count :].max() / speed[count : 2 * count].max())


@pytest.mark.parametrize("name", ["Jacobi, hold", "Jacobi, derivative", "Gauss–Seidel, linear"])
def test_ten_fmus_confirm_the_limits(ten: Chain, name: str) -> None:
    """3 % below the limit the chain comes to rest, 3 % above it swings up by the spectral radius."""
    algorithm = master(ten, name)
    limit = 1e-3 * float(ROWS[name]["largest stable h / ms"])
    assert swings(ten, algorithm, 0.97 * limit, 150) < 1
    radius = ten.radius(algorithm, 1.03 * limit)
    count = int(np.ceil(8 / np.log(radius)))
    grown = swings(ten, algorithm, 1.03 * limit, count)
    assert np.log(grown) == pytest.approx(count * np.log(radius), rel=0.1)  # peaks fall between steps


def test_energy_of_the_chain(ten: Chain) -> None:
    """Nothing damped: a power bond keeps it to rounding, Newton's held forces take it, as printed."""
    conserving = replace(ten, c=0.0)
    coarse, fine = chain.COUNTS[0], chain.COUNTS[-1]
    kept = conserving.energy(master(conserving, "power bond"), chain.END / coarse, coarse)
    assert np.abs(kept).max() < 1e-12
    taken = conserving.energy(master(conserving, "interface Newton, hold"), chain.END / fine, fine)
    assert taken[-1] < -1e-3
    printed = float(ROWS["interface Newton, hold"]["energy drift"])
    assert printed == pytest.approx(np.abs(taken).max(), rel=0.05)
