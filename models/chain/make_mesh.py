"""The mesh of the link: 200 × 20 × 20 mm, 8 × 1 × 1 hexahedra of 20 nodes; in mm.

Run `python make_mesh.py` (needs the extra `mesh`); writes link.msh beside itself.
"""

from pathlib import Path

import gmsh

LENGTH, WIDTH, HEIGHT = 200.0, 20.0, 20.0  # mm: along x, y, z
CELLS = (8, 1, 1)


def main() -> None:
    """A box of equal cells, the faces at its ends named."""
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.option.setNumber("Mesh.ElementOrder", 2)
    gmsh.option.setNumber("Mesh.SecondOrderIncomplete", 1)  # 20 nodes, not 27
    gmsh.model.add("link")
    geo = gmsh.model.geo
    volume = [(0, geo.addPoint(0.0, 0.0, 0.0))]
    for direction, (length, cells) in enumerate(zip((LENGTH, WIDTH, HEIGHT), CELLS, strict=True)):
        step = [0.0, 0.0, 0.0]
        step[direction] = length
        grown = geo.extrude(volume, *step, numElements=[cells], recombine=True)
        volume = [entity for entity in grown if entity[0] == direction + 1]
    geo.synchronize()
    for name, x in ("left", 0.0), ("right", LENGTH):
        box = (x - 1e-3, -1.0, -1.0, x + 1e-3, 2 * WIDTH, 2 * HEIGHT)
        faces = [tag for _, tag in gmsh.model.getEntitiesInBoundingBox(*box, dim=2)]
        gmsh.model.addPhysicalGroup(2, faces, name=name)
    gmsh.model.addPhysicalGroup(3, [tag for _, tag in gmsh.model.getEntities(3)], name="link")
    gmsh.model.mesh.generate(3)
    gmsh.write(str(Path(__file__).with_name("link.msh")))
    gmsh.finalize()


if __name__ == "__main__":
    main()
