"""The full model's responses from one static factor, against complex solves at every frequency."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from port_responses import NOTHING, Beam, brute_force, held_chain, interface, largest, modal_damping, relative
from scipy.sparse import csr_array
from systems import chain, chain_held

from fmu_src.runtime.model import Port
from precompute.arrays import Floats, Ints
from precompute.coupled_damping import projected_damping
from precompute.damping import Damping, modal_ratio, rayleigh
from precompute.eigen import solve_modes
from precompute.extra_damping import Dashpots
from precompute.full_response import Reference, full_response
from precompute.interface import Interface
from precompute.known_modes import KnownModes, rigid_only
from precompute.oscillators import Complexes
from precompute.reference_error import reference_error
from precompute.statics import static_solver
from precompute.system import System
from precompute.transfer import blocks_of, transfer

BEAM = Beam()
FINE = 1e-10  # accuracy asked for where only rounding is to be left
# of the peak: the brute force loses λ_max/λ₁ ≈ 1e8 times rounding, enlarged by 1/2ζ ≈ 30 at a resonance
AGREEMENT = 1e-8
Form = Callable[[Floats], Damping]


def light(lam: Floats) -> Damping:
    return rayleigh(lam, 20.0, 2e-6)


def reference(
    system: System,
    fixed: Ints,
    count: int,
    form: Form,
    band: tuple[float, float],
    accuracy: float = FINE,
    dashpots: Dashpots = (),
    between: Interface = BEAM.interface,
) -> Reference:
    modes = solve_modes(system, fixed, count=count)
    modal = form(modes.lam)
    coupled = projected_damping(modes.lam, modes.Phi, system.D, dashpots)
    damping = replace(modal, D_rest=modal.D_rest + coupled)
    with static_solver(system, fixed) as solve:
        known = KnownModes(modes.lam, modes.Phi, damping.D_rest)
        return full_response(solve, known, damping, between, band, accuracy, dashpots)


def responses(found: Reference) -> Complexes:
    return transfer(found.full.oscillators, found.full.lines, 2 * np.pi * found.frequencies)


def rayleigh_matrix(system: System, alpha: float, beta: float) -> Floats:
    return np.asarray((alpha * system.M + beta * system.K).toarray())


# fixed DOFs, known modes, form of damping, end of the band in Hz, dashpots, D, all damping as a matrix
CASES: dict[str, tuple[Ints, int, Form, float, Dashpots, csr_array | None, Floats]] = {
    "Rayleigh": (BEAM.clamp, 8, light, 900.0, (), None, rayleigh_matrix(BEAM.system, 20.0, 2e-6)),
    "ratio": (
        BEAM.clamp, 8, lambda lam: modal_ratio(lam, 0.02), 900.0, (), None,
        modal_damping(BEAM.system, BEAM.clamp, 0.02),
    ),
    "dashpot": (
        BEAM.clamp, 8, light, 900.0, ((BEAM.inner, 900.0),), None,
        rayleigh_matrix(BEAM.system, 20.0, 2e-6) + 900.0 * (BEAM.inner.T @ BEAM.inner).toarray(),
    ),
    "half of the part": (
        BEAM.clamp, 8, light, 900.0, (), BEAM.half_damped(40.0, 5e-6),
        rayleigh_matrix(BEAM.system, 20.0, 2e-6) + BEAM.half_damped(40.0, 5e-6).toarray(),
    ),
    "modes of the band unknown": (
        BEAM.clamp, 2, light, 1500.0, (), None, rayleigh_matrix(BEAM.system, 20.0, 2e-6),
    ),
    "free": (NOTHING, 12, light, 1500.0, (), None, rayleigh_matrix(BEAM.system, 20.0, 2e-6)),
    "free, fewer modes than rigid ones": (
        NOTHING, 3, light, 1500.0, (), None, rayleigh_matrix(BEAM.system, 20.0, 2e-6),
    ),
    "free, dashpot to ground": (
        NOTHING, 12, light, 1500.0, ((BEAM.inner, 900.0),), None,
        rayleigh_matrix(BEAM.system, 20.0, 2e-6) + 900.0 * (BEAM.inner.T @ BEAM.inner).toarray(),
    ),
}  # fmt: skip  # a case in as few lines as it needs


@pytest.mark.parametrize("case", CASES)
def test_it_agrees_with_brute_force(case: str) -> None:
    fixed, count, form, end, dashpots, D, all_damping = CASES[case]
    system = replace(BEAM.system, D=D)
    found = reference(system, fixed, count, form, (0.0, end), dashpots=dashpots)
    H = brute_force(system, fixed, all_damping, BEAM.interface, found.frequencies, found.full.alpha)
    assert found.error <= FINE
    assert largest(responses(found) - H, H, BEAM.interface) <= AGREEMENT
    wrong = brute_force(system, fixed, 1.01 * all_damping, BEAM.interface, found.frequencies, 0.0)
    assert largest(responses(found) - wrong, H, BEAM.interface) > 1e3 * AGREEMENT  # 1 % of damping shows


def test_without_damping() -> None:
    """Peaks have no bound; the samples stay 0.04 % away, where rounding of λ is enlarged a thousand times."""
    found = reference(BEAM.system, BEAM.clamp, 8, lambda lam: rayleigh(lam, 0.0, 0.0), (0.0, 900.0))
    nothing = np.zeros(BEAM.system.K.shape)
    H = brute_force(BEAM.system, BEAM.clamp, nothing, BEAM.interface, found.frequencies, 0.0)
    assert largest(responses(found) - H, H, BEAM.interface) <= 30 * AGREEMENT


@pytest.mark.parametrize("accuracy", [1e-2, 1e-4, 1e-6])
@pytest.mark.parametrize("case", CASES)
def test_the_accuracy_asked_for_is_reached(case: str, accuracy: float) -> None:
    fixed, count, form, end, dashpots, D, all_damping = CASES[case]
    system = replace(BEAM.system, D=D)
    found = reference(system, fixed, count, form, (0.0, end), accuracy, dashpots)
    H = brute_force(system, fixed, all_damping, BEAM.interface, found.frequencies, found.full.alpha)
    assert found.error <= accuracy
    assert largest(responses(found) - H, H, BEAM.interface) <= accuracy + AGREEMENT


BOUNDED = ["Rayleigh", "free", "dashpot", "half of the part", "modes of the band unknown"]


@pytest.mark.parametrize("case", BOUNDED)
@pytest.mark.parametrize("accuracy", [1e-2, 1e-4, 1e-6])
def test_the_error_of_the_responses_is_bounded(case: str, accuracy: float) -> None:
    """At every sample, beyond the highest known mode too; not much too large below it."""
    fixed, count, form, end, dashpots, D, all_damping = CASES[case]
    found = reference(replace(BEAM.system, D=D), fixed, count, form, (0.0, end), accuracy, dashpots)
    assert found.full.proved(2 * np.pi * found.frequencies).all()
    H = brute_force(BEAM.system, fixed, all_damping, BEAM.interface, found.frequencies, found.full.alpha)
    blocks = blocks_of(BEAM.interface.ports)
    bounds = reference_error(found.full, blocks, 2 * np.pi * found.frequencies)
    for block, bound in zip(blocks, bounds, strict=True):
        true = relative(responses(found) - H, H, block)
        peak = np.max(np.linalg.norm(H[:, block.lines[:, None], block.columns], 2, axis=(1, 2)))
        assert np.all(true <= bound / peak + AGREEMENT)
        if case in ("Rayleigh", "free"):
            assert np.max(bound / peak) <= 30 * np.max(true) + AGREEMENT


def test_more_accuracy_takes_more_vectors_and_fewer_than_the_frequencies() -> None:
    sizes = [
        reference(BEAM.system, BEAM.clamp, 8, light, (0.0, 900.0), accuracy).full.trial.shape[1]
        for accuracy in (1e-2, 1e-5, 1e-8)
    ]
    assert sizes == sorted(sizes)
    assert sizes[0] < sizes[-1] <= 12  # 3 inputs, a few blocks; complex solves would take 3 at each of 150


@pytest.mark.parametrize("case", ["ratio", "free, dashpot to ground"])
def test_where_damping_of_unknown_or_of_rigid_modes_is_not_exact_nothing_is_proved(case: str) -> None:
    fixed, count, form, end, dashpots, _, _ = CASES[case]
    found = reference(BEAM.system, fixed, count, form, (0.0, end), dashpots=dashpots)
    assert not found.full.proved(2 * np.pi * found.frequencies).any()


def test_without_damping_the_bound_ends_at_the_highest_known_mode() -> None:
    found = reference(BEAM.system, BEAM.clamp, 3, lambda lam: rayleigh(lam, 0.0, 0.0), (0.0, 700.0))
    known = np.sqrt(found.full.lam[-1]) / (2 * np.pi)
    proved = found.full.proved(2 * np.pi * np.array([0.1, 0.5, 0.999, 1.001, 1.3]) * known)
    assert proved.tolist() == [True, True, True, False, False]


def test_a_load_that_hardly_excites_a_sharp_resonance_leaves_no_gap_in_the_bound() -> None:
    """Of 1 and 1e4 rad/s the second is unknown; with α = 0.1, b₂² = 2e-5 it gives b₂²ω₂/α = 2 m/s²/N beside
    the 1/α = 10 of the first, statically 1e-12 m/N.
    """
    stiffness, load = np.array([1.0, 1e8]), np.array([1.0, np.sqrt(2e-5)])
    system = System(csr_array(np.eye(2)), csr_array(np.diag(stiffness)), chain(2).rigid)
    between = interface((Port("end", ("force.x",), ("acceleration.x",)),), [load], [load])
    found = reference(
        system, NOTHING, 1, lambda lam: rayleigh(lam, 0.1, 0.0), (0.0, 2000.0), 1e-5, between=between
    )
    at = np.array([1e4])
    exact = -(at[0] ** 2) * np.sum(load**2 / (stiffness - at[0] ** 2 + 0.1j * at[0]))
    H = transfer(found.full.oscillators, found.full.lines, at)[0, 0, 0]
    assert abs(exact) > 2.0
    assert abs(H - exact) <= 1e-5 * 10


def test_a_strong_dashpot_makes_resonances_of_its_own() -> None:
    """It holds the second of two masses: the first swings between two springs of 1 N/m, at √2 rad/s."""
    system, between = held_chain(2)
    dashpots = ((csr_array(np.array([[0.0, 1.0]])), 1e5),)
    found = reference(
        system,
        NOTHING,
        2,
        lambda lam: rayleigh(lam, 0.0, 0.0),
        (0.0, 0.5),
        between=between,
        dashpots=dashpots,
    )
    frequency, zeta = found.full.resonances
    np.testing.assert_allclose(2 * np.pi * frequency, [np.sqrt(2)], rtol=1e-9)  # it slips by 1e-10
    np.testing.assert_allclose(zeta, [1 / (4e5 * np.sqrt(2))], rtol=1e-6)  # k²/c of a spring of 1 N/m
    assert np.min(np.abs(np.sqrt(found.full.lam) - np.sqrt(2))) > 0.1


def test_many_blocks_lose_no_digits() -> None:
    """All modes of a chain, 4 sin²((2k+1)π/(4n+2)), from nothing known, one vector at a time."""
    n = 30
    system, between = held_chain(n)
    damping: Any = rayleigh(np.zeros(0), 0.0, 1e-4)
    with static_solver(system, NOTHING) as solve:
        found = full_response(solve, rigid_only(solve), damping, between, (0.0, 0.32), FINE)
    mu, _ = found.full.ritz
    np.testing.assert_allclose(1 / mu, chain_held(n, n), rtol=1e-10)  # λ_max/λ₁ = 1500, times rounding


def test_the_static_response_of_springs_in_series() -> None:
    """n springs of 1 N/m in a row give n m/N, whatever modes are known."""
    system, between = held_chain(30)
    for count in (1, 5, 29):
        found = reference(system, NOTHING, count, light, (0.0, 0.05), between=between)
        assert found.full.static_response[0, 0] == pytest.approx(30.0, rel=1e-12)  # rounding of 30 springs


def test_gravity_moves_a_free_body_as_a_whole() -> None:
    """u = g t²/2, so H = −1/ω² for a displacement, and no elastic motion is sought for it."""
    shape = BEAM.motion(BEAM.middle, 2)
    fall = np.asarray(BEAM.system.M @ BEAM.system.rigid[:, 2])
    ports = (Port("middle", (), ("displacement.z",)), Port("gravity", ("z",), ()))
    found = reference(
        BEAM.system, NOTHING, 12, lambda lam: rayleigh(lam, 0.0, 1e-6), (0.0, 900.0),
        between=interface(ports, [fall], [shape]),
    )  # fmt: skip
    omega = 2 * np.pi * found.frequencies
    assert found.full.trial.shape[1] == 0
    np.testing.assert_allclose(responses(found)[:, 0, 0], -1 / omega**2, rtol=1e-11)  # rounding of rᵀMr


@pytest.mark.parametrize("outer", ["inputs", "outputs"])
def test_it_grows_from_the_fewer_of_inputs_and_outputs(outer: str) -> None:
    """One output of six forces, or one force on six outputs, takes few vectors."""
    many = [BEAM.motion(nodes, axis) for nodes in (BEAM.tip, BEAM.middle) for axis in range(3)]
    one = BEAM.motion(BEAM.tip, 2)
    axes = ("x", "y", "z")
    if outer == "inputs":
        forces = tuple(f"force.{k}" for k in axes)
        ports = (Port("tip", forces, ("displacement.z",)), Port("middle", forces, ()))
        between = interface(ports, many, [one])
    else:
        motions = tuple(f"displacement.{k}" for k in axes)
        ports = (Port("tip", ("force.z",), motions), Port("middle", (), motions))
        between = interface(ports, [one], many)
    found = reference(BEAM.system, BEAM.clamp, 8, light, (0.0, 900.0), between=between)
    D = rayleigh_matrix(BEAM.system, 20.0, 2e-6)
    H = brute_force(BEAM.system, BEAM.clamp, D, between, found.frequencies, 20.0)
    assert largest(responses(found) - H, H, between) <= AGREEMENT
    assert found.full.trial.shape[1] <= 8  # of the one column's Krylov space; six would take 12 and more


def test_the_reaction_of_a_support() -> None:
    """ψᵀ(Mü + Du̇ − F) with ψ the unit motion of the support, against K u + D u̇ + M ü at the held DOF."""
    n, alpha, beta = 12, 0.05, 0.02
    system = chain(n)
    fixed = np.array([0])
    end, psi = np.eye(n)[-1], np.ones(n)  # the chain follows its support as a whole
    ports = (Port("end", ("force.x",), ()), Port("clamp", (), ("reaction.x",)))
    rows = [np.asarray(system.M @ psi), np.zeros(n)]
    between = interface(ports, [end], rows, np.array([[-psi @ end], [0.0]]))
    found = reference(system, fixed, 4, lambda lam: rayleigh(lam, alpha, beta), (0.0, 0.12), between=between)
    K, M = system.K.toarray(), system.M.toarray()
    exact = []
    for w in 2 * np.pi * found.frequencies:
        A = K * (1 + 1j * w * beta) + M * (1j * w * alpha - w**2)
        u = np.concatenate([[0], np.linalg.solve(A[1:, 1:], end[1:])])
        exact.append((A @ u)[0])
    error = np.abs(responses(found)[:, 0, 0] - exact)
    assert np.max(error) <= 1e-9 * np.max(np.abs(exact))  # ten times the accuracy asked for


def test_a_port_on_a_node_without_mass() -> None:
    """The spring before the last node is in series with the chain: no mode of the whole shows it."""
    n = 12
    whole = chain(n, ground=1.0)
    M = whole.M.toarray()
    M[-1, -1] = 0.0
    system = System(csr_array(M), whole.K, whole.rigid)
    _, between = held_chain(n, ("displacement.x", "acceleration.x"))
    found = reference(system, NOTHING, 4, lambda lam: rayleigh(lam, 0.01, 0.01), (0.0, 0.15), between=between)
    D = rayleigh_matrix(system, 0.01, 0.01)
    H = brute_force(system, NOTHING, D, between, found.frequencies, 0.01)
    assert largest(responses(found) - H, H, between) <= AGREEMENT


def test_from_rigid_modes_alone() -> None:
    """What a basis that holds no exact elastic mode is compared with."""
    damping: Any = rayleigh(np.zeros(0), 20.0, 2e-6)
    with static_solver(BEAM.system, BEAM.clamp) as solve:
        found = full_response(solve, rigid_only(solve), damping, BEAM.interface, (0.0, 900.0), FINE)
    D = rayleigh_matrix(BEAM.system, 20.0, 2e-6)
    H = brute_force(BEAM.system, BEAM.clamp, D, BEAM.interface, found.frequencies, 20.0)
    assert found.full.proved(2 * np.pi * found.frequencies).all()
    assert largest(responses(found) - H, H, BEAM.interface) <= AGREEMENT
