"""A pressure on the faces of a port as nodal forces."""

import numpy as np

from .arrays import Floats
from .dofs import Dofs
from .errors import PartError
from .faces import Body, node_normals
from .ports import PortNodes


def pressure_load(port: PortNodes, body: Body, dofs: Dofs) -> Floats:
    """F_a = −∫ N_a n dA in N/Pa, (n,): a unit pressure into the whole faces of the port, n outward.

    Source: Hughes, The Finite Element Method, 2000, section 2.7 (traction h = −p n). The faces are those
    of the undeformed body: the pressure does not follow them. Nodes without the DOF take what is theirs to
    the support that holds them.
    Raises PartError: the nodes of the port cover no whole exterior face.
    """
    if not port.faces:
        raise PartError(
            f"port {port.name}: got a pressure, but its nodes cover no whole exterior face of the mesh; "
            "select all nodes of a face"
        )
    F = np.zeros(len(dofs.node))
    for name, faces in port.faces.items():
        forces = -node_normals(body.points, name, faces).reshape(-1, 3)
        for direction in range(3):
            found = dofs.find(faces.ravel(), direction)
            np.add.at(F, found[found >= 0], forces[found >= 0, direction])
    return F
