"""The mesh of the cantilever: 1 × 0.03 × 0.02 m, 40 × 2 × 2 hexahedra of 20 nodes.

Run `python make_mesh.py` (needs the extra `mesh`); writes cantilever.msh beside itself.
"""

from pathlib import Path

import gmsh

LENGTH, WIDTH, HEIGHT = 1.0, 0.03, 0.02  # m: along x, y, z
CELLS = (40, 2, 2)


def main() -> None:
    """A box of equal cells, the faces at its ends named."""
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.option.setNumber("Mesh.ElementOrder", 2)
    gmsh.option.setNumber("Mesh.SecondOrderIncomplete", 1)  # 20 nodes, not 27
    gmsh.model.add("cantilever")
    geo = gmsh.model.geo
    volume = [(0, geo.addPoint(0.0, 0.0, 0.0))]
    for direction, (length, cells) in enumerate(zip((LENGTH, WIDTH, HEIGHT), CELLS, strict=True)):
        step = [0.0, 0.0, 0.0]
        step[direction] = length
        grown = geo.extrude(volume, *step, numElements=[cells], recombine=True)
        volume = [entity for entity in grown if entity[0] == direction + 1]
    geo.synchronize()
    for name, x in ("clamp", 0.0), ("tip", LENGTH):
        box = (x - 1e-6, -1.0, -1.0, x + 1e-6, 1.0, 1.0)
        faces = [tag for _, tag in gmsh.model.getEntitiesInBoundingBox(*box, dim=2)]
        gmsh.model.addPhysicalGroup(2, faces, name=name)
    gmsh.model.addPhysicalGroup(3, [tag for _, tag in gmsh.model.getEntities(3)], name="body")
    gmsh.model.mesh.generate(3)
    gmsh.write(str(Path(__file__).with_name("cantilever.msh")))
    gmsh.finalize()


if __name__ == "__main__":
    main()
