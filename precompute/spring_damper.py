"""Springs and dampers between two ports of different parts: a model without a state."""

from collections.abc import Mapping
from typing import get_args

import numpy as np

from fmu_src.runtime.model import Port, ReducedModel

from .part_values import Direction

ENDS = ("a", "b")
"""The names of the two ports."""


def spring_damper(
    name: str, stiffness: Mapping[Direction, float], damping: Mapping[Direction, float]
) -> ReducedModel:
    """f_a = −k (x_a − x_b) − c (v_a − v_b),  f_b = −f_a, for each direction on its own.

    stiffness, damping: by direction, k in N/m (x, y, z) or N·m/rad (rx, ry, rz), c in N·s/m or N·m·s/rad, not
    all 0. The inputs are the displacements (rotations) of both ends in the directions with k > 0 and the
    velocities (angular velocities) in those with c > 0; the outputs are the forces (moments) on the ends.
    """
    k = {direction: value for direction, value in stiffness.items() if value > 0}
    c = {direction: value for direction, value in damping.items() if value > 0}
    directions: list[Direction] = [direction for direction in get_args(Direction) if direction in {**k, **c}]
    moved = [(_key("displacement", d), d, k[d]) for d in directions if d in k]
    moved += [(_key("velocity", d), d, c[d]) for d in directions if d in c]
    # one end: a column per input, a row per force
    one = np.array([[factor if d == row else 0.0 for _, d, factor in moved] for row in directions])
    R = np.block([[-one, one], [one, -one]])
    inputs, outputs = tuple(key for key, _, _ in moved), tuple(_key("force", d) for d in directions)
    texts = [f"k = {k[d]:g} in {d}" for d in k] + [f"c = {c[d]:g} in {d}" for d in c]
    return ReducedModel(
        name=name,
        description=f"spring and damper between a and b: {', '.join(texts)} (SI)",
        lam=np.zeros(0),
        alpha=0.0,
        beta=0.0,
        D_rest=np.zeros((0, 0)),
        B=np.zeros((0, R.shape[1])),
        C=np.zeros((len(R), 0)),
        R=R,
        R_in=np.zeros((R.shape[1], R.shape[1])),
        ports=tuple(Port(end, inputs, outputs) for end in ENDS),
    )


ABOUT = {"displacement": "rotation", "velocity": "angular_velocity", "force": "moment"}


def _key(kind: str, direction: Direction) -> str:
    """ "displacement", "x" → "displacement.x"; "displacement", "rx" → "rotation.x"."""
    return f"{ABOUT[kind] if direction.startswith('r') else kind}.{direction[-1]}"
