"""The subspace in which the part deforms; whatever it is, it ends as modes."""

from collections.abc import Callable

import numpy as np

from .arrays import Floats
from .basis_file import read_basis
from .constrained import Constrained
from .craig_bampton import craig_bampton, interface_motions
from .dofs import Dofs
from .eigen import Modes, number_up_to, solve_modes
from .errors import EigenError
from .factor import Solver
from .interface import Interface
from .krylov import krylov
from .mode_tables import Basis
from .polynomial import polynomial_fields, vanishing_at_supports
from .restraint import tell_rigid
from .rigid import holding
from .ritz import reduced_modes
from .statics import StaticSolver
from .zero_energy import Where

MOVED = 1e-6  # of its largest entry: more than this of a vector at a support is no rounding


def basis_modes(
    basis: Basis,
    solve: StaticSolver,
    interface: Interface,
    held: Constrained,
    dofs: Dofs,
    points: Floats,
    *,
    count: int | None = None,
    max_frequency: float | None = None,
    solver: Solver = "auto",
    where: Where = "DOF {}".format,
    progress: Callable[[str], None] = lambda line: None,
) -> Modes:
    """The modes K φ = λ M φ within the subspace of this kind [2.21–2.23], over the DOFs û of `solve`.

    interface: over û too, with Tᵀb and cT; held: u = T û; dofs: of u; points: (nodes, 3) in m.
    count, max_frequency in Hz: at most one, of the fixed-interface modes for "craig-bampton", else of the
    modes; "modal", "craig-bampton" need one, "krylov" needs count, the others keep all where there is none.
    Raises EigenError, ZeroEnergyError: what the kinds raise.
    """
    system, fixed = solve.system, np.flatnonzero(solve.held)
    if basis.kind == "modal" or (basis.kind == "craig-bampton" and _moved_only(interface, solve)):
        return solve_modes(
            system,
            fixed,
            count=count,
            max_frequency=max_frequency,
            solver=solver,
            where=where,
            progress=progress,
        )
    tell_rigid(solve.rigid)
    if basis.kind == "craig-bampton":
        W = interface_motions(interface, solve)
        V = craig_bampton(W, solve, count, max_frequency, solver, progress)
        return reduced_modes(V, system, solve.rigid, f"Craig–Bampton, {solve.factor.name}", where)
    if basis.kind == "krylov":
        V = krylov(interface.b.toarray(), count or 0, basis.frequency, solve, solver)
        return reduced_modes(V, system, solve.rigid, f"Krylov vectors, {solve.factor.name}", where)
    if basis.kind == "polynomial":
        order = basis.order or 0
        fields = held.L @ polynomial_fields(points, dofs, order) if order else system.rigid
        V, words = vanishing_at_supports(fields, system, fixed), f"polynomials of order {order}"
    else:
        V, words = _from_file(basis, solve, held, where), "vectors of a file"
    return _lowest(reduced_modes(V, system, solve.rigid, words, where), count, max_frequency)


def _moved_only(interface: Interface, solve: StaticSolver) -> bool:
    """Whether ports are moved and nothing else is done there: these are held already."""
    return interface.moved is not None and interface_motions(interface, solve).shape[1] == 0


def _from_file(basis: Basis, solve: StaticSolver, held: Constrained, where: Where) -> Floats:
    """û of the file's vectors, which must respect supports, rigid ports and held ones."""
    assert basis.file is not None  # the kind needs it
    U = read_basis(basis.file, held.T.shape[0])
    V: Floats = held.L @ U
    allowed = MOVED * np.max(np.abs(U), axis=0)
    if np.any(np.abs(held.W @ U) > allowed):
        raise EigenError(
            f"basis: {basis.file.name} moves a port whose motion is an input, expected 0 there: vectors are "
            'relative to it; mend the file, or take kind = "craig-bampton"'
        )
    if np.any(np.abs(held.T @ V - U) > allowed):
        raise EigenError(
            f'basis: {basis.file.name} deforms a port of kind = "rigid", expected its nodes to move as '
            'one body; take kind = "average"'
        )
    fixed = holding(solve.system.K, np.flatnonzero(solve.held))
    moved = fixed[np.any(np.abs(V[fixed]) > allowed, axis=1)]
    if len(moved):
        raise EigenError(
            f"basis: {basis.file.name} moves {len(moved)} DOFs that supports hold, first "
            f"{where(int(moved[0]))}; expected 0 there: mend the file, or take out the support"
        )
    V[solve.held] = 0.0
    return V


def _lowest(modes: Modes, count: int | None, max_frequency: float | None) -> Modes:
    """As many as asked for, all where nothing is."""
    r = len(modes.lam)
    if count is not None and count > r:
        raise EigenError(f"count: got {count}, the basis has {r} modes; expected 1 to {r}")
    if max_frequency is not None:
        count = number_up_to(modes.lam, (2 * np.pi * max_frequency) ** 2)
    return Modes(modes.lam[:count], modes.Phi[:, :count], min(modes.rigid, count or r), modes.solver)
