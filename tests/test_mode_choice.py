"""The choice of modes by an error: met at frequencies it was not made at, by no more modes than needed."""

from collections.abc import Callable
from functools import partial

import numpy as np
import pytest
from port_responses import NOTHING, Beam, brute_force, held_chain, interface, relative

from fmu_src.runtime.model import Port
from precompute.arrays import Bools, Floats, Ints
from precompute.damping import Damping, rayleigh
from precompute.dominance import dominance
from precompute.eigen import Modes, solve_modes
from precompute.errors import EigenError
from precompute.full_response import Reference
from precompute.interface import Interface
from precompute.mode_choice import Choice, choose_modes
from precompute.needed_modes import Residual, needed_modes, reduced, yardstick
from precompute.oscillators import Oscillators
from precompute.statics import static_solver
from precompute.system import System
from precompute.transfer import blocks_of, lines_of, transfer

BEAM = Beam()
BAND = (0.0, 1000.0)
ALPHA, BETA = 20.0, 2e-6


def damp(modes: Modes) -> Damping:
    return rayleigh(modes.lam, ALPHA, BETA)


def choice(
    fixed: Ints,
    error: float,
    residual: Residual,
    between: Interface = BEAM.interface,
    band: tuple[float, float] = BAND,
    system: System = BEAM.system,
    damping: Callable[[Modes], Damping] = damp,
) -> Choice:
    find = partial(solve_modes, system, fixed)
    with static_solver(system, fixed) as solve:
        return choose_modes(solve, find, damping, between, error, band, residual)


def kept(found: Choice) -> Bools:
    return np.array([lam in found.modes.lam for lam in found.found.lam])


def true_error(found: Choice, keep: Bools, residual: Residual, fixed: Ints, frequency: Floats) -> float:
    """Of the reduced model with these modes, by complex solves, relative to the peak over the band."""
    D = np.asarray((ALPHA * BEAM.system.M + BETA * BEAM.system.K).toarray())
    H = brute_force(BEAM.system, fixed, D, BEAM.interface, frequency, ALPHA)
    own = reduced(found.reference.full, keep, residual)
    E = H - transfer(own, lines_of(BEAM.interface.ports), 2 * np.pi * frequency)
    return max(float(np.max(relative(E, H, block))) for block in blocks_of(BEAM.interface.ports))


@pytest.mark.parametrize("fixed", [BEAM.clamp, NOTHING], ids=["clamped", "free"])
@pytest.mark.parametrize("residual", [False, True, "modes"])
@pytest.mark.parametrize("error", [0.03, 1e-3])
def test_the_error_is_met_and_no_mode_is_too_many(error: float, residual: Residual, fixed: Ints) -> None:
    """At 400 frequencies that the choice has not seen; without any one elastic mode it is not met."""
    found = choice(fixed, error, residual)
    frequency = np.unique(
        np.concatenate([np.linspace(*found.reference.band, 400)[1:], found.reference.frequencies])
    )
    keep = kept(found)
    assert true_error(found, keep, residual, fixed, frequency) <= error
    for mode in np.flatnonzero(keep & (found.found.lam > 0)):
        fewer = keep.copy()
        fewer[mode] = False
        # 0.95: what is left for frequencies between the samples at which modes are chosen
        assert true_error(found, fewer, residual, fixed, frequency) > 0.95 * error


class Blinkered(Reference):
    """Sampled at three low frequencies only."""

    @property
    def frequencies(self) -> Floats:
        return np.array([1.0, 5.0, 20.0])


def test_what_the_samples_do_not_show_is_found_by_the_verification() -> None:
    """Up to 20 Hz few modes do; the error over the whole band is kept all the same."""
    whole = choice(BEAM.clamp, 0.03, "modes").reference
    keep = needed_modes(Blinkered(whole.full, whole.asked, whole.band, whole.error), 0.03, "modes")
    assert keep is not None
    system = reduced(whole.full, keep, "modes")
    assert yardstick(whole.full, whole.frequencies).error(system) <= 0.03


