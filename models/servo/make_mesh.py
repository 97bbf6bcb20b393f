"""The mesh of the column: 12 × 40 × 400 mm, 1 × 2 × 12 hexahedra of 20 nodes; in mm.

Run `python make_mesh.py` (needs the extra `mesh`); writes column.msh beside itself.
"""

from pathlib import Path

import gmsh

THICKNESS, WIDTH, HEIGHT = 12.0, 40.0, 400.0  # mm: along x, y, z
CELLS = (1, 2, 12)


def main() -> None:
    """A box of equal cells, the faces at its ends named."""
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.option.setNumber("Mesh.ElementOrder", 2)
    gmsh.option.setNumber("Mesh.SecondOrderIncomplete", 1)  # 20 nodes, not 27
    gmsh.model.add("column")
    geo = gmsh.model.geo
    volume = [(0, geo.addPoint(0.0, 0.0, 0.0))]
    for direction, (length, cells) in enumerate(zip((THICKNESS, WIDTH, HEIGHT), CELLS, strict=True)):
        step = [0.0, 0.0, 0.0]
        step[direction] = length
        grown = geo.extrude(volume, *step, numElements=[cells], recombine=True)
        volume = [entity for entity in grown if entity[0] == direction + 1]
    geo.synchronize()
    for name, z in ("foot", 0.0), ("top", HEIGHT):
        box = (-1.0, -1.0, z - 1e-3, 2 * THICKNESS, 2 * WIDTH, z + 1e-3)
        faces = [tag for _, tag in gmsh.model.getEntitiesInBoundingBox(*box, dim=2)]
        gmsh.model.addPhysicalGroup(2, faces, name=name)
    gmsh.model.addPhysicalGroup(3, [tag for _, tag in gmsh.model.getEntities(3)], name="column")
    gmsh.model.mesh.generate(3)
    gmsh.write(str(Path(__file__).with_name("column.msh")))
    gmsh.finalize()


if __name__ == "__main__":
    main()
