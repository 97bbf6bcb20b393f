"""How many modes are asked for: count, max_frequency, and what cannot be met."""

import logging

import numpy as np
import pytest
from boxes import box
from systems import SOLVERS, chain, chain_held, system_of

from precompute.canonical import clusters
from precompute.eigen import solve_modes
from precompute.errors import EigenError
from precompute.factor import Solver

NONE = np.zeros(0, dtype=np.int64)


class TestMaxFrequency:
    LAM = chain_held(800, 800)

    @staticmethod
    def hertz(lam: float) -> float:
        return float(np.sqrt(lam) / (2 * np.pi))

    @pytest.mark.parametrize("solver", SOLVERS)
    @pytest.mark.parametrize("r", [1, 2, 33, 300])  # 300 of 800: all at once
    def test_all_up_to_it(self, solver: Solver, r: int) -> None:
        system = chain(800, ground=1.0)
        between = self.hertz(0.5 * (self.LAM[r - 1] + self.LAM[r]))
        modes = solve_modes(system, NONE, max_frequency=between, solver=solver)
        np.testing.assert_allclose(modes.lam, self.LAM[:r], rtol=3e-10)  # ε λ_max/λ₁ = 2e-10

    @pytest.mark.parametrize("solver", SOLVERS)
    def test_an_eigenfrequency_itself_belongs(self, solver: Solver) -> None:
        at = self.hertz(self.LAM[9])
        assert len(solve_modes(chain(800, ground=1.0), NONE, max_frequency=at, solver=solver).lam) == 10
        below = at * (1 - 1e-6)
        assert len(solve_modes(chain(800, ground=1.0), NONE, max_frequency=below, solver=solver).lam) == 9

    def test_none(self) -> None:
        low = 0.5 * self.hertz(self.LAM[0])
        with pytest.raises(EigenError, match=f"the first mode is at {self.hertz(self.LAM[0]):.6g} Hz"):
            solve_modes(chain(800, ground=1.0), NONE, max_frequency=low)

    def test_rigid_modes_are_below_any(self) -> None:
        modes = solve_modes(chain(800), NONE, max_frequency=1e-9)
        assert (modes.rigid, len(modes.lam)) == (1, 1)


class TestCount:
    CUBE = system_of(box("hex8", (4, 4, 4)))

    def test_rigid_ones_count(self) -> None:
        modes = solve_modes(self.CUBE, NONE, count=4)
        assert (modes.rigid, modes.Phi.shape[1]) == (4, 4)

    def test_a_cut_cluster_is_said_and_kept_canonical(self, caplog: pytest.LogCaptureFixture) -> None:
        """The vectors of a cluster are those of the whole cluster, wherever it is cut."""
        caplog.set_level(logging.INFO, logger="modalfmu")
        whole = solve_modes(self.CUBE, NONE, count=16)
        pair = next(c for c in clusters(whole.lam) if c.start >= 6 and c.stop - c.start == 2)
        assert "share one frequency" not in caplog.text
        cut = solve_modes(self.CUBE, NONE, count=pair.start + 1)
        assert "share one frequency" in caplog.text
        np.testing.assert_allclose(
            cut.Phi, whole.Phi[:, : pair.start + 1], atol=1e-8 * np.max(np.abs(whole.Phi))
        )

    @pytest.mark.parametrize("count", [0, -3, 376])
    def test_out_of_range(self, count: int) -> None:
        with pytest.raises(EigenError, match=f"got {count}, the part has 375 free DOFs"):
            solve_modes(self.CUBE, NONE, count=count)


class TestRequests:
    @pytest.mark.parametrize(
        ("request_", "message"),
        [
            ({}, "exactly one"),
            ({"count": 3, "max_frequency": 5.0}, "exactly one"),
            ({"max_frequency": -1.0}, "positive"),
            ({"max_frequency": np.nan}, "positive"),
            ({"count": 3, "solver": "mumps"}, "superlu"),
        ],
    )
    def test_refused(self, request_: dict[str, object], message: str) -> None:
        with pytest.raises(EigenError, match=message):
            solve_modes(chain(600, ground=1.0), NONE, **request_)  # type: ignore[arg-type]  # mistakes on purpose

    @pytest.mark.parametrize(
        ("fixed", "message"), [([600], "expected 0 to 599"), (range(600), "got all DOFs")]
    )
    def test_supports(self, fixed: object, message: str) -> None:
        with pytest.raises(EigenError, match=message):
            solve_modes(chain(600), np.array(fixed), count=1)

    def test_memory(self) -> None:
        """A fifth of the modes of 30 000 DOFs: refused at once, with the number."""
        with pytest.raises(EigenError, match=r"6004 of 30000 free DOFs would need \d+\.\d GB"):
            solve_modes(chain(30_000, ground=1.0), NONE, count=6000)
