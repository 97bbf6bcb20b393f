"""The interface of ports on a mesh, where a test has no part file."""

from collections.abc import Sequence

import numpy as np
from scipy.sparse import csr_array

from fmu_src.runtime.model import Port
from precompute.dofs import mesh_dofs
from precompute.exchange import Exchange
from precompute.interface import Interface, build_interface
from precompute.mesh import Mesh
from precompute.ports import PortNodes
from precompute.system import System


def interface_at(mesh: Mesh, ports: Sequence[tuple[Port, PortNodes]]) -> Interface:
    """F = b u and the measured motions at these ports, which ask for nothing of K and M."""
    n = 3 * len(mesh.points)
    no_matter = System(csr_array((n, n)), csr_array((n, n)), np.zeros((n, 6)))
    return build_interface(
        Exchange(ports), mesh, mesh_dofs(len(mesh.points)), no_matter, np.zeros(0, dtype=np.int64)
    )
