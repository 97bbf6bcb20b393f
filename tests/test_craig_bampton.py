"""Interface motions as constraints: fixed-interface modes, constraint modes, and what they are together."""

from functools import cache

import numpy as np
import pytest
from bodies import BAR, LOADS, MIDDLE, SUPPORTS, Dense, dense, interface, mean, modal_flexibility, relative
from boxes import box
from scipy.linalg import lstsq
from scipy.sparse import csc_array, csr_array, diags
from systems import SOLVERS, chain, chain_free, dofs_where, system_of

from fmu_src.runtime.model import Port
from precompute.arrays import Floats, Ints
from precompute.craig_bampton import craig_bampton, interface_motions
from precompute.eigen import Modes, solve_modes
from precompute.errors import EigenError
from precompute.factor import Solver
from precompute.fixed_interface import fixed_interface_modes, hold_interface
from precompute.interface import Interface
from precompute.ritz import reduced_modes
from precompute.statics import StaticSolver, static_solver
from precompute.system import System

W = LOADS / np.linalg.norm(LOADS, axis=0)  # orthonormal: no two share a DOF
ONE = W[:, [2]]  # z at the tip
NONE = SUPPORTS["free"]
LONG = box("hex20", (10, 2, 1), (2.0, 0.2, 0.3))  # 3·DENSE DOFs: Lanczos


@cache
def dense_bar(supports: str) -> Dense:
    return dense(BAR, SUPPORTS[supports])


def reduced(V: Floats, solve: StaticSolver) -> Modes:
    return reduced_modes(V, solve.system, solve.rigid, "")


class TestFixedInterface:
    @pytest.mark.parametrize("supports", SUPPORTS)
    @pytest.mark.parametrize(("interface", "left"), [(W, 2), (ONE, 5)])  # rigid motions left to a free bar
    def test_against_dense_algebra(self, supports: str, interface: Floats, left: int) -> None:
        """λ of ZᵀKZ, ZᵀMZ with Z a basis of Wᵀu = 0."""
        with static_solver(BAR, SUPPORTS[supports]) as solve:
            held = hold_interface(interface, solve)
            expected = dense_bar(supports).modes(interface)[0]
            rigid = held.left.shape[1]
            assert rigid == {"free": left, "hinge": 0, "clamped": 0}[supports]
            assert np.all(expected[:rigid] < 1e-6 * expected[rigid])
            found = fixed_interface_modes(held, rigid + 12, None)
        np.testing.assert_allclose(found.lam, expected[rigid : rigid + 12], rtol=1e-9)  # κ(K) ε
        np.testing.assert_allclose(interface.T @ found.Phi, 0, atol=1e-12 * np.abs(found.Phi).max())
        np.testing.assert_allclose(found.Phi.T @ (BAR.M @ found.Phi), np.eye(12), atol=1e-12)

    @pytest.mark.parametrize("solver", SOLVERS)
    @pytest.mark.parametrize("held_at_root", [True, False])
    def test_single_nodes_are_held_as_supports_hold(self, solver: Solver, held_at_root: bool) -> None:
        p = LONG.points
        system = system_of(LONG)
        root = dofs_where(LONG, p[:, 0] == 0) if held_at_root else NONE
        node = dofs_where(LONG, np.all(p == (2.0, 0.2, 0.3), axis=1))
        expected = solve_modes(system, np.concatenate([root, node]), count=10, solver=solver)
        unit = np.zeros((len(system.rigid), 3))
        unit[node, [0, 1, 2]] = 1.0
        with static_solver(system, root, solver=solver) as solve:
            held = hold_interface(unit, solve)
            found = fixed_interface_modes(held, 10, None, solver)
        assert held.left.shape[1] == expected.rigid
        np.testing.assert_allclose(found.lam, expected.lam[expected.rigid :], rtol=1e-10)
        overlap = np.abs(np.sum(found.Phi * (system.M @ expected.Phi[:, expected.rigid :]), axis=0))
        np.testing.assert_allclose(overlap, 1.0, rtol=1e-8)

    def test_a_distributed_interface_by_lanczos(self) -> None:
        system = system_of(LONG)
        end = LONG.points[:, 0] == 2.0
        held_face = np.column_stack([mean(end, k, len(system.rigid)) for k in range(3)])
        held_face /= np.linalg.norm(held_face, axis=0)
        expected = dense(system, NONE).modes(held_face)[0]
        with static_solver(system, NONE) as solve:
            held = hold_interface(held_face, solve)
            found = fixed_interface_modes(held, 13, None)
            ceiling = np.sqrt(expected[9] * 1.0001) / (2 * np.pi)
            below = fixed_interface_modes(held, None, ceiling)
        assert held.left.shape[1] == 3
        np.testing.assert_allclose(found.lam, expected[3:13], rtol=1e-9)
        np.testing.assert_allclose(below.lam, expected[3:10], rtol=1e-9)

    def test_multiple_frequencies_are_all_found(self) -> None:
        """A square beam bends alike in two directions; the count of negative pivots tells of the second."""
        mesh = box("hex20", (12, 1, 1), (3.0, 0.2, 0.2))
        system = system_of(mesh)
        root, end = (dofs_where(mesh, mesh.points[:, 0] == x) for x in (0.0, 3.0))
        unit = np.zeros((len(system.rigid), len(end)))
        unit[end, np.arange(len(end))] = 1.0
        with static_solver(system, root) as solve:
            found = fixed_interface_modes(hold_interface(unit, solve), 6, None)
        np.testing.assert_allclose(found.lam[0:4:2], found.lam[1:4:2], rtol=1e-9)
        expected = solve_modes(system, np.concatenate([root, end]), count=6)
        np.testing.assert_allclose(found.lam, expected.lam, rtol=1e-9)

    def test_massless_dofs(self) -> None:
        """Every second mass of a chain is none: the springs beside it are in series."""
        M = csr_array(diags([np.tile([1.0, 0.0], 5)], [0]))
        system = System(M, chain(10, ground=1.0).K, chain(10).rigid)
        with static_solver(system, NONE) as solve:
            found = fixed_interface_modes(hold_interface(np.eye(10)[:, [0]], solve), 4, None)
        # four masses, springs of ½ N/m between them and to ground: 2 sin²((2k+1)π/18)
        np.testing.assert_allclose(
            found.lam, 2 * np.sin((2 * np.arange(4) + 1) * np.pi / 18) ** 2, rtol=1e-12
        )

    def test_more_than_there_are(self) -> None:
        with static_solver(chain(5), NONE) as solve:
            held = hold_interface(np.eye(5)[:, [0]], solve)
            assert len(fixed_interface_modes(held, 4, None).lam) == 4
            with pytest.raises(EigenError, match="count: got 5, the part has 4 free DOFs"):
                fixed_interface_modes(held, 5, None)


