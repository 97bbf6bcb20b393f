"""Loose pieces, hinges and nodes in no element are refused with number and place; soft parts are not."""

from dataclasses import replace

import numpy as np
import pytest
from boxes import box, joined, mapped, mesh_of
from scipy.sparse import csr_array
from systems import SOLVERS, chain, dofs_where, system_of

from precompute.eigen import solve_modes
from precompute.errors import EigenError, ZeroEnergyError
from precompute.factor import Solver
from precompute.mesh import Mesh
from precompute.system import System

NONE = np.zeros(0, dtype=np.int64)
CUBE = box("tet10", (2, 2, 2))


def beside(mesh: Mesh, offset: tuple[float, float, float]) -> Mesh:
    """The mesh and a copy of it at an offset in m; nodes at the same place are one."""
    return joined(mesh, mapped(mesh, lambda p: p + np.array(offset)))


@pytest.mark.parametrize("solver", SOLVERS)
class TestMechanisms:
    @pytest.mark.parametrize(
        ("offset", "number"),
        [
            ((1.0, 0.0, 1.0), "1 zero-energy mode "),
            ((1.0, 1.0, 1.0), "3 zero-energy modes "),
        ],  # hinge, ball joint
    )
    @pytest.mark.parametrize("clamped", [True, False])
    def test_refused(
        self, solver: Solver, offset: tuple[float, float, float], number: str, clamped: bool
    ) -> None:
        mesh = beside(CUBE, offset)
        fixed = dofs_where(mesh, mesh.points[:, 0] == 0) if clamped else NONE
        with pytest.raises(ZeroEnergyError, match=f"{number}beyond the {0 if clamped else 6} rigid ones"):
            solve_modes(system_of(mesh), fixed, count=8, solver=solver)

    def test_few_digits_may_be_the_reason(self, solver: Solver) -> None:
        mesh = beside(CUBE, (1.0, 0.0, 1.0))
        printed = replace(system_of(mesh), precision=5e-7)
        with pytest.raises(ZeroEnergyError, match="export it with more"):
            solve_modes(printed, NONE, count=8, solver=solver)
        with pytest.raises(ZeroEnergyError, match=r"or support it$"):
            solve_modes(system_of(mesh), NONE, count=8, solver=solver)

    def test_joined_by_a_face_is_legal(self, solver: Solver) -> None:
        mesh = beside(CUBE, (1.0, 0.0, 0.0))
        assert solve_modes(system_of(mesh), NONE, count=8, solver=solver).rigid == 6

    def test_the_place_is_on_the_loose_side(self, solver: Solver) -> None:
        mesh = beside(CUBE, (1.0, 0.0, 1.0))
        fixed = dofs_where(mesh, mesh.points[:, 0] == 0)
        with pytest.raises(ZeroEnergyError) as error:
            solve_modes(system_of(mesh), fixed, count=1, solver=solver, where=lambda dof: f"node {dof // 3}")
        node = int(str(error.value).split("near node ")[1].split(":")[0])
        assert (
            np.max(mesh.points[node]) == 2.0
        )  # the hinge is at x = 1, z = 1: what moves most is far from it


class TestSoftPartsAreLegal:
    @pytest.mark.parametrize("solver", SOLVERS)
    @pytest.mark.parametrize(
        ("family", "cells"),
        [("hex20", (150, 1, 1)), ("tet10", (200, 1, 1))],
    )
    def test_beam_of_a_thousand_thicknesses(
        self, solver: Solver, family: str, cells: tuple[int, int, int]
    ) -> None:
        L, t = 10.0, 0.01
        mesh = box(family, cells, (L, t, t))
        fixed = dofs_where(mesh, mesh.points[:, 0] == 0)
        modes = solve_modes(system_of(mesh), fixed, count=4, solver=solver)
        # Euler–Bernoulli, βL = 1.875104, 4.694091, in pairs
        f = np.array([1.875104, 4.694091]) ** 2 / (2 * np.pi * L**2) * np.sqrt(210e9 * t**2 / 12 / 7850.0)
        # 1e-3 by the mesh; λ₁ is 20 to 100 roundings of K, which is up to 1e-3 of f₁
        np.testing.assert_allclose(modes.frequencies, np.repeat(f, 2), rtol=3e-3)
        free = solve_modes(system_of(mesh), NONE, count=8, solver=solver)
        f = 4.730041**2 / (2 * np.pi * L**2) * np.sqrt(210e9 * t**2 / 12 / 7850.0)
        assert free.rigid == 6
        np.testing.assert_allclose(free.frequencies[6:], f, rtol=3e-3)

    def test_pieces_that_are_all_held(self) -> None:
        """Two blocks, each clamped: nothing is loose, and all modes are pairs."""
        blocks = beside(CUBE, (0.0, 3.0, 0.0))
        fixed = dofs_where(blocks, blocks.points[:, 0] == 0)
        lam = solve_modes(system_of(blocks), fixed, count=6).lam
        alone = solve_modes(system_of(CUBE), dofs_where(CUBE, CUBE.points[:, 0] == 0), count=3).lam
        np.testing.assert_allclose(lam, np.repeat(alone, 2), rtol=1e-10)  # rounding · λ_max/λ


class TestPieces:
    def test_two_free_ones(self) -> None:
        with pytest.raises(ZeroEnergyError, match=r"6 zero-energy modes beyond the 6 rigid ones.* 2 pieces"):
            solve_modes(system_of(beside(CUBE, (3.0, 0.0, 0.0))), NONE, count=8)

    def test_one_held_and_one_loose(self) -> None:
        mesh = beside(CUBE, (3.0, 0.0, 0.0))
        fixed = dofs_where(mesh, mesh.points[:, 0] == 0)
        with pytest.raises(
            ZeroEnergyError, match=r"6 zero-energy modes beyond the 0 rigid .* 1 of them loose"
        ) as error:
            solve_modes(
                system_of(mesh), fixed, count=8, where=lambda dof: f"x = {mesh.points[dof // 3, 0]:g}"
            )
        assert "around x = 3" in str(error.value)

    def test_a_node_in_no_element(self) -> None:
        mesh = mesh_of(np.concatenate([CUBE.points, [[9.0, 9.0, 9.0]]]), dict(CUBE.cells))
        system, last = system_of(mesh), len(CUBE.points)
        with pytest.raises(ZeroEnergyError, match=f"3 free DOFs without stiffness, near node {last}"):
            solve_modes(system, NONE, count=8, where=lambda dof: f"node {dof // 3}")
        fixed = 3 * last + np.arange(3)
        assert solve_modes(system, fixed, count=8).rigid == 6  # fixed, it is harmless


class TestNoStiffnessMatrix:
    @pytest.mark.parametrize("n", [40, 600])  # dense, Lanczos
    def test_negative_spring(self, n: int) -> None:
        with pytest.raises(EigenError, match="negative strain energy"):
            solve_modes(chain(n, ground=-0.5), NONE, count=3)

    @pytest.mark.parametrize("name", ["K", "M"])
    @pytest.mark.parametrize(("value", "message"), [(np.nan, "NaN"), (-1.0, "negative diagonal .* DOF 3")])
    def test_bad_entries(self, name: str, value: float, message: str) -> None:
        system = chain(20, ground=1.0)
        A = getattr(system, name).tolil()
        A[3, 3] = value
        matrices = {"K": system.K, "M": system.M, name: csr_array(A.tocsr())}
        with pytest.raises(EigenError, match=f"{name}: .*{message}"):
            solve_modes(System(rigid=system.rigid, **matrices), NONE, count=3)
