"""K and M of a mesh of one material, and the DOFs that its supports hold."""

import numpy as np

from precompute.arrays import Bools, Ints
from precompute.assembly import assemble
from precompute.material import CellMaterial
from precompute.mesh import Mesh
from precompute.system import System


def system_of(mesh: Mesh, young: float, poisson: float, density: float) -> System:
    cells = {family: np.arange(len(nodes)) for family, nodes in mesh.cells.items()}
    return assemble(mesh, [CellMaterial("all", young, poisson, density, cells)])


def held(nodes: Bools, directions: str) -> Ints:
    """DOFs of the nodes marked, in each of the directions."""
    return np.concatenate([3 * np.flatnonzero(nodes) + "xyz".index(k) for k in directions])