@pytest.mark.parametrize("supports", SUPPORTS)
class TestBasis:
    def test_loads_at_two_ports_are_answered_exactly_at_rest(self, supports: str) -> None:
        expected = LOADS.T @ dense_bar(supports).static(LOADS)
        with static_solver(BAR, SUPPORTS[supports]) as solve:
            modes = reduced(craig_bampton(W, solve, 2), solve)
            fixed_only = reduced(craig_bampton(W, solve, 20)[:, -20:], solve)
        assert modes.rigid == solve.rigid.shape[1]
        got = modal_flexibility(modes.lam, modes.Phi, modes.rigid, LOADS)
        assert relative(got, expected) < 1e-10  # κ(K) ε
        assert (
            relative(modal_flexibility(fixed_only.lam, fixed_only.Phi, fixed_only.rigid, LOADS), expected)
            > 0.1
        )

    def test_unit_motions_of_the_interface(self, supports: str) -> None:
        """K u + W μ = 0, Wᵀu = eⱼ: bordered, by dense algebra."""
        full = dense_bar(supports)
        w = W[full.free]
        bordered = np.block([[full.K / 1e11, w], [w.T, np.zeros((4, 4))]])
        u = lstsq(bordered, np.concatenate([np.zeros((len(w), 4)), np.eye(4)]))[0][: len(w)]
        with static_solver(BAR, SUPPORTS[supports]) as solve:
            V = craig_bampton(W, solve, 0)[full.free]
        outside = V @ lstsq(V, u)[0] - u
        assert np.abs(outside).max() < 1e-9 * np.abs(u).max()

    def test_frequencies_fall_to_those_of_the_part(self, supports: str) -> None:
        with static_solver(BAR, SUPPORTS[supports]) as solve:
            full = solve_modes(BAR, SUPPORTS[supports], count=12)
            errors = [
                reduced(craig_bampton(W, solve, count), solve).lam[full.rigid : 12] / full.lam[full.rigid :]
                - 1
                for count in (10, 30, int(np.sum(~solve.held)) - 4)  # the last: all there are
            ]
        for more, fewer in zip(errors[1:], errors, strict=False):
            assert np.all(more < fewer + 1e-10)
        assert np.max(errors[0]) > 1e-3
        np.testing.assert_allclose(errors[-1], 0, atol=1e-9)  # κ(K) ε


