"""Every kind of basis, as a part file asks for it, ends as modes of the full model."""

import logging
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
from bodies import BAR, LOADS, MESH, SIZE, SUPPORTS, P, interface
from scipy.sparse import csc_array, csr_array

from fmu_src.runtime.model import Port
from precompute.arrays import Floats, Ints
from precompute.basis import basis_modes
from precompute.basis_file import read_basis
from precompute.dofs import mesh_dofs
from precompute.eigen import Modes, solve_modes
from precompute.errors import EigenError
from precompute.interface import Interface
from precompute.mode_tables import Basis
from precompute.ports import port_nodes
from precompute.rigid_ports import constrain
from precompute.statics import StaticSolver, static_solver

N = len(LOADS)
DOFS = mesh_dofs(len(P))
CLAMPED = SUPPORTS["clamped"]


def modes_of(basis: Basis, fixed: Ints = CLAMPED, count: int | None = None, **more: float) -> Modes:
    with static_solver(BAR, fixed) as solve:
        return basis_modes(
            basis, solve, interface(), constrain(BAR, fixed, DOFS, []), DOFS, P, count=count, **more
        )


def from_file(path: Path, U: Floats) -> Basis:
    np.save(path / "U.npy", U)
    return Basis.model_validate({"kind": "file", "file": "U.npy"}, context=path)


class TestKinds:
    def test_modal(self) -> None:
        full = solve_modes(BAR, CLAMPED, count=6)
        modes = modes_of(Basis(), count=6)
        np.testing.assert_array_equal(modes.lam, full.lam)
        np.testing.assert_array_equal(modes.Phi, full.Phi)

    @pytest.mark.parametrize(
        ("basis", "count", "vectors"),
        [
            (Basis(kind="polynomial", order=2), None, 12),
            (Basis(kind="polynomial", order=2), 5, 5),
            (Basis(kind="craig-bampton"), 7, 4 + 7),
            (Basis(kind="krylov"), 10, 10),
            (Basis(kind="krylov", frequency=300.0), 10, 10),
        ],
    )
    def test_modes_above_those_of_the_part(self, basis: Basis, count: int | None, vectors: int) -> None:
        modes = modes_of(basis, count=count)
        assert len(modes.lam) == vectors
        full = solve_modes(BAR, CLAMPED, count=vectors)
        assert np.all(modes.lam >= full.lam * (1 - 1e-10))  # Rayleigh; rounding
        np.testing.assert_allclose(modes.Phi.T @ (BAR.M @ modes.Phi), np.eye(vectors), atol=1e-11)
        np.testing.assert_allclose(
            modes.Phi.T @ (BAR.K @ modes.Phi), np.diag(modes.lam), atol=1e-11 * modes.lam[-1]
        )
        assert not np.any(modes.Phi[CLAMPED])

    @pytest.mark.parametrize("kind", ["polynomial", "craig-bampton", "krylov"])
    def test_a_free_part_keeps_its_rigid_modes(self, kind: str, caplog: pytest.LogCaptureFixture) -> None:
        caplog.set_level(logging.INFO)
        order = {"order": 1} if kind == "polynomial" else {}
        modes = modes_of(Basis.model_validate({"kind": kind, **order}), SUPPORTS["free"], count=9)
        assert modes.rigid == 6
        assert caplog.text.count("rigid modes: 6, the supports leave the part free to move") == 1
        np.testing.assert_array_equal(modes.lam[:6], 0)
        np.testing.assert_allclose(
            modes.Phi[:, :6], solve_modes(BAR, SUPPORTS["free"], count=6).Phi, atol=1e-15
        )

    def test_max_frequency(self) -> None:
        polynomial = modes_of(Basis(kind="polynomial", order=2))
        f = float(polynomial.frequencies[4])
        assert len(modes_of(Basis(kind="polynomial", order=2), max_frequency=f * 1.001).lam) == 5
        held = len(modes_of(Basis(kind="craig-bampton"), max_frequency=2000.0).lam) - 4
        assert held == len(modes_of(Basis(kind="craig-bampton"), count=held).lam) - 4
        assert held > 0

    def test_more_than_the_basis_has(self) -> None:
        with pytest.raises(EigenError, match="count: got 13, the basis has 12 modes"):
            modes_of(Basis(kind="polynomial", order=2), count=13)

    def test_rigid_and_clamped(self) -> None:
        with pytest.raises(EigenError, match="raise order"):
            modes_of(Basis(kind="polynomial", order=0))


