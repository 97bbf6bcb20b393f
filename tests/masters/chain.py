"""Ten bars in a row, joined by springs and dampers, the first one to the ground; a force pulls the last one.

Run `python tests/masters/chain.py [FOLDER]`: prints the table of models/chain/README.md, draws its picture.
"""

import sys
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from body import Body, full_body, joined, modal, reduced_body, together
from coupled import Coupled, Linear
from fmu import Fmu
from linear_part import StateSpace, state_space
from markdown import markdown
from monolith import Monolith, driven, monolith, output, polynomial, trajectory
from power_bond import Bonds, power_bond, stored
from run import points, run
from step_map import largest_stable_step, spectral_radius, step_map
from table import Algorithm, Row, algorithms, cells, draw_errors, errors

from fmu_src.runtime.model import Floats, ReducedModel
from precompute.part import read_part
from precompute.pipeline import package, reduce_part

FOLDER = Path(__file__).parents[2] / "models" / "chain"
LINKS = 10
STIFFNESS, DAMPING = 2e6, 200.0  # N/m, N·s/m of a coupling
FORCE = 100.0  # N, on the right end of the last link
INPUTS = ["left.force.x", "right.force.x"]
OUTPUTS = ["left.displacement.x", "left.velocity.x", "right.displacement.x", "right.velocity.x"]
END, COUNTS = 0.002, (80, 160, 320)  # s: the wave is near the ground; numbers of steps
MODES = 300  # of the full chain, up to 50 kHz
SHOWN = ("Jacobi, derivative", "Gauss–Seidel, derivative", "interface Newton, linear", "power bond")
UNDAMPED = {"damping.alpha": 0.0, "damping.beta": 0.0}


def elongations(left: int, right: int) -> Floats:
    """G (couplings, outputs): coupling j joins link j − 1, or the ground, to j; of its four outputs."""
    G = np.zeros((LINKS, 4 * LINKS))
    for j in range(LINKS):
        G[j, 4 * j + left] = 1.0
        if j:
            G[j, 4 * (j - 1) + right] = -1.0
    return G


STRETCH, RATE = elongations(0, 2), elongations(1, 3)
PULL = STRETCH[:, [4 * j + end for j in range(LINKS) for end in (0, 2)]].T  # W = GᵀP: what unit forces do


def coupled(body: Body, k: float, c: float) -> Body:
    """The chain of such links as one body."""
    chain = together({f"link{j}": body for j in range(LINKS)})
    chain = joined(chain, "link0.left.x", None, k, c)
    for j in range(1, LINKS):
        chain = joined(chain, f"link{j}.left.x", f"link{j - 1}.right.x", k, c)
    return chain


def pulled(chain: Body) -> Monolith:
    """The force on its end."""
    return driven(monolith(chain), {f"link{LINKS - 1}.right.force.x": polynomial(FORCE)})


@dataclass(frozen=True, eq=False)
class Chain:
    """The reduced link, an FMU for each, and their couplings, k in N/m and c in N·s/m."""

    model: ReducedModel
    links: tuple[Fmu, ...]
    k: float = STIFFNESS
    c: float = DAMPING

    @property
    def L(self) -> Floats:
        """u = L y of all ends: −(k δ + c δ̇) on the link right of a coupling, the opposite on the left one."""
        return -PULL @ (self.k * STRETCH + self.c * RATE)

    @property
    def bonds(self) -> Bonds:
        """The same as bonds."""
        return Bonds(STRETCH, PULL, np.full(LINKS, self.k), np.full(LINKS, self.c))

    @cached_property
    def spaces(self) -> list[StateSpace]:
        """The links by matrices."""
        return LINKS * [state_space(self.model, INPUTS, OUTPUTS)]

    @cached_property
    def whole(self) -> Monolith:
        """The reduced links as one."""
        return pulled(coupled(reduced_body(self.model), self.k, self.c))

    def system(self, force: float = FORCE, start: Mapping[str, float] | None = None) -> Coupled:
        """All FMUs at t = 0."""
        for link in self.links:
            link.restart(start)
        end = np.eye(2 * LINKS)[-1]
        return Coupled(self.links, Linear(self.L, lambda t, order: force * (order == 0) * end))

    def masters(self) -> list[Algorithm]:
        """All but the fixed points, which are what interface Newton finds at once."""
        direct = [a for a in algorithms() if not a.name.startswith("fixed point")]
        return [*direct, Algorithm("power bond", "hold", 2, lambda: power_bond(self.bonds))]

    def exact(self, h: float, count: int) -> Floats:
        """The right end's displacement of each link at multiples of h, m, (count + 1, links)."""
        x = trajectory(self.whole, h, count)
        ends = [output(self.whole, x, f"link{j}.right.displacement.x") for j in range(LINKS)]
        return np.column_stack(ends)

    def error(self, algorithm: Algorithm, h: float, count: int) -> float:
        """The largest error of any link's right end, of the largest displacement."""
        _, y = run(self.system(), algorithm.step(), algorithm.kind, h, count)
        exact = self.exact(h, count)
        return float(np.abs(y[:, 2::4] - exact).max() / np.abs(exact).max())

    def radius(self, algorithm: Algorithm, h: float) -> float:
        """The spectral radius of a step h of the whole chain."""
        return spectral_radius(step_map(self.spaces, self.L, algorithm.step(), algorithm.kind, h))

    def stable(self, algorithm: Algorithm) -> float:
        """The largest stable step in s: from 10 µs to 0.2 ms, or from 1 µs where 10 µs are too large."""

        def radius(h: float) -> float:
            return self.radius(algorithm, h)

        return largest_stable_step(radius, 1e-5, 2e-4) or largest_stable_step(radius, 1e-6, 1e-5)

    def energy(self, algorithm: Algorithm, h: float, count: int) -> Floats:
        """T + V of links and couplings less the work of the force, of the largest T + V, (count + 1,).

        The links are without damping: it is 0 where c = 0, if the coupling makes no energy.
        """
        system = self.system(start=UNDAMPED)
        inside, y = [], []
        for point in points(system, algorithm.step(), algorithm.kind, h, count):
            inside.append(sum(link.get("energy.kinetic", "energy.strain").sum() for link in self.links))
            y.append(point.y)
        motion = np.array(y)
        total = np.array(inside) + stored(self.bonds, motion)
        found: Floats = (total - FORCE * motion[:, -2]) / total.max()
        return found