def test_modes_chosen_leave_room_for_the_error_of_the_reference() -> None:
    """With it the certificate keeps the error; where it takes up all of it, no choice can be told."""
    whole = choice(BEAM.clamp, 1e-3, False).reference
    numbers = []
    for own in (0.0, 0.029):
        keep = needed_modes(Reference(whole.full, whole.asked, whole.band, own), 0.03, False)
        assert keep is not None
        numbers.append(np.sum(keep))
        assert yardstick(whole.full, whole.frequencies).error(reduced(whole.full, keep, False)) <= 0.03 - own
    assert numbers[0] < numbers[1]
    assert needed_modes(Reference(whole.full, whole.asked, whole.band, 0.03), 0.03, False) is None


def test_less_error_takes_more_modes() -> None:
    numbers = [len(choice(BEAM.clamp, error, False).modes.lam) for error in (0.3, 0.03, 1e-3, 1e-4)]
    assert numbers == sorted(numbers)
    assert numbers[0] < numbers[-1]


def test_rigid_modes_stay() -> None:
    found = choice(NOTHING, 0.03, "modes")
    assert found.modes.rigid == 6
    assert np.sum(found.modes.lam == 0) == 6


def test_modes_that_nobody_excites_are_not_kept() -> None:
    z = BEAM.motion(BEAM.tip, 2)
    between = interface((Port("tip", ("force.z",), ("displacement.z",)),), [z], [z])
    found = choice(BEAM.clamp, 1e-3, "modes", between)
    moved = np.abs(z @ found.modes.Phi)
    assert np.all(moved > 1e-3 * np.max(moved))
    inside = found.found.frequencies <= BAND[1]
    assert len(found.modes.lam) < np.sum(inside)


def test_far_below_the_first_resonance_one_mode_and_residual_vectors_do() -> None:
    first = solve_modes(BEAM.system, BEAM.clamp, count=1).frequencies[0]
    found = choice(BEAM.clamp, 0.01, "modes", band=(0.0, 0.05 * first))
    assert len(found.modes.lam) == 1


def test_an_error_that_no_number_of_modes_meets() -> None:
    """Of 400 masses in a row: the message says what would do instead."""
    system, between = held_chain(400)
    with pytest.raises(
        EigenError, match=r'error: got 1e-09 .* expected a larger error, or residual = "modes"'
    ):
        choice(NOTHING, 1e-9, False, between, (0.0, 1e-3), system)


def test_all_modes_of_a_small_part_leave_no_error() -> None:
    system, between = held_chain(6)
    found = choice(
        NOTHING, 1e-6, False, between, (0.0, 0.5), system, lambda modes: rayleigh(modes.lam, 0.0, 0.05)
    )
    assert len(found.modes.lam) == 6


def test_dominance_of_two_modes_by_hand() -> None:
    """Peaks |c||b|/(2ζω²): displacement 1·1/(2·0.1·1) = 5 and 4·4/(2·0.2·4) = 10; rigid modes have none."""
    k, zeta = np.array([0.0, 1.0, 4.0]), np.array([0.0, 0.1, 0.2])
    shape = np.array([[3.0], [1.0], [4.0]])
    system = Oscillators(k, np.ones(3), np.diag(2 * zeta * np.sqrt(k)), shape, shape.T, np.zeros((1, 1)), 0.0)
    ports = (Port("end", ("force.x",), ("displacement.x",)),)
    np.testing.assert_allclose(dominance(system, ports), [np.nan, 0.5, 1.0])


def test_dominance_takes_the_kind_where_a_mode_matters_most() -> None:
    """The first mode leads in displacement, 5 against 2.5, the second in acceleration, 40 against 5."""
    k, zeta = np.array([1.0, 4.0]), np.array([0.1, 0.2])
    B = np.array([[1.0], [4.0]])
    C = np.array([[1.0, 1.0], [1.0, 4.0]])
    system = Oscillators(k, np.ones(2), np.diag(2 * zeta * np.sqrt(k)), B, C, np.zeros((2, 1)), 0.0)
    ports = (Port("end", ("force.x",), ("displacement.x", "acceleration.x")),)
    np.testing.assert_allclose(dominance(system, ports), [1.0, 1.0])
