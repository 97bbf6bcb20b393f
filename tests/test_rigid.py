"""The rigid motions that supports leave."""

import numpy as np
import pytest
from boxes import box, mapped
from scipy.sparse import block_diag, csr_array
from systems import dofs_where, system_of

from precompute.arrays import Floats, Ints
from precompute.dofs import mesh_dofs
from precompute.rigid import rigid_modes
from precompute.system import System, rigid_motions

MESH = box("hex8", (4, 2, 2), (0.4, 0.2, 0.1))  # m
SYSTEM = system_of(MESH)
MASS = 7850.0 * 0.4 * 0.2 * 0.1  # kg
P = MESH.points
NONE = np.zeros(0, dtype=np.int64)


def check(system: System, fixed: Ints, Phi: Floats) -> None:
    """ΦᵀMΦ = I, no strain energy, 0 at the supports."""
    np.testing.assert_allclose(
        Phi.T @ (system.M @ Phi), np.eye(Phi.shape[1]), atol=1e-13
    )  # rounding of 100 DOFs
    # rounding of KΦ
    np.testing.assert_array_less(
        np.abs(system.K @ Phi), 1e-13 * (abs(system.K) @ np.abs(Phi)).max(initial=1.0)
    )
    assert not np.any(Phi[fixed])


class TestFreeBody:
    def test_six(self) -> None:
        Phi = rigid_modes(SYSTEM, NONE)
        assert Phi.shape == (3 * len(P), 6)
        check(SYSTEM, NONE, Phi)

    def test_translations_then_rotations_about_the_centre_of_gravity(self) -> None:
        Phi = rigid_modes(SYSTEM, NONE)
        np.testing.assert_allclose(Phi[:, :3], SYSTEM.rigid[:, :3] / np.sqrt(MASS), atol=1e-13)
        # a box: its axes are principal, J_x = m (b² + c²)/12; trilinear cells integrate ∫ρ r² exactly
        J = MASS / 12 * np.array([0.2**2 + 0.1**2, 0.4**2 + 0.1**2, 0.4**2 + 0.2**2])
        expected = rigid_motions(mesh_dofs(len(P)), P)[:, 3:] / np.sqrt(J)
        np.testing.assert_allclose(Phi[:, 3:], expected, atol=1e-12)

    def test_any_reference_point_gives_the_same(self) -> None:
        moved = SYSTEM.rigid.copy()
        moved[:, 3] += 5.0 * SYSTEM.rigid[:, 1] - 2.0 * SYSTEM.rigid[:, 2]  # about an axis 5 m away
        np.testing.assert_allclose(
            rigid_modes(System(SYSTEM.M, SYSTEM.K, moved), NONE), rigid_modes(SYSTEM, NONE), atol=1e-11
        )


class TestSupports:
    @pytest.mark.parametrize(
        ("fixed", "left"),
        [
            (dofs_where(MESH, P[:, 0] == 0), 0),  # clamped face
            (dofs_where(MESH, np.arange(len(P)) == 5), 3),  # ball joint
            (dofs_where(MESH, (P[:, 0] == 0) & (P[:, 2] == 0)), 1),  # hinge along an edge
            (dofs_where(MESH, P[:, 2] == 0)[2::3], 3),  # slides on a plane
            (dofs_where(MESH, P[:, 0] == 0)[0::3], 3),  # symmetry plane
            (np.arange(3 * len(P))[1::3], 3),  # every y
        ],
    )
    def test_number(self, fixed: Ints, left: int) -> None:
        Phi = rigid_modes(SYSTEM, fixed)
        assert Phi.shape[1] == left
        check(SYSTEM, fixed, Phi)

    @pytest.mark.parametrize(("away", "left"), [(0.0, 1), (1e-8, 1), (1e-3, 0)])  # of the length of the body
    def test_a_hinge_line_may_be_rounded_but_not_bent(self, away: float, left: int) -> None:
        """Coordinates of single precision must not turn a hinge into a clamp; a real offset must."""
        edge = np.flatnonzero((P[:, 0] == 0) & (P[:, 2] == 0))
        offset = np.zeros_like(P)
        offset[edge[1], 2] = away * 0.4
        mesh = mapped(MESH, lambda p: p + offset)
        fixed = dofs_where(mesh, np.isin(np.arange(len(P)), edge))
        assert rigid_modes(system_of(mesh), fixed).shape[1] == left

    def test_rotation_about_the_hinge(self) -> None:
        fixed = dofs_where(MESH, (P[:, 0] == 0) & (P[:, 2] == 0))
        phi = rigid_modes(SYSTEM, fixed)[:, 0].reshape(-1, 3)
        J = MASS / 3 * (0.4**2 + 0.1**2)  # of a box about its edge
        expected = np.stack([P[:, 2], 0 * P[:, 0], -P[:, 0]], axis=1) / np.sqrt(J)
        np.testing.assert_allclose(phi * np.sign(phi[-1, 0]), expected, atol=1e-12)

    def test_what_holds_nothing_does_not_count(self) -> None:
        """Fixed DOFs of a node in no element: the body is free."""
        n = len(P) * 3
        M, K = (csr_array(block_diag([A, csr_array((3, 3))]).tocsr()) for A in (SYSTEM.M, SYSTEM.K))
        far = np.concatenate([P, [[9.0, 9.0, 9.0]]])
        wide = System(M, K, rigid_motions(mesh_dofs(len(far)), far))
        Phi = rigid_modes(wide, n + np.arange(3))
        assert Phi.shape[1] == 6
        check(wide, n + np.arange(3), Phi)


class TestSprings:
    @pytest.mark.parametrize("stiffness", [1e9, 1e3, 1.0])  # N/m; the body's own are about 1e10
    def test_a_spring_to_ground_holds(self, stiffness: float) -> None:
        K = SYSTEM.K.tolil()
        K[2, 2] += stiffness  # z of the first node
        held = System(SYSTEM.M, csr_array(K.tocsr()), SYSTEM.rigid)
        Phi = rigid_modes(held, NONE)
        assert Phi.shape[1] == 5
        check(held, NONE, Phi)
        # what is left does not move the spring: up to the rounding of RᵀKR, 1e-6 N/m, against its stiffness
        np.testing.assert_allclose(Phi[2], 0, atol=1e-10 + 1e-6 / stiffness)


def test_the_order_of_the_supports_does_not_matter() -> None:
    fixed = dofs_where(MESH, P[:, 2] == 0)[2::3]
    np.testing.assert_allclose(rigid_modes(SYSTEM, fixed), rigid_modes(SYSTEM, fixed[::-1]), atol=1e-12)
