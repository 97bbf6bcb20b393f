"""The meshes of the pair: two beams along x, 30 × 20 mm, 500 and 400 mm long, hexahedra of 20 nodes; in mm.

Run `python make_mesh.py` (needs the extra `mesh`); writes left.msh and right.msh beside itself.
"""

from pathlib import Path

import gmsh

WIDTH, HEIGHT = 30.0, 20.0  # mm: along y, z
LENGTHS = {"left": (500.0, 10), "right": (400.0, 8)}  # mm, cells; clamped at their outer ends


def main() -> None:
    """Each beam between x = 0 and x = L, its middle at y = 0; its ends named."""
    for name, (length, cells) in LENGTHS.items():
        gmsh.initialize()
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setNumber("Mesh.ElementOrder", 2)
        gmsh.option.setNumber("Mesh.SecondOrderIncomplete", 1)  # 20 nodes, not 27
        gmsh.model.add(name)
        geo = gmsh.model.geo
        volume = [(0, geo.addPoint(0.0, -WIDTH / 2, 0.0))]
        for step, count in ((length, 0.0, 0.0), cells), ((0.0, WIDTH, 0.0), 2), ((0.0, 0.0, HEIGHT), 1):
            grown = geo.extrude(volume, *step, numElements=[count], recombine=True)
            volume = grown[1:2]
        geo.synchronize()
        ends = ("clamp", "tip") if name == "left" else ("tip", "clamp")
        for end, x in zip(ends, (0.0, length), strict=True):
            box = (x - 1e-3, -WIDTH, -1.0, x + 1e-3, WIDTH, HEIGHT + 1.0)
            faces = [tag for _, tag in gmsh.model.getEntitiesInBoundingBox(*box, dim=2)]
            gmsh.model.addPhysicalGroup(2, faces, name=end)
        gmsh.model.addPhysicalGroup(3, [tag for _, tag in gmsh.model.getEntities(3)], name="body")
        gmsh.model.mesh.generate(3)
        gmsh.write(str(Path(__file__).with_name(f"{name}.msh")))
        gmsh.finalize()


if __name__ == "__main__":
    main()
