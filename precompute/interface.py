"""What the part shares with the system around it: F = b u, and the rows of what is measured."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from typing import TypeAlias

import numpy as np
from scipy.sparse import csc_array, csr_array, hstack, vstack

from fmu_src.runtime.model import Port

from .arrays import Floats, Ints
from .dofs import Dofs
from .errors import ModalFmuError
from .exchange import Exchange
from .faces import Body
from .inertia_loads import base_load, gravity_load
from .port_motion import motion
from .port_rows import MotionOf, StressOf, direction_of, pair_row, port_rows
from .ports import PortNodes
from .pressure import pressure_load
from .support_reactions import Statics, own_dofs, reaction_rows, reaction_shape
from .system import System

StressAt: TypeAlias = Callable[[PortNodes], csr_array]
"""The nodes of a port → the rows (6, n) of its stress in xx, yy, zz, xy, yz, zx (Pa)."""

Measured: TypeAlias = tuple[csr_array, Floats]
"""Some rows of c (k, n), and their direct feed-through (k, m)."""


@dataclass(frozen=True)
class Interface:
    """F = b u [2.16] and the measured motions c·(displacements), over all DOFs of the full model.

    ports: the variables, in the order of the columns of b and of the rows of c (ROWS of the law of each
    output); b: (n, m) N per unit of an input; c: (s, n); direct: (s, m), the feed-through that is there
    before any residual flexibility.
    """

    ports: tuple[Port, ...]
    b: csc_array
    c: csr_array
    direct: Floats

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
) -> Interface:
    """F = b u and what is measured, for all that is exchanged.

    body: points and numbers of the nodes; system: the full model with the springs and masses at ports;
    fixed: the DOFs held; solve: b (n, k) → K⁺ b, for reactions; dashpots: (w (1, n), c in N·s/m) of each.
    Raises PartError: a port or support that cannot do what is asked of it.
    """
    places = {port.name: where for port, where in exchange.ports}
    moved = cache(lambda port, direction: motion(places[port], direction, dofs))
    stressed = cache(lambda port: stress(places[port]))
    loads = [
        *_port_loads(exchange, body, dofs, moved),
        *(csc_array(gravity_load(system, axis)[:, None]) for axis in exchange.gravity),
        *(csc_array(base_load(system, axis, fixed, dofs)[:, None]) for axis in exchange.base),
    ]
    b = csc_array(hstack([csc_array((len(dofs.node), 0)), *loads], format="csc"))
    measured = [
        (csr_array((0, b.shape[0])), np.zeros((0, b.shape[1]))),
        *_motions(exchange, moved, stressed),
        *_reactions(exchange, dofs, system, solve, dashpots, b),
    ]
    c = csr_array(vstack([rows for rows, _ in measured], format="csr"))
    return Interface(exchange.variables, b, c, np.concatenate([direct for _, direct in measured]))


def _port_loads(exchange: Exchange, body: Body, dofs: Dofs, moved: MotionOf) -> Iterator[csc_array]:
    """Nodal forces (n, 1) of a unit of each input of each port: those of a force or moment are mᵀ."""
    for port, where in exchange.ports:
        for key in port.inputs:
            if key == "pressure":
                yield csc_array(pressure_load(where, body, dofs)[:, None])
            else:
                yield csc_array(moved(port.name, direction_of(key)).T)


def _motions(exchange: Exchange, moved: MotionOf, stressed: StressOf) -> Iterator[Measured]:
    """Outputs of ports and pairs. Accelerations relative to the base become absolute by the base's own."""
    inputs = exchange.inputs
    for port, _ in exchange.ports:
        for key in port.outputs:
            kind, axis = key.split(".")
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
    dashpots: Sequence[tuple[csr_array, float]],
    b: csc_array,
) -> Iterator[Measured]:
    for support in own_dofs(exchange.supports):
        for key in support.outputs:
            psi = reaction_shape(support, "xyz".index(key[-1]), dofs, system, solve)
            rows, direct = reaction_rows(psi, system, dashpots, b)
            yield csr_array(rows), direct
