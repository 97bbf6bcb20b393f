"""The mesh of the tuning fork: a U of square section, 5 × 5 mm, on a round stem; in mm.

Run `python make_mesh.py` (needs the extra `mesh`); writes tuning_fork.msh beside itself.
`python make_mesh.py SIZE FILE` makes one of another cell size (mm), for a look at convergence.
"""

import sys
from math import pi
from pathlib import Path

import gmsh

PRONG = 86.42  # mm: straight length, which sets the pitch
SECTION = 5.0  # mm: side of the prongs' square section
GAP = 10.0  # mm: between the prongs
STEM_LENGTH, STEM_RADIUS = 40.0, 3.0  # mm
SIZE = 2.5  # mm: of the cells
PER_TURN = 14  # cells around the bend and the stem


def main(size: float, path: Path) -> None:
    """Two prongs along +x and half a turn between them, fused with a stem along −x."""
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.option.setNumber("General.NumThreads", 1)
    gmsh.option.setNumber("Mesh.ElementOrder", 2)
    gmsh.option.setNumber("Mesh.Binary", 1)
    gmsh.option.setNumber("Mesh.MeshSizeMax", size)
    gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", PER_TURN * SIZE / size)
    gmsh.model.add("tuning_fork")
    occ = gmsh.model.occ
    middle, half = (GAP + SECTION) / 2, SECTION / 2
    prongs = [occ.addBox(0.0, side * middle - half, -half, PRONG, SECTION, SECTION) for side in (-1.0, 1.0)]
    square = occ.addRectangle(-half, middle - half, 0.0, SECTION, SECTION)
    occ.rotate([(2, square)], 0.0, middle, 0.0, 0.0, 1.0, 0.0, pi / 2)  # into the plane x = 0
    bend = [entity for entity in occ.revolve([(2, square)], 0, 0, 0, 0, 0, 1, pi) if entity[0] == 3]
    # the stem reaches into the bend, not through it
    stem_end = -(middle + STEM_LENGTH)
    stem = occ.addCylinder(stem_end, 0.0, 0.0, STEM_LENGTH, 0.0, 0.0, STEM_RADIUS)
    parts, _ = occ.fuse([(3, prongs[0])], [(3, prongs[1]), *bend, (3, stem)])
    occ.remove([(2, square)], recursive=True)
    occ.synchronize()
    gmsh.model.addPhysicalGroup(3, [tag for _, tag in parts], name="fork")
    for name, low, high in (
        ("stem_end", (stem_end, -99.0, -99.0), (stem_end, 99.0, 99.0)),
        ("prong_end", (PRONG, 0.0, -99.0), (PRONG, 99.0, 99.0)),
    ):
        box = [x - 1e-3 for x in low] + [x + 1e-3 for x in high]
        faces = [tag for _, tag in gmsh.model.getEntitiesInBoundingBox(*box, dim=2)]
        gmsh.model.addPhysicalGroup(2, faces, name=name)
    gmsh.model.mesh.generate(3)
    gmsh.write(str(path))
    gmsh.finalize()


if __name__ == "__main__":
    given = sys.argv[1:] or (SIZE, Path(__file__).with_name("tuning_fork.msh"))
    main(float(given[0]), Path(given[1]))