class TestFile:
    def test_modes_of_the_part_give_the_modal_model(self, tmp_path: Path) -> None:
        """Mixed and in any order."""
        full = solve_modes(BAR, CLAMPED, count=6)
        mixed = full.Phi @ np.random.default_rng(2).standard_normal((6, 6))
        modes = modes_of(from_file(tmp_path, mixed))
        np.testing.assert_allclose(modes.lam, full.lam, rtol=1e-9)  # κ² ε of the mixture
        np.testing.assert_allclose(modes.Phi, full.Phi, atol=1e-7 * np.abs(full.Phi).max())

    def test_rounding_at_supports_is_taken_out(self, tmp_path: Path) -> None:
        U = solve_modes(BAR, CLAMPED, count=2).Phi.copy()
        U[CLAMPED] = 1e-9 * np.abs(U).max()
        assert not np.any(modes_of(from_file(tmp_path, U)).Phi[CLAMPED])

    def test_a_vector_that_moves_a_support(self, tmp_path: Path) -> None:
        U = solve_modes(BAR, CLAMPED, count=2).Phi.copy()
        U[CLAMPED[5], 1] = 1e-3 * np.abs(U).max()
        with pytest.raises(
            EigenError, match=rf"U.npy moves 1 DOFs that supports hold, first DOF {CLAMPED[5]}; "
        ):
            modes_of(from_file(tmp_path, U))

    def test_rigid_motions_that_it_lacks(self, tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
        U = solve_modes(BAR, SUPPORTS["free"], count=9).Phi[:, 4:]
        modes = modes_of(from_file(tmp_path, U), SUPPORTS["free"])
        assert modes.rigid == 2
        assert "lacks 4 of the 6 rigid motions" in caplog.text

    @pytest.mark.parametrize(
        ("U", "words"),
        [
            (np.zeros(N), rf"holds \({N},\), expected \({N}, k\)"),
            (np.zeros((N - 1, 2)), rf"holds \({N - 1}, 2\), expected \({N}, k\)"),
            (np.zeros((N, 0)), rf"holds \({N}, 0\), expected"),
            (np.full((N, 1), np.inf), "expected finite real numbers"),
            (np.ones((N, 1), dtype=complex), "holds complex128"),
            (np.array([[{}]] * N), r"U\.npy is no array of numbers"),
        ],
    )
    def test_not_a_basis(self, U: Floats, words: str, tmp_path: Path) -> None:
        np.save(tmp_path / "U.npy", U, allow_pickle=True)
        with pytest.raises(EigenError, match=words):
            read_basis(tmp_path / "U.npy", N)

    @pytest.mark.parametrize("content", [b"", b"U = 1", None])
    def test_not_a_file_of_numpy(self, content: bytes | None, tmp_path: Path) -> None:
        if content is not None:
            (tmp_path / "U.npy").write_bytes(content)
        with pytest.raises(EigenError, match=r"cannot read U\.npy|U\.npy is no array"):
            read_basis(tmp_path / "U.npy", N)

    def test_several_arrays(self, tmp_path: Path) -> None:
        np.savez(tmp_path / "U.npz", a=np.eye(2))
        with pytest.raises(EigenError, match="holds several arrays"):
            read_basis(tmp_path / "U.npz", N)


class TestRigidPort:
    """The tip moves as one body: u = T û."""

    tip = np.flatnonzero(P[:, 0] == SIZE[0])
    constrained = constrain(BAR, CLAMPED, DOFS, [port_nodes(MESH, tip, "equal", "tip")])

    @contextmanager
    def solver(self) -> Iterator[tuple[StaticSolver, Interface]]:
        ports = (Port("tip", ("force.x", "force.y", "force.z"), ()),)
        b = csc_array(self.constrained.T.T @ csc_array(LOADS[:, :3]))
        over = Interface(ports, b, csr_array((0, b.shape[0])), np.zeros((0, 3)))
        with static_solver(self.constrained.system, self.constrained.fixed) as solve:
            yield solve, over

    def modes(self, basis: Basis, count: int | None = None) -> Modes:
        with self.solver() as (solve, over):
            return basis_modes(basis, solve, over, self.constrained, DOFS, P, count=count)

    def test_all_kinds_stay_above_the_modes(self) -> None:
        full = self.modes(Basis(), count=4)
        for basis, count in (
            (Basis(kind="polynomial", order=2), None),
            (Basis(kind="craig-bampton"), 3),
            (Basis(kind="krylov"), 6),
        ):
            lam = self.modes(basis, count).lam
            assert np.all(lam[:4] >= full.lam * (1 - 1e-10))
            # x² for the beam's shape, 20/12.36, without lateral contraction, 0.7/(1.3 · 0.4)
            assert lam[0] < 20 / 12.36 * 0.7 / (1.3 * 0.4) * full.lam[0]

    def test_the_tip_stays_rigid(self) -> None:
        Phi = self.constrained.T @ self.modes(Basis(kind="polynomial", order=2)).Phi
        arms = P[self.tip] - P[self.tip].mean(axis=0)
        for phi in Phi.reshape(-1, 3, Phi.shape[1])[self.tip].transpose(2, 0, 1):
            about = phi - phi.mean(axis=0)
            skew = np.linalg.lstsq(arms[:, 1:], about, rcond=None)[0]
            np.testing.assert_allclose(about, arms[:, 1:] @ skew, atol=1e-10 * np.abs(phi).max())
            assert skew[0, 2] == pytest.approx(-skew[1, 1], abs=1e-9 * np.abs(phi).max())

    def test_file(self, tmp_path: Path) -> None:
        full = self.modes(Basis(), count=4)
        modes = self.modes(from_file(tmp_path, self.constrained.T @ full.Phi))
        np.testing.assert_allclose(modes.lam, full.lam, rtol=1e-10)

    def test_a_file_that_deforms_the_port(self, tmp_path: Path) -> None:
        with pytest.raises(EigenError, match="expected its nodes to move as one body"):
            self.modes(from_file(tmp_path, solve_modes(BAR, CLAMPED, count=3).Phi))
