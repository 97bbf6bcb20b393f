"""Write the meshes of this folder: python make_meshes.py (needs gmsh).

Two boxes [0, 1] and [1, 2] × [0, 0.5]² with groups that overlap: surfaces "clamp" and "fixed" (both x = 0),
a surface "end" of the other sense (x = 2), a line "edge", a point "corner", volumes "left" and 4 (without
a name), both in "body".
"""

import os
from pathlib import Path

import gmsh

os.chdir(Path(__file__).parent)  # decks carry the path they were written to


def boxes(hexahedra: bool) -> None:
    gmsh.clear()
    cad, model = gmsh.model.occ, gmsh.model
    left, right = (cad.addBox(x, 0, 0, 1, 0.5, 0.5) for x in (0, 1))
    cad.fragment([(3, left)], [(3, right)])
    cad.synchronize()

    def inside(low: list[float], high: list[float], dimension: int) -> list[int]:
        margin = 1e-3
        box = [x - margin for x in low] + [x + margin for x in high]
        return [tag for _, tag in model.getEntitiesInBoundingBox(*box, dimension)]

    face = inside([0, 0, 0], [0, 0.5, 0.5], 2)
    model.addPhysicalGroup(2, face, 7, "clamp")
    model.addPhysicalGroup(2, face, 9, "fixed")
    model.addPhysicalGroup(2, [-tag for tag in inside([2, 0, 0], [2, 0.5, 0.5], 2)], 11, "end")
    model.addPhysicalGroup(1, inside([2, 0, 0], [2, 0.5, 0], 1), 12, "edge")
    model.addPhysicalGroup(0, inside([2, 0.5, 0.5], [2, 0.5, 0.5], 0), 1, "corner")
    model.addPhysicalGroup(3, inside([0, 0, 0], [1, 0.5, 0.5], 3), 3, "left")
    model.addPhysicalGroup(3, inside([1, 0, 0], [2, 0.5, 0.5], 3), 4)
    model.addPhysicalGroup(3, inside([0, 0, 0], [2, 0.5, 0.5], 3), 5, "body")
    model.mesh.setSize(model.getEntities(0), 1.0)
    if hexahedra:
        for _, tag in model.getEntities(1):
            model.mesh.setTransfiniteCurve(tag, 2)
        for _, tag in model.getEntities(2):
            model.mesh.setTransfiniteSurface(tag)
            model.mesh.setRecombine(2, tag)
        for _, tag in model.getEntities(3):
            model.mesh.setTransfiniteVolume(tag)
    model.mesh.generate(3)
    model.mesh.setOrder(2)


def write(name: str, version: float = 4.1, binary: bool = False, everything: bool = False) -> None:
    gmsh.option.setNumber("Mesh.MshFileVersion", version)
    gmsh.option.setNumber("Mesh.Binary", binary)
    gmsh.option.setNumber("Mesh.SaveAll", everything)
    gmsh.write(name)


gmsh.initialize()
gmsh.option.setNumber("Mesh.SecondOrderIncomplete", 1)
for kind, hexahedra in (("tet10", False), ("hex20", True)):
    boxes(hexahedra)
    write(f"{kind}_41.msh")
    write(f"{kind}_41_binary.msh", binary=True)
    write(f"{kind}_22.msh", version=2.2)
    write(f"{kind}_22_binary.msh", version=2.2, binary=True)
    write(f"{kind}.inp")
    write(f"{kind}.vtk")
    for fields, layout in enumerate(("free", "small", "large")):
        gmsh.option.setNumber("Mesh.BdfFieldFormat", fields)
        write(f"{kind}_{layout}.bdf")
boxes(False)
write("tet10_41_everything.msh", everything=True)
gmsh.option.setNumber("Mesh.SaveParametric", 1)
write("tet10_41_parametric.msh")
gmsh.option.setNumber("Mesh.SaveParametric", 0)
gmsh.option.setNumber("Mesh.SecondOrderIncomplete", 0)
boxes(True)
write("hex27_41.msh")
gmsh.finalize()
