"""The mesh of the arm: 0.6 × 0.02 × 0.04 m, 24 × 2 × 2 hexahedra of 20 nodes.

Run `python make_mesh.py` (needs the extra `mesh`); writes arm.msh beside itself.
"""

from pathlib import Path

import gmsh

LENGTH, THICKNESS, WIDTH = 0.6, 0.02, 0.04  # m: along x, y, z
CELLS = (24, 2, 2)


def main() -> None:
    """A box of equal cells, the faces at its ends named."""
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.option.setNumber("Mesh.ElementOrder", 2)
    gmsh.option.setNumber("Mesh.SecondOrderIncomplete", 1)  # 20 nodes, not 27
    gmsh.model.add("arm")
    geo = gmsh.model.geo
    volume = [(0, geo.addPoint(0.0, -THICKNESS / 2, -WIDTH / 2))]
    for direction, (length, cells) in enumerate(zip((LENGTH, THICKNESS, WIDTH), CELLS, strict=True)):
        step = [0.0, 0.0, 0.0]
        step[direction] = length
        grown = geo.extrude(volume, *step, numElements=[cells], recombine=True)
        volume = [entity for entity in grown if entity[0] == direction + 1]
    geo.synchronize()
    for name, x in ("root", 0.0), ("tip", LENGTH):
        box = (x - 1e-6, -1.0, -1.0, x + 1e-6, 1.0, 1.0)
        faces = [tag for _, tag in gmsh.model.getEntitiesInBoundingBox(*box, dim=2)]
        gmsh.model.addPhysicalGroup(2, faces, name=name)
    gmsh.model.addPhysicalGroup(3, [tag for _, tag in gmsh.model.getEntities(3)], name="body")
    gmsh.model.mesh.generate(3)
    gmsh.write(str(Path(__file__).with_name("arm.msh")))
    gmsh.finalize()


if __name__ == "__main__":
    main()