def test_an_interface_that_inertia_balances() -> None:
    """The mean of a free chain of equal masses moves without a spring being stretched."""
    mean_motion = np.full((6, 1), 6**-0.5)
    with static_solver(chain(6), NONE) as solve:
        modes = reduced(craig_bampton(mean_motion, solve, 5), solve)
    np.testing.assert_allclose(
        modes.lam, chain_free(6, 6), rtol=1e-12
    )  # elastic modes leave the mean at rest


def test_count_0_is_guyan_reduction() -> None:
    """λ of TᵀKT, TᵀMT with T = [I; −K_ii⁻¹ K_ib] (Guyan, 1965)."""
    system = chain(7, ground=1.0)
    boundary, inner = np.array([3, 6]), np.array([0, 1, 2, 4, 5])
    K = system.K.toarray()
    T = np.zeros((7, 2))
    T[boundary] = np.eye(2)
    T[inner] = -np.linalg.solve(K[np.ix_(inner, inner)], K[np.ix_(inner, boundary)])
    with static_solver(system, NONE) as solve:
        modes = reduced(craig_bampton(np.eye(7)[:, boundary], solve, 0), solve)
    np.testing.assert_allclose(
        modes.lam, np.sort(np.linalg.eigvals(np.linalg.solve(T.T @ T, T.T @ K @ T))), rtol=1e-12
    )


class TestInterfaceMotions:
    def span(self, ports: tuple[Port, ...], b: Floats, c: Floats, fixed: Ints = NONE) -> Floats:
        over = Interface(ports, csc_array(b), csr_array(c), np.zeros((len(c), b.shape[1])))
        with static_solver(BAR, fixed) as solve:
            return interface_motions(over, solve)

    def test_forces_and_motions_once_each(self) -> None:
        with static_solver(BAR, NONE) as solve:
            found = interface_motions(interface(), solve)
        assert found.shape[1] == 4
        np.testing.assert_allclose(found.T @ found, np.eye(4), atol=1e-14)
        np.testing.assert_allclose(found @ (found.T @ LOADS), LOADS, atol=1e-15)

    def test_pressure_stress_and_gravity_are_no_motions(self) -> None:
        ports = (
            Port("tip", ("force.z", "pressure"), ("stress.mises", "rotation.y")),
            Port("gravity", ("z",), ()),
        )
        other = np.random.default_rng(0).standard_normal((len(LOADS), 9))
        b = np.column_stack([LOADS[:, 2], other[:, 0], other[:, 1]])
        c = np.column_stack([other[:, 2:8], LOADS[:, 3]]).T
        found = self.span(ports, b, c)
        assert found.shape[1] == 2
        np.testing.assert_allclose(found @ (found.T @ LOADS[:, 2:]), LOADS[:, 2:], atol=1e-15)

    def test_what_supports_hold_is_no_motion(self) -> None:
        root = np.column_stack([LOADS[:, 0], np.zeros(len(LOADS))])
        root[SUPPORTS["clamped"][0], 1] = 1.0
        ports = (Port("tip", ("force.x", "force.y"), ()),)
        assert self.span(ports, root, np.zeros((0, len(root))), SUPPORTS["clamped"]).shape[1] == 1

    def test_none(self) -> None:
        middle = mean(MIDDLE, 2)[:, None]
        with pytest.raises(EigenError, match="needs a port with forces, moments or motions"):
            self.span((Port("middle", ("pressure",), ()),), middle, np.zeros((0, len(middle))))
