"""What the part shares with the system around it: F = b u, and the rows of what is measured."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import TypeAlias

import numpy as np
from scipy.sparse import csc_array, csr_array, diags, hstack, vstack

from fmu_src.runtime.kinds import inputs_of
from fmu_src.runtime.model import Port

from .arrays import Floats, Ints
from .dofs import Dofs
from .errors import ModalFmuError
from .exchange import Exchange
from .faces import Body
from .inertia_loads import base_load, gravity_load
from .moved_part import MovedPart
from .port_motion import motion
from .port_rows import ACTIONS, DRIVEN, MotionOf, StressOf, direction_of, pair_row, port_rows
from .ports import PortNodes
from .pressure import pressure_load
from .support_reactions import (
    Resting,
    Statics,
    all_at_rest,
    own_dofs,
    reaction_rows,
    reaction_shape,
)
from .system import System

StressAt: TypeAlias = Callable[[PortNodes], csr_array]
"""The nodes of a port → the rows (6, n) of its stress in xx, yy, zz, xy, yz, zx (Pa)."""

Measured: TypeAlias = tuple[csr_array, Floats]
"""Some rows of c (k, n), and their direct feed-through (k, m)."""

Shapes: TypeAlias = Mapping[tuple[str, str], tuple[Floats, Floats]]
"""Port and input of a prescribed motion → its ψ (n,), and the part of it that K ψ is of (`moving_shapes`)."""

ReactionOf: TypeAlias = Callable[[Floats, Floats], Measured]
"""ψ (n,) and the part of it that K ψ is of → the rows of the reaction that does work on ψ."""


@dataclass(frozen=True)
class Interface:
    """F = b u [2.16] and the measured motions c·(displacements), over all DOFs of the full model.

    ports: the variables, in the order of the columns of b and of the rows of c (ROWS of the law of each
    output); b: (n, m) N per unit of an input; c: (s, n); direct: (s, m), the feed-through that is there
    before any residual flexibility; moved: what is added where the motion of ports is prescribed.
    """

    ports: tuple[Port, ...]
    b: csc_array
    c: csr_array
    direct: Floats
    moved: MovedPart | None = None

    @property
    def motions(self) -> Ints:
        """The columns of b of prescribed motions: (k,)."""
        keys = [(port.name, key) for port in self.ports for key in port.inputs]
        found: Ints = np.flatnonzero([inputs_of(port)[key].prescribes is not None for port, key in keys])
        return found

    def __post_init__(self) -> None:
        n, m = self.b.shape
        s = self.c.shape[0]
        if self.c.shape != (s, n) or self.direct.shape != (s, m):
            raise ModalFmuError(
                f"Interface: got b {self.b.shape}, c {self.c.shape}, direct {self.direct.shape}; "
                "expected (n, m), (s, n), (s, m)"
            )


def _no_statics(b: Floats) -> Floats:
    raise ModalFmuError("build_interface: got outputs reaction, expected solve with them (static_solver)")


def _no_stress(port: PortNodes) -> csr_array:
    raise ModalFmuError(f"build_interface: got stress at port {port.name}, expected its rows: stress")


def build_interface(
    exchange: Exchange,
    body: Body,
    dofs: Dofs,
    system: System,
    fixed: Ints,
    *,
    solve: Statics = _no_statics,
    dashpots: Sequence[tuple[csr_array, float]] = (),
    stress: StressAt = _no_stress,
    shapes: Shapes | None = None,
    resting: Resting = all_at_rest,
) -> Interface:
    """F = b u and what is measured, for all that is exchanged.

    body: points and numbers of the nodes; system: the full model with the springs and masses at ports;
    fixed: the DOFs held; solve: b (n, k) → K⁺ b, for reactions; dashpots: (w (1, n), c in N·s/m) of each;
    shapes: of each prescribed motion, whose load is that of the inertia, −Mψ; resting: of `reaction_shape`.
    Raises PartError: a port or support that cannot do what is asked of it.
    """
    places = {port.name: where for port, where in exchange.ports}
    moved = cache(lambda port, direction: motion(places[port], direction, dofs))
    stressed = cache(lambda port: stress(places[port]))
    shapes = shapes or {}
    loads = [
        *_port_loads(exchange, body, dofs, moved, system, shapes),
        *(csc_array(gravity_load(system, axis)[:, None]) for axis in exchange.gravity),
        *(
            csc_array(base_load(system, axis, fixed, dofs, driven=bool(shapes))[:, None])
            for axis in exchange.base
        ),
    ]
    b = csc_array(hstack([csc_array((len(dofs.node), 0)), *loads], format="csc"))
    forces = [float(key not in shapes) for key in exchange.keys]
    pushing = csc_array(b @ diags(forces, shape=(len(forces),) * 2))

    def reaction(psi: Floats, elastic: Floats) -> Measured:
        rows, direct = reaction_rows(psi, elastic, system, dashpots, pushing)
        return csr_array(rows), direct

    measured = [
        (csr_array((0, b.shape[0])), np.zeros((0, b.shape[1]))),
        *_motions(exchange, moved, stressed, shapes, reaction),
        *_reactions(exchange, dofs, system, solve, resting, reaction),
    ]
    c = csr_array(vstack([rows for rows, _ in measured], format="csr"))
    return Interface(exchange.variables, b, c, np.concatenate([direct for _, direct in measured]))


def _port_loads(
    exchange: Exchange, body: Body, dofs: Dofs, moved: MotionOf, system: System, shapes: Shapes
) -> Iterator[csc_array]:
    """Nodal forces (n, 1) of a unit of each input of each port: those of a force or moment are mᵀ."""
    for port, where in exchange.ports:
        for key in port.inputs:
            if key == "pressure":
                yield csc_array(pressure_load(where, body, dofs)[:, None])
            elif (port.name, key) in shapes:
                yield csc_array(-(system.M @ shapes[port.name, key][0])[:, None])
            else:
                yield csc_array(moved(port.name, direction_of(key)).T)


def _motions(
    exchange: Exchange, moved: MotionOf, stressed: StressOf, shapes: Shapes, reaction: ReactionOf
) -> Iterator[Measured]:
    """Outputs of ports and pairs. Accelerations relative to the base become absolute by the base's own."""
    inputs = exchange.inputs
    for port, _ in exchange.ports:
        for key in port.outputs:
            kind, axis = key.split(".")
            if kind in DRIVEN:
                rows, direct = reaction(*shapes[port.name, f"{DRIVEN[kind]}.{axis}"])
                yield (-rows, -direct) if kind in ACTIONS else (rows, direct)
                continue
            base = f"base.acceleration.{axis}" if kind == "absolute_acceleration" else None
            direct = np.array([[float(name == base) for name in inputs]])
            rows = port_rows(port.name, key, moved, stressed)
            yield rows, np.repeat(direct, rows.shape[0], axis=0)
    for port, ends in exchange.pairs:
        for key in port.outputs:
            yield pair_row(ends, key, moved), np.zeros((1, len(inputs)))


def _reactions(
    exchange: Exchange,
    dofs: Dofs,
    system: System,
    solve: Statics,
    resting: Resting,
    reaction: ReactionOf,
) -> Iterator[Measured]:
    for support in own_dofs(exchange.supports):
        for key in support.outputs:
            psi = reaction_shape(support, "xyz".index(key[-1]), dofs, system, solve, resting)
            yield reaction(psi, psi)