def build(folder: Path) -> Chain:
    """The link reduced and packaged, one FMU and ten instances of it."""
    reduction = reduce_part(read_part(FOLDER))
    path = package(reduction, folder / "link.fmu")
    return Chain(reduction.model, tuple(Fmu(path, INPUTS, OUTPUTS) for _ in range(LINKS)))


def reduction_error(chain: Chain) -> float:
    """The largest difference that the reduction of the links makes to the last one, of its peak."""
    full = pulled(modal(coupled(full_body(read_part(FOLDER)), chain.k, chain.c), MODES))
    h, count, name = END / COUNTS[-1], COUNTS[-1], f"link{LINKS - 1}.right.displacement.x"
    mine, whole = (output(m, trajectory(m, h, count), name) for m in (chain.whole, full))
    return float(np.abs(mine - whole).max() / np.abs(whole).max())


def rows(chain: Chain) -> list[Row]:
    """Everything measured, every master."""
    conserving, h = replace(chain, c=0.0), [END / count for count in COUNTS]
    found = []
    for algorithm, undamped in zip(chain.masters(), conserving.masters(), strict=True):
        wrong = errors(lambda h, count, a=algorithm: chain.error(a, h, count), END, COUNTS)
        drift = np.abs(conserving.energy(undamped, h[-1], COUNTS[-1])).max()
        found.append(Row(algorithm, h, wrong, chain.stable(algorithm), float(drift)))
    return found


def draw(chain: Chain, found: list[Row], path: Path) -> None:
    """The wave through the chain, errors over step sizes, energy over time with nothing damped."""
    figure, (left, middle, right) = plt.subplots(1, 3, figsize=(13, 4.2), layout="constrained")
    h, count = 2.5e-5, 320
    t = 1e3 * h * np.arange(count + 1)
    left.plot(t, 1e6 * chain.exact(h, count), linewidth=1.2)
    _, y = run(chain.system(), algorithms()[0].step(), "hold", h, count)
    left.plot(t, 1e6 * y[:, 2::4], "k:", linewidth=0.8)
    left.set(xlabel="t / ms", ylabel="right ends / µm")
    left.set_title(f"monolithic; dotted: Jacobi, hold, h = {1e6 * h:g} µs", fontsize="medium")
    draw_errors(middle, found)
    middle.set_ylim(top=30.0)
    middle.legend(fontsize="x-small", ncols=2, loc="upper left")
    conserving = replace(chain, c=0.0)
    for algorithm in conserving.masters():
        if algorithm.name in SHOWN:
            made = np.abs(conserving.energy(algorithm, h, count)) + 1e-17
            right.semilogy(t, made, label=algorithm.name, linewidth=1.0)
    right.set(xlabel="t / ms", ylabel="energy made or lost / largest", ylim=(1e-16, 10.0))
    right.set_title(f"nothing damped, h = {1e6 * h:g} µs", fontsize="medium")
    right.legend(fontsize="x-small")
    figure.savefig(path, dpi=65)


def main(folder: Path) -> None:
    """Build, couple, compare, draw."""
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as scratch:
        chain = build(Path(scratch))
        found = rows(chain)
        print(markdown([cells(row) for row in found]))
        print(f"\nThe reduction of the links alone makes {reduction_error(chain):.1e} of the peak.")
        draw(chain, found, folder / "chain.png")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path("out"))
