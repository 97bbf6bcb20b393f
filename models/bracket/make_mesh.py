"""The mesh of the bracket: an L with a fillet, a rib, bolt holes and a seat for a bearing; in mm.

Run `python make_mesh.py` (needs the extra `mesh`); writes bracket.msh beside itself.
"""

from pathlib import Path

import gmsh

BASE, WALL, WIDTH, THICKNESS = 100.0, 90.0, 60.0, 8.0  # mm: along x, along z, along y; of both plates
FILLET = 10.0  # mm: radius in the corner
RIB = 6.0  # mm: thickness of the rib in the middle
BOLTS = [(45.0, 15.0), (45.0, 45.0), (85.0, 15.0), (85.0, 45.0)]  # mm: x, y of the holes in the base
BOLT_RADIUS, BEARING_RADIUS, BEARING_HEIGHT = 4.5, 12.0, 62.0  # mm
SIZE, SIZE_HOLE = 5.8, 3.6  # mm: of the cells


def main(path: Path, finer: float = 1.0) -> None:
    """Two plates, fillet and rib fused, holes cut; cells `finer` times smaller."""
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.option.setNumber("General.NumThreads", 1)
    gmsh.option.setNumber("Mesh.ElementOrder", 2)
    gmsh.option.setNumber("Mesh.Binary", 1)
    gmsh.option.setNumber("Mesh.MeshSizeMax", SIZE / finer)
    gmsh.option.setNumber("Mesh.MeshSizeMin", SIZE_HOLE / finer)
    gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", 12 * finer)  # cells per full turn
    gmsh.model.add("bracket")
    occ = gmsh.model.occ
    base = occ.addBox(0.0, 0.0, 0.0, BASE, WIDTH, THICKNESS)
    wall = occ.addBox(0.0, 0.0, 0.0, THICKNESS, WIDTH, WALL)
    corner = occ.addBox(THICKNESS, 0.0, THICKNESS, FILLET, WIDTH, FILLET)
    centre = THICKNESS + FILLET
    round_off = occ.addCylinder(centre, 0.0, centre, 0.0, WIDTH, 0.0, FILLET)
    fillet, _ = occ.cut([(3, corner)], [(3, round_off)])
    rib = _rib()
    solid, _ = occ.fuse([(3, base)], [(3, wall), *fillet, rib])
    bolts = [(3, occ.addCylinder(x, y, -1.0, 0.0, 0.0, THICKNESS + 2.0, BOLT_RADIUS)) for x, y in BOLTS]
    seat = (3, occ.addCylinder(-1.0, WIDTH / 2, BEARING_HEIGHT, THICKNESS + 2.0, 0.0, 0.0, BEARING_RADIUS))
    solid, _ = occ.cut(solid, [*bolts, seat])
    occ.synchronize()
    gmsh.model.addPhysicalGroup(3, [tag for _, tag in solid], name="body")
    holes = [
        tag
        for x, y in BOLTS
        for tag in _faces((x, y, THICKNESS / 2), (BOLT_RADIUS, BOLT_RADIUS, THICKNESS / 2))
    ]
    reach = (THICKNESS / 2, BEARING_RADIUS, BEARING_RADIUS)
    gmsh.model.addPhysicalGroup(2, holes, name="bolts")
    gmsh.model.addPhysicalGroup(2, _faces((THICKNESS / 2, WIDTH / 2, BEARING_HEIGHT), reach), name="bearing")
    top = _faces((THICKNESS / 2, WIDTH / 2, WALL), (THICKNESS / 2, WIDTH / 2, 0.0))
    gmsh.model.addPhysicalGroup(2, top, name="load_face")
    gmsh.model.mesh.generate(3)
    gmsh.write(str(path))
    gmsh.finalize()


def _rib() -> tuple[int, int]:
    """A triangle across the corner, in the middle of the width."""
    occ = gmsh.model.occ
    y = (WIDTH - RIB) / 2
    ends = [(THICKNESS, THICKNESS), (THICKNESS + 28.0, THICKNESS), (THICKNESS, THICKNESS + 28.0)]
    corners = [occ.addPoint(x, y, z) for x, z in ends]
    edges = [occ.addLine(a, b) for a, b in zip(corners, corners[1:] + corners[:1], strict=True)]
    triangle = occ.addPlaneSurface([occ.addCurveLoop(edges)])
    grown = occ.extrude([(2, triangle)], 0.0, RIB, 0.0)
    return next(entity for entity in grown if entity[0] == 3)


def _faces(centre: tuple[float, ...], reach: tuple[float, ...]) -> list[int]:
    """The faces inside the box centre ± reach."""
    low = [c - r - 1e-3 for c, r in zip(centre, reach, strict=True)]
    high = [c + r + 1e-3 for c, r in zip(centre, reach, strict=True)]
    return [tag for _, tag in gmsh.model.getEntitiesInBoundingBox(*low, *high, dim=2)]


if __name__ == "__main__":
    main(Path(__file__).with_name("bracket.msh"))
