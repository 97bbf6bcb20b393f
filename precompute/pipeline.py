"""From a part file to its reduced model, and on to the FMU: the stages one after the other."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fmu_src.documentation import index_html
from fmu_src.native_fmu import build_native_fmu
from fmu_src.runtime.model import Port as FmuPort
from fmu_src.runtime.model import ReducedModel

from .arrays import Floats, Ints
from .assembly import assemble
from .damping import damping_of
from .doubts import doubt_held_ports, doubt_linear_cells, doubt_units
from .effective_mass import effective_mass, total_mass
from .eigen import Modes, solve_modes
from .errors import EigenError, ModelError, PartError, SelectionError
from .material import CellMaterial
from .mesh import Mesh
from .part import Part
from .ports import PortNodes, port_nodes
from .read_mesh import UNITS, read_mesh
from .reduction import reduce
from .selection import Selection, select_cells, select_nodes
from .shape import surface_shape, write_shape

Progress = Callable[[str, float | None], None]
"""Called with the stage's name and the fraction of it that is done, None where that is not known."""

Builder = Callable[[ReducedModel, Path, Mapping[str, bytes]], Path]
"""Writes an FMU with extra files of the archive."""


def silent(stage: str, fraction: float | None) -> None:
    """No progress shown."""


@dataclass(frozen=True)
class Reduction:
    """A reduced model with what it came from.

    effective_mass: (3, r) kg in x, y, z; total_mass in kg; dofs: free degrees of freedom of the full model.
    """

    part: Part
    mesh: Mesh
    modes: Modes
    model: ReducedModel
    effective_mass: Floats
    total_mass: float
    dofs: int


def reduce_part(part: Part, progress: Progress = silent) -> Reduction:
    """Mesh → K, M → modes → reduced model.

    Raises a ModalFmuError, one line that begins with the part file's name and key where one is at fault.
    """
    doubt_units(part)
    progress("reading the mesh", None)
    mesh = read_mesh(part.mesh, part.length_unit)
    ports = [
        (FmuPort(port.name, port.inputs, port.outputs), _port_nodes(part, mesh, k))
        for k, port in enumerate(part.ports)
    ]
    fixed = _fixed_dofs(part, mesh)
    doubt_linear_cells(mesh)
    doubt_held_ports(part, [where for _, where in ports], fixed)
    system = assemble(mesh, _materials(part, mesh), lambda fraction: progress("assembling K and M", fraction))
    with _named(part):
        modes = solve_modes(
            system,
            fixed,
            count=part.modes.count,
            max_frequency=part.modes.max_frequency,
            where=lambda dof: _place(mesh, dof),
            progress=lambda stage: progress(stage, None),
        )
    progress("reducing", None)
    with _named(part):
        model = reduce(
            part.name,
            part.description or "",
            modes.lam,
            modes.Phi,
            damping_of(part.damping, modes.lam),
            ports,
            part.modes.initial,
        )
    return Reduction(
        part,
        mesh,
        modes,
        model,
        effective_mass(system, modes.Phi),
        total_mass(system),
        system.K.shape[0] - len(fixed),
    )


def package(
    reduction: Reduction, path: Path, progress: Progress = silent, build: Builder = build_native_fmu
) -> Path:
    """Write the FMU with its mode table and its mode shapes; returns its path.

    build: build_native_fmu, or build_python_fmu for the Python twin.
    """
    progress("packaging", None)
    masses = dict(zip("xyz", reduction.effective_mass.tolist(), strict=True))
    table = index_html(reduction.model, masses, reduction.total_mass)
    shape = surface_shape(reduction.mesh, reduction.modes.Phi)
    return build(reduction.model, path, {"documentation/index.html": table.encode(), **write_shape(shape)})


@contextmanager
def _named(part: Part) -> Iterator[None]:
    """Mistakes of the part as a whole begin with its file's name."""
    try:
        yield
    except (EigenError, ModelError) as error:
        raise type(error)(f"{part.source.name}: {error}") from error


def _port_nodes(part: Part, mesh: Mesh, k: int) -> PortNodes:
    port = part.ports[k]
    return port_nodes(mesh, _nodes(part, mesh, f"port[{k + 1}].at", port.at), port.weights, port.name)


def _fixed_dofs(part: Part, mesh: Mesh) -> Ints:
    """The DOFs 3·node + direction that the supports hold, sorted and unique."""
    dofs = [np.zeros(0, dtype=np.int64)]
    for k, support in enumerate(part.supports):
        nodes = _nodes(part, mesh, f"support[{k + 1}].at", support.at)
        dofs += [3 * nodes + "xyz".index(direction) for direction in support.fix]
    return np.unique(np.concatenate(dofs))


def _nodes(part: Part, mesh: Mesh, key: str, at: Selection) -> Ints:
    try:
        return select_nodes(mesh, at, UNITS[part.length_unit])
    except SelectionError as error:
        raise SelectionError(f"{part.source.name}: {key}: {error}") from None


def _materials(part: Part, mesh: Mesh) -> list[CellMaterial]:
    """Each material with its cells; one without `cells` takes what no other names."""
    named: dict[str, dict[str, Ints]] = {}
    for k, material in enumerate(part.materials):
        if material.cells is not None:
            try:
                named[material.name] = dict(select_cells(mesh, material.cells))
            except SelectionError as error:
                raise SelectionError(f"{part.source.name}: material[{k + 1}].cells: {error}") from None
    rest = {
        family: np.setdiff1d(
            np.arange(len(cells)),
            np.concatenate(
                [np.zeros(0, dtype=np.int64), *(c[family] for c in named.values() if family in c)]
            ),
        )
        for family, cells in mesh.cells.items()
    }
    rest = {family: cells for family, cells in rest.items() if len(cells)}
    for k, material in enumerate(part.materials):
        if material.cells is None and not rest:
            raise PartError(
                f"{part.source.name}: material[{k + 1}]: got no cell that is left for it, expected some; "
                f"remove {material.name!r} or the cells of another material"
            )
    return [
        CellMaterial(m.name, m.young, m.poisson, m.density, named.get(m.name, rest) if m.cells else rest)
        for m in part.materials
    ]


def _place(mesh: Mesh, dof: int) -> str:
    node = dof // 3
    x, y, z = mesh.points[node]
    return f"node {mesh.node_ids[node]} at ({x:.4g}, {y:.4g}, {z:.4g}) m"
