"""The modes that a part file asks for: of the full model or of a basis, with residual vectors."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from .basis import basis_modes
from .connection import Connection, damped
from .eigen import Modes, solve_modes
from .errors import PartError
from .full_part import Progress
from .full_response import Reference
from .interface import Interface
from .mode_choice import choose_modes
from .part import Part
from .residual import with_residual_modes
from .statics import StaticSolver


@dataclass(frozen=True)
class ReducedBasis:
    """modes: Φ over û; exact: modes of the full model, the lowest, none where the basis has none of them;
    reference: the full model's responses, where the modes were chosen by them.
    """

    modes: Modes
    exact: Modes | None
    reference: Reference | None = None


def basis_of(
    part: Part, connection: Connection, interface: Interface, solve: StaticSolver | None, progress: Progress
) -> ReducedBasis:
    """[basis] and [modes] of a part file; interface over û; solve: none where only plain modes are asked for.

    Raises EigenError, ZeroEnergyError: what the kinds raise; PartError: keys that do not go together.
    """
    chosen = _chosen(part, connection, interface, solve, progress)
    if part.modes.residual != "modes":
        return chosen
    assert solve is not None  # residual vectors are static solutions
    # a dashpot loads the part like an input: without its static shape, stress beside it would be missed
    loads = [interface.b.toarray(), *(w.T.toarray() for w, _ in connection.own_dashpots)]
    if interface.moved is not None and connection.system.D is not None:  # it drags the part by −DΨ ṡ
        loads.append(connection.held.T.T @ (connection.system.D @ interface.moved.Psi))
    return replace(chosen, modes=with_residual_modes(chosen.modes, np.column_stack(loads), solve))


def _chosen(
    part: Part, connection: Connection, interface: Interface, solve: StaticSolver | None, progress: Progress
) -> ReducedBasis:
    find = _finder(connection, progress)
    if part.modes.error is not None:
        return _by_error(part, connection, interface, solve, find)
    count, max_frequency = part.modes.count, part.modes.max_frequency
    if part.basis.kind == "modal":
        modes = find(count=count, max_frequency=max_frequency)
        return ReducedBasis(modes, modes)
    assert solve is not None  # other bases are made of static solutions
    modes = basis_modes(
        part.basis,
        solve,
        interface,
        connection.held,
        connection.full.dofs,
        connection.full.nodes.points,
        count=count,
        max_frequency=max_frequency,
        where=connection.where,
        progress=lambda stage: progress(stage, None),
    )
    return ReducedBasis(modes, None)


def _by_error(
    part: Part,
    connection: Connection,
    interface: Interface,
    solve: StaticSolver | None,
    find: Callable[..., Modes],
) -> ReducedBasis:
    assert solve is not None
    assert part.modes.error is not None  # the caller saw it
    assert part.modes.band is not None  # it comes with the error
    if part.damping.table is not None:
        raise PartError(
            "damping.table: got ratios by the numbers of modes, which [modes] error has yet to choose; write "
            "ratio or ratios"
        )
    choice = choose_modes(
        solve,
        find,
        lambda modes: damped(part, connection, modes),
        interface,
        part.modes.error,
        part.modes.band,
        part.modes.residual,
        connection.own_dashpots,
    )
    return ReducedBasis(choice.modes, choice.found, choice.reference)


def _finder(connection: Connection, progress: Progress) -> Callable[..., Modes]:
    held = connection.held

    def find(count: int | None = None, max_frequency: float | None = None) -> Modes:
        return solve_modes(
            held.system,
            held.fixed,
            count=count,
            max_frequency=max_frequency,
            where=connection.where,
            progress=lambda stage: progress(stage, None),
        )

    return find
