"""The mesh of the ring: radius 0.2 m, section 5 × 5 mm, 96 × 2 × 2 hexahedra of 20 nodes.

Run `python make_mesh.py` (needs the extra `mesh`); writes ring.msh beside itself.
"""

from math import pi
from pathlib import Path

import gmsh

RADIUS, SECTION = 0.2, 0.005  # m: of the centre line; side of the square section
AROUND, ACROSS = 96, 2


def main() -> None:
    """A square turned about the z axis by four quarters."""
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.option.setNumber("Mesh.ElementOrder", 2)
    gmsh.option.setNumber("Mesh.SecondOrderIncomplete", 1)  # 20 nodes, not 27
    gmsh.model.add("ring")
    geo = gmsh.model.geo
    corner = geo.addPoint(RADIUS - SECTION / 2, 0.0, -SECTION / 2)
    edge = geo.extrude([(0, corner)], SECTION, 0.0, 0.0, numElements=[ACROSS], recombine=True)[1]
    square = geo.extrude([edge], 0.0, 0.0, SECTION, numElements=[ACROSS], recombine=True)[1]
    volumes, start = [], square
    for _ in range(4):
        grown = geo.revolve([start], 0, 0, 0, 0, 0, 1, pi / 2, numElements=[AROUND // 4], recombine=True)
        start = grown[0]
        volumes.append(grown[1][1])
    geo.removeAllDuplicates()  # the last quarter ends where the first one begins
    geo.synchronize()
    gmsh.model.addPhysicalGroup(3, volumes, name="ring")
    gmsh.model.mesh.generate(3)
    gmsh.write(str(Path(__file__).with_name("ring.msh")))
    gmsh.finalize()


if __name__ == "__main__":
    main()
