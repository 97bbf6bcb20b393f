"""Exported K, M, D and a table of their rows → the System that assembly gives for a mesh."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from scipy.sparse import csr_array

from .arrays import Bools, Ints
from .dof_table import DofTable, read_dof_table, unlocated
from .dofs import Dofs
from .errors import MatrixError
from .imported_nodes import imported_nodes
from .matrix_checks import check_definite, check_masses, check_semidefinite, tell_rigid_content
from .matrix_doubts import doubt_units
from .matrix_entries import Entries
from .matrix_units import Units, in_si
from .mesh import Mesh
from .node_table import NodeTable, place
from .notice import notice
from .read_matrix import naming, read_matrix
from .rounding import rounding_shown
from .row_rounding import row_rounding
from .symmetric_matrix import symmetric_matrix
from .system import System, rigid_motions

HELD = 1e36  # what Abaqus writes on the diagonal of K where a boundary condition holds
NEIGHBOURS = (".dof", ".mapping")  # endings of the DOF tables that CalculiX and Ansys write beside matrices
SI = Units()
PER_TIME = {"stiffness": 2, "mass": 0, "damping": 1}  # exponents of 1/time


@dataclass(frozen=True)
class SystemFiles:
    """Files of K, M and perhaps D, of their rows' nodes and directions, and the units they are in."""

    stiffness: Path
    mass: Path
    damping: Path | None = None
    dofs: Path | None = None
    units: Units = SI


@dataclass(frozen=True)
class Imported:
    """A full model from files, in SI.

    dofs: what each row is, nodes counted as rows of `nodes`; fixed: DOFs that the files show as held. DOFs
    that the exporting program eliminated are not there: their supports are already in K.
    """

    system: System
    dofs: Dofs
    nodes: NodeTable
    fixed: Ints

    def where(self, dof: int) -> str:
        """The place of a DOF, for messages."""
        return place(self.nodes, self.dofs, dof)


def read_system(files: SystemFiles, mesh: Mesh | None = None) -> Imported:
    """M ü + D u̇ + K u = F [2.16] of another program.

    mesh: of the same nodes (by number); it brings coordinates and named sets, and the DOFs 3·node + direction
    in the order of node numbers where no table of DOFs says otherwise.
    Raises MatrixError, one line that begins with the file or the matrix at fault: files that cannot be
    read or do not fit together, matrices that are not those of a part.
    """
    paths = {"stiffness": files.stiffness, "mass": files.mass}
    if files.damping is not None:
        paths["damping"] = files.damping
    entries = {name: read_matrix(path) for name, path in paths.items()}
    table = _table(files, entries, mesh)
    dofs, nodes = imported_nodes(table, files.units.metres, mesh)
    A = {}
    held = np.zeros(len(table.node), dtype=bool)
    for name, path in paths.items():
        with naming(path):
            matrix = symmetric_matrix(_placed(entries[name], table), path.name)
        if name == "stiffness":
            matrix, held = _without_penalties(matrix)
        A[name] = in_si(matrix, dofs.direction, files.units, PER_TIME[name])
    rigid = rigid_motions(dofs, nodes.points)
    K = A["stiffness"]
    precision = max(entries["stiffness"].precision, rounding_shown(K, rigid), row_rounding(K, rigid[:, :3]))
    system = System(A["mass"], K, rigid, A.get("damping"), precision)
    imported = Imported(system, dofs, nodes, np.flatnonzero(held))
    _check(imported, ~held)
    return imported


def _check(imported: Imported, free: Bools) -> None:
    system, dofs = imported.system, imported.dofs
    check_semidefinite("stiffness", system.K, imported.where)
    check_semidefinite("mass", system.M, imported.where)
    if system.D is not None:
        check_semidefinite("damping", system.D, imported.where)
    check_masses(system, dofs)
    tell_rigid_content(system)
    check_definite(system, free)
    doubt_units(system, dofs, imported.nodes.points)


def _table(files: SystemFiles, entries: Mapping[str, Entries], mesh: Mesh | None) -> DofTable:
    """What the rows are: by the file that says so, the labels in the matrices, or the order of the mesh."""
    labels = [e.labels.keys for e in entries.values() if e.labels is not None]
    keys = np.unique(np.concatenate(labels)) if labels else np.zeros(0, np.int64)
    size = len(keys) if labels else entries["stiffness"].size
    beside = [files.stiffness.with_suffix(ending) for ending in NEIGHBOURS]
    path = files.dofs or next((p for p in beside if not labels and p.is_file()), None)
    if path is not None:
        with naming(path):
            return read_dof_table(path, size)
    if len(labels) == len(entries):
        return unlocated(*np.divmod(keys, 6))
    if mesh is not None and not labels and size == 3 * len(mesh.node_ids):
        notice(
            "matrices without a table of DOFs: taken as x, y, z of each node, in the order of node numbers"
        )
        return unlocated(np.repeat(np.sort(mesh.node_ids), 3), np.tile(np.arange(3), len(mesh.node_ids)))
    shape = "" if mesh is None else f" and a mesh of {len(mesh.node_ids)} nodes"
    raise MatrixError(
        f"{files.stiffness.name}: got {size} rows{shape}, but nothing that tells their nodes and directions; "
        "add dofs, a file with the header node,direction and one line per row"
    )


def _placed(entries: Entries, table: DofTable) -> Entries:
    """The entries with rows counted as those of the table."""
    n = len(table.node)
    if entries.labels is None:
        if entries.size > n or (entries.declared and entries.size != n):
            raise MatrixError(
                f"got {entries.size} rows, expected {n} as in the stiffness and its table of DOFs"
            )
        return replace(entries, size=n)
    order = np.argsort(table.keys, kind="stable")
    at = np.minimum(np.searchsorted(table.keys[order], entries.labels.keys), n - 1)
    rows = order[at]
    strange = np.flatnonzero(table.keys[rows] != entries.labels.keys)
    if strange.size:
        node, direction = entries.labels.node[strange[0]], entries.labels.direction[strange[0]]
        raise MatrixError(
            f"got node {node}, degree of freedom {direction + 1}, which the table of DOFs does not have; "
            "are both of one model?"
        )
    return replace(entries, row=rows[entries.row], col=rows[entries.col], size=n, labels=None)


def _without_penalties(K: csr_array) -> tuple[csr_array, Bools]:
    """K with ordinary numbers in place of the 10³⁶ of held DOFs, and which they are.

    K_ii of a held DOF multiplies u_i = 0: it enters neither modes nor reactions. It becomes the sum of its
    row's magnitudes and the largest of the other K_jj, so that K stays positive.
    """
    diagonal = K.diagonal()
    held: Bools = diagonal >= HELD
    if not held.any():
        return K, held
    notice(f"{held.sum()} degrees of freedom are held by {HELD:.0e} on the diagonal of K; they stay fixed")
    others = np.asarray(abs(K).sum(axis=1)).ravel() - diagonal
    K = K.copy()
    K.setdiag(np.where(held, others + np.max(diagonal, where=~held, initial=0.0), diagonal))
    return K, held
