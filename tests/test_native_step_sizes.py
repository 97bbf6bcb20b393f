"""The coefficients of the last 16 step sizes are kept; a 17th takes the place of the one used longest ago."""

from collections.abc import Callable, Sequence

import pytest
from examples import everything, two_ports
from native_fmu import OK, Instance, native_fmu

from fmu_src.runtime.model import ReducedModel

SIZES = [0.01 * k for k in range(1, 17)]


class Steps:
    """Steps one after the other; the log says which sizes are new."""

    def __init__(self, make: Callable[[], ReducedModel]) -> None:
        self.part: Instance = native_fmu(make).instance().initialise({"left.force.x": 1.0})
        self.time = 0.0

    def new(self, sizes: Sequence[float]) -> list[float]:
        found = []
        for h in sizes:
            self.part.log.clear()
            assert self.part.step(self.time, h) == OK
            self.time += h
            if [message.category for message in self.part.log] == ["logStepSizes"]:
                found.append(h)
        return found


@pytest.fixture(params=[two_ports, everything])
def steps(request: pytest.FixtureRequest) -> Steps:
    """Modes on their own, and coupled ones."""
    return Steps(request.param)


def test_sixteen_are_kept(steps: Steps) -> None:
    assert steps.new(SIZES) == SIZES
    assert steps.new(SIZES[::-1]) == []
    assert steps.new(SIZES) == []


def test_the_one_used_longest_ago_makes_room(steps: Steps) -> None:
    steps.new(SIZES)
    steps.new([SIZES[0], SIZES[2]])  # so the second is the oldest now, then the fourth
    assert steps.new([0.5, 0.6]) == [0.5, 0.6]
    kept = [h for h in SIZES if h not in (SIZES[1], SIZES[3])]
    assert steps.new([*kept, 0.5, 0.6]) == []
    assert steps.new([SIZES[1], SIZES[3]]) == [SIZES[1], SIZES[3]]


def test_sizes_in_turn_beyond_sixteen_are_always_new(steps: Steps) -> None:
    many = [*SIZES, 0.5]
    assert steps.new(many * 3) == many * 3


def test_other_damping_makes_all_new(steps: Steps) -> None:
    steps.new(SIZES)
    assert steps.part.set({"damping.alpha": 0.3}) == OK  # as it was
    assert steps.new(SIZES) == []
    assert steps.part.set({"damping.alpha": 0.4}) == OK
    assert steps.new(SIZES) == SIZES


def test_modes_that_change_the_coupling_make_all_new(steps: Steps) -> None:
    """The last mode is coupled, or is not: coefficients of fewer modes are never those of more."""
    coupled = steps.part.fmu.modes == 7
    steps.new(SIZES)
    assert steps.part.set_active(steps.part.fmu.modes - 1) == OK
    assert steps.new(SIZES) == (SIZES if coupled else [])
    assert steps.part.set_active(steps.part.fmu.modes) == OK
    assert steps.new(SIZES) == SIZES


def test_kept_coefficients_are_those_of_their_size(steps: Steps) -> None:
    """Whatever was kept or computed anew, the motion is the same to the last bit."""
    sizes = [SIZES[(7 * k * k) % 16] if k % 3 else 0.001 * (k % 20 + 1) for k in range(200)]
    steps.new(sizes)
    afresh = Steps(two_ports if steps.part.fmu.modes == 6 else everything)
    for h in sizes:
        afresh.part.set({"damping.alpha": 0.4})  # forgets all coefficients
        afresh.part.set({"damping.alpha": 0.3})
        afresh.new([h])
    assert steps.part.reals().tolist() == afresh.part.reals().tolist()
