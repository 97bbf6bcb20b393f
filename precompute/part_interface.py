"""What a part shares with the system around it, in the coordinates û in which its modes are sought."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.sparse import csc_array, csr_array, diags

from fmu_src.runtime.kinds import outputs_of
from fmu_src.runtime.model import Port, row_starts

from .arrays import Floats
from .connection import Connection
from .exchange import Exchange
from .interface import Interface, Shapes, build_interface
from .moved_part import moved_part
from .moving_shapes import MovingShapes, moving_shapes
from .ports import PortNodes
from .projection import ROUNDING, rows_over
from .statics import StaticSolver
from .stress import stress_rows


def needs_statics(exchange: Exchange) -> bool:
    """Whether something is asked for that takes a static solution: reactions, prescribed motions."""
    return bool(exchange.motions) or any(support.outputs for support in exchange.supports)


def interface_of(connection: Connection, solve: StaticSolver | None) -> Interface:
    """F = b u and what is measured, over û; solve: of û, where `needs_statics`."""
    motions = connection.exchange.motions
    if not motions:
        return _over_held(connection, _over_u(connection, solve, {}))
    assert solve is not None  # `needs_statics`
    shapes = moving_shapes(connection.held, connection.system, connection.full.fixed, solve)
    each = zip(shapes.Psi.T, shapes.elastic.T, strict=True)
    interface = _over_u(connection, solve, dict(zip(motions, each, strict=True)))
    return _with_motions(connection, interface, shapes)


def _over_u(connection: Connection, solve: StaticSolver | None, shapes: Shapes) -> Interface:
    """All of it over the DOFs u of the full model."""
    full, held = connection.full, connection.held

    def stress(port: PortNodes) -> csr_array:
        assert full.mesh is not None  # the part file has no stress without one
        return stress_rows(full.mesh, full.materials, port.nodes, port.shares)

    def statics(b: Floats) -> Floats:
        assert solve is not None  # the caller saw that there are reactions
        found: Floats = held.T @ solve(held.T.T @ b)
        return found

    return build_interface(
        connection.exchange,
        full.nodes,
        full.dofs,
        connection.system,
        full.fixed,
        solve=statics,
        dashpots=connection.dashpots,
        stress=stress,
        shapes=shapes,
        resting=lambda psi: psi - held.P @ (held.W @ psi),
    )


def _over_held(connection: Connection, interface: Interface) -> Interface:
    """Loads Tᵀb and rows cT, which see nothing of a held port; TᵀKψ = 0 in the third row of a reaction."""
    T = connection.held.T
    others = np.ones(interface.c.shape[0])
    others[_third_rows(interface.ports)] = 0.0
    c = rows_over(csr_array(diags(others) @ interface.c), T)
    return replace(interface, b=csc_array(rows_over(csr_array(interface.b.T), T).T), c=c)


def _with_motions(connection: Connection, interface: Interface, shapes: MovingShapes) -> Interface:
    """The same with what is measured of Ψ, without what is rounding only."""
    c = np.asarray(interface.c @ shapes.Psi)
    size = np.outer(abs(interface.c).sum(axis=1), np.abs(shapes.Psi).max(axis=0))
    c[np.abs(c) <= ROUNDING * size] = 0.0
    third = _third_rows(interface.ports)
    c[third] = interface.c[third] @ shapes.elastic
    return replace(_over_held(connection, interface), moved=moved_part(shapes, c, connection.system))


def _third_rows(ports: Sequence[Port]) -> list[int]:
    """ψᵀK of each reaction."""
    laws = [outputs_of(port.name)[key].law for port in ports for key in port.outputs]
    return [row + 2 for row, law in zip(row_starts(laws), laws, strict=False) if law == "reaction"]
