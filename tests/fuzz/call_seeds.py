"""The model and the first inputs of the fuzz target of the calls.

    python tests/fuzz/call_seeds.py FOLDER [static | driven]

FOLDER/embedded_model.c is what the target is compiled with; FOLDER/seeds holds whole simulations.
"""

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))

from driven import part, reduced
from examples import everything

from fmu_src.embedded_model import embedded_model
from fmu_src.runtime.model import ReducedModel

GUID = "{01234567-89ab-cdef-0123-456789abcdef}"
NO_FAILURE = 255
CO_SIMULATION, MODEL_EXCHANGE = 1, 0  # fmi2Type, the lowest bit of the byte of fmi2Instantiate
# numbers of the calls in calls.c
SETUP, ENTER, LEAVE, TERMINATE, RESET = range(5)
SET_REAL, GET_REAL, SET_INTEGER, _, SET_RATES, GET_RATES = range(12, 18)
DIRECTIONAL = 22
GET_STATE, SET_STATE, _, SERIALISE = range(23, 27)
EVENT, DISCRETE, CONTINUOUS, COMPLETED, _, SET_STATES, DERIVATIVES = range(27, 34)
STEP, FREE = 37, 45
INPUTS, OUTPUTS, MODES = 7, 14, 7
ALPHA, LAST = INPUTS + OUTPUTS, INPUTS + OUTPUTS + 1 + 6 * MODES  # value references


def model(which: str) -> ReducedModel:
    """Every law and coupled modes; rigid, repeated, over-damped ones; or supported, from a static start.

    Or driven by prescribed motions: the value references mean other variables there.
    """
    if which == "driven":
        return reduced(part(), initial="static", residual=True)
    if which != "static":
        return everything()
    return everything(lam=np.array([3.0, 7.0, 30.0, 30.0, 400.0, 9000.0, 2e4]), initial="static")


def call(number: int, *arguments: int) -> bytes:
    """A call of the first instance."""
    return bytes([0, number, *arguments])


def simulation(kind: int, *calls: bytes, allocations: int = NO_FAILURE) -> bytes:
    """An instance, its initialisation, and calls."""
    start = (call(0, kind), call(SETUP, 0, 4, 4, 0, 0), call(ENTER, 0, 4, 4, 0), call(LEAVE, 0, 4, 4, 0))
    return bytes([allocations]) + b"".join((*start, *calls, call(FREE)))


def seeds() -> dict[str, bytes]:
    """Names and contents."""
    force = call(SET_REAL, 2, 0, 1, 0, 0, 2, 2, 0)
    rates = call(SET_RATES, 2, 0, 1, 1, 2, 2, 2, 0)
    step, jump = call(STEP, 0, 0), call(STEP, 255, 0, 3)
    halves = (range(INPUTS, INPUTS + 7), range(INPUTS + 7, ALPHA))
    outputs = b"".join(call(GET_REAL, 7, *half, *15 * [0]) for half in halves)
    slopes = b"".join(
        call(GET_RATES, 7, *half, *7 * [order], *8 * [0]) for half in halves for order in (1, 2)
    )
    directions = b"".join(
        call(DIRECTIONAL, 7, *half, *15 * [0], 3, 0, ALPHA + 2 + 2 * MODES, 3, 2, 2, 2) for half in halves
    )
    keep, back = call(GET_STATE, 0, 0, 0, 0), call(SET_STATE, 0, 0, 0, 0)
    damping = call(SET_REAL, 1, ALPHA, 0, 1, 0)
    fewer = call(SET_INTEGER, 1, 0, 3, 0, 0)
    exchange = b"".join(call(k, 0, 0) for k in (DISCRETE, CONTINUOUS, DERIVATIVES, COMPLETED, SET_STATES))
    return {
        "steps": simulation(CO_SIMULATION, force, step, outputs, step, outputs),
        "rates": simulation(CO_SIMULATION, force, rates, step, outputs, slopes, step, slopes),
        "states": simulation(
            CO_SIMULATION, force, step, keep, step, back, step, call(SERIALISE, 0, 0, 0, 0), back
        ),
        "damaged": simulation(CO_SIMULATION, keep, call(SERIALISE, 0, 128, 0, 136, MODES + 2), back, step),
        "parameters": simulation(CO_SIMULATION, damping, fewer, step, outputs),
        "refused": simulation(CO_SIMULATION, jump, call(STEP, 0, 9), call(SET_REAL, 1, 250, 0, 0, 0)),
        "beyond_the_last": simulation(CO_SIMULATION, call(GET_REAL, 1, LAST + 1, 0, 0, 0)),
        "directional": simulation(CO_SIMULATION, force, step, directions),
        "levels": simulation(
            CO_SIMULATION,
            force,
            fewer,
            step,
            outputs,
            call(SET_INTEGER, 1, 0, 0, 0, 0),
            step,
            outputs,
            slopes,
        ),
        "exchange": simulation(MODEL_EXCHANGE, force, exchange, call(EVENT, 0, 0), fewer),
        "reset": simulation(CO_SIMULATION, step, call(TERMINATE, 0, 4, 4, 0), call(RESET, 0, 4, 4, 0), step),
        **{f"memory_{k}": simulation(CO_SIMULATION, keep, step, allocations=k) for k in range(6)},
    }


def main(folder: Path, which: str) -> None:
    (folder / "seeds").mkdir(parents=True, exist_ok=True)
    (folder / "embedded_model.c").write_text(embedded_model(model(which), GUID), encoding="utf-8")
    for name, content in seeds().items():
        (folder / "seeds" / name).write_bytes(content)


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2] if len(sys.argv) > 2 else "rest")
