"""From a part file to its reduced model, and on to the FMU: the stages one after the other."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from fmu_src.documentation import index_html
from fmu_src.native_fmu import build_native_fmu
from fmu_src.runtime.model import ReducedModel

from .arrays import Floats
from .certificate import Certificate
from .certificate_report import certificate_files
from .certification import certificate_of
from .connection import Connection, connect, damped, drag
from .dofs import nodal
from .dominance import dominance
from .doubts import doubt_ratios, doubt_units
from .effective_mass import effective_mass, total_mass
from .eigen import Modes
from .errors import ModalFmuError
from .experiments import reference_experiments
from .full_part import FullPart, Progress, read_full_part
from .ls_ref import write_experiments
from .node_table import asking_for_coordinates
from .oscillators import oscillators_of
from .part import Part
from .part_interface import interface_of, needs_statics
from .reduced_basis import basis_of
from .reduction import reduce
from .residual import residual_flexibility
from .shape import surface_shape, write_shape
from .statics import StaticSolver, static_solver

Builder = Callable[[ReducedModel, Path, Mapping[str, bytes]], Path]
"""Writes an FMU with extra files of the archive."""


def silent(stage: str, fraction: float | None) -> None:
    """No progress shown."""


@dataclass(frozen=True)
class Reduction:
    """A reduced model with what it came from.

    full: the model it is of; modes: Φ over all DOFs of it; Psi: (n, k), what follows the motions that are
    prescribed, over all DOFs too; effective_mass: (3, r) kg in x, y, z; total_mass
    in kg; dominance: (r,), NaN for rigid modes; dofs: free degrees of freedom of the full model; certificate:
    what the reduction costs, where it was asked for and there is something to compare.
    """

    part: Part
    full: FullPart
    modes: Modes
    Psi: Floats
    model: ReducedModel
    effective_mass: Floats
    total_mass: float
    dominance: Floats
    dofs: int
    certificate: Certificate | None


def reduce_part(part: Part, progress: Progress = silent, *, certified: bool = False) -> Reduction:
    """Mesh or matrices → K, M, D → modes → reduced model; certified: with a statement of its error.

    Raises a ModalFmuError, one line that begins with the part file's name and key where one is at fault.
    """
    doubt_units(part)
    doubt_ratios(part)
    full = read_full_part(part, progress)
    with _named(part), asking_for_coordinates(full.nodes):
        connection = connect(part, full)
        with _statics(part, connection, certified, progress) as solve:
            return _reduced(part, connection, solve, certified, progress)


def _reduced(
    part: Part, connection: Connection, solve: StaticSolver | None, certified: bool, progress: Progress
) -> Reduction:
    interface = interface_of(connection, solve)
    basis = basis_of(part, connection, interface, solve, progress)
    progress("reducing", None)
    modes = basis.modes
    residual = None
    if part.modes.residual is True:
        assert solve is not None  # `_statics` saw it
        residual = residual_flexibility(interface, modes, solve)
    damping = damped(part, connection, modes)
    moved = interface.moved
    model = reduce(
        part.name,
        part.description or "",
        modes.lam,
        modes.Phi,
        damping,
        interface,
        residual,
        part.modes.initial,
        None if moved is None else drag(connection, moved, modes),
    )
    certificate = None
    if certified and solve is not None:
        progress("certifying", None)
        certificate = certificate_of(part, connection, interface, basis, model, solve)
    system, T = connection.system, connection.held.T
    everywhere = replace(modes, Phi=np.asarray(T @ modes.Phi))
    return Reduction(
        part,
        connection.full,
        everywhere,
        np.zeros((T.shape[0], 0)) if moved is None else moved.Psi,
        model,
        effective_mass(system, everywhere.Phi),
        total_mass(system),
        dominance(oscillators_of(model), model.ports),
        T.shape[1] - len(connection.held.fixed),
        certificate,
    )


def package(
    reduction: Reduction, path: Path, progress: Progress = silent, build: Builder = build_native_fmu
) -> Path:
    """Write the FMU with its mode table, mode shapes, certificate and reference results; returns its path.

    build: build_native_fmu, or build_python_fmu for the Python twin.
    """
    progress("packaging", None)
    masses = dict(zip("xyz", reduction.effective_mass.tolist(), strict=True))
    files = write_experiments(reference_experiments(reduction.model))
    references = "fmi-ls-ref.txt" if files else None
    if reduction.certificate is not None:
        files |= certificate_files(reduction.certificate)
    accuracy = None if reduction.certificate is None else "accuracy.html"
    table = index_html(reduction.model, masses, reduction.total_mass, accuracy, references)
    files["documentation/index.html"] = table.encode()
    mesh = reduction.full.mesh
    if mesh is not None:
        shapes = np.column_stack([reduction.Psi, reduction.modes.Phi])
        shapes = nodal(reduction.full.dofs, shapes, len(mesh.points))
        files |= write_shape(surface_shape(mesh, shapes))
    return build(reduction.model, path, files)


def _statics(
    part: Part, connection: Connection, certified: bool, progress: Progress
) -> AbstractContextManager[StaticSolver | None]:
    """The static factor, where plain modes are not all that is asked for."""
    modal = part.basis.kind == "modal" and part.modes.error is None and part.modes.residual is False
    if modal and not certified and not needs_statics(connection.exchange):
        return nullcontext()
    progress("factorising K", None)
    held = connection.held
    return static_solver(held.system, held.fixed, where=connection.where)


@contextmanager
def _named(part: Part) -> Iterator[None]:
    """Mistakes of the part as a whole begin with its file's name."""
    try:
        yield
    except ModalFmuError as error:
        if str(error).startswith(part.source.name):
            raise
        raise type(error)(f"{part.source.name}: {error}") from error
