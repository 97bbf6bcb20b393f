"""The mesh of the mast: a tube 3 m high, 120 mm wide, wall 6 mm; 16 × 30 × 1 hexahedra of 20 nodes; in mm.

Run `python make_mesh.py` (needs the extra `mesh`); writes mast.msh beside itself.
"""

from math import pi
from pathlib import Path

import gmsh

HEIGHT, RADIUS, WALL = 3000.0, 60.0, 6.0  # mm: along z, of the outside, of the wall
AROUND, ALONG = 16, 30


def main() -> None:
    """A ring of four quarters, drawn upwards; its ends named."""
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.option.setNumber("Mesh.ElementOrder", 2)
    gmsh.option.setNumber("Mesh.SecondOrderIncomplete", 1)  # 20 nodes, not 27
    gmsh.option.setNumber("Mesh.Binary", 1)
    gmsh.model.add("mast")
    geo = gmsh.model.geo
    inside = geo.addPoint(RADIUS - WALL, 0.0, 0.0)
    start = geo.extrude([(0, inside)], WALL, 0.0, 0.0, numElements=[1], recombine=True)[1]
    ring = []
    for _ in range(4):
        grown = geo.revolve([start], 0, 0, 0, 0, 0, 1, pi / 2, numElements=[AROUND // 4], recombine=True)
        start = grown[0]
        ring.append(grown[1])
    grown = geo.extrude(ring, 0.0, 0.0, HEIGHT, numElements=[ALONG], recombine=True)
    geo.removeAllDuplicates()  # the last quarter ends where the first one begins
    geo.synchronize()
    for name, z in ("foot", 0.0), ("flange", HEIGHT):
        box = (-2 * RADIUS, -2 * RADIUS, z - 1e-3, 2 * RADIUS, 2 * RADIUS, z + 1e-3)
        faces = [tag for _, tag in gmsh.model.getEntitiesInBoundingBox(*box, dim=2)]
        gmsh.model.addPhysicalGroup(2, faces, name=name)
    volumes = [tag for dimension, tag in grown if dimension == 3]
    gmsh.model.addPhysicalGroup(3, volumes, name="mast")
    gmsh.model.mesh.generate(3)
    gmsh.write(str(Path(__file__).with_name("mast.msh")))
    gmsh.finalize()


if __name__ == "__main__":
    main()
