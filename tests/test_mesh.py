"""Mesh files: what every reader must agree on, measured on meshes that Gmsh wrote (tests/data/meshes)."""

import logging
from pathlib import Path

import meshio
import numpy as np
import pytest

from precompute.errors import MeshError
from precompute.mesh import Mesh
from precompute.raw_mesh import rows_of
from precompute.read_mesh import UNITS, read_mesh

MESHES = Path(__file__).parent / "data" / "meshes"
GMSH = sorted(path.name for path in MESHES.glob("*.msh") if not path.name.startswith("hex27"))
OTHERS = sorted(path.name for path in MESHES.iterdir() if path.suffix in (".inp", ".bdf", ".vtk"))
DIGITS = 1e-6  # the files hold at least 7 digits of coordinates up to 2

TET_EDGES = ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))
HEX_EDGES = (
    *((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4)),
    *((0, 4), (1, 5), (2, 6), (3, 7)),
)


def volumes(p):
    """Signed volumes of tetrahedra, parallelepipeds and right wedges with straight edges, p (c, k, 3)."""
    k = p.shape[1]
    a, b, c = {4: (1, 2, 3), 10: (1, 2, 3), 6: (1, 2, 3), 8: (1, 3, 4), 20: (1, 3, 4)}[k]
    share = {4: 6, 10: 6, 6: 2, 8: 1, 20: 1}[k]
    return np.linalg.det(np.stack([p[:, i] - p[:, 0] for i in (a, b, c)], axis=1)) / share


def middle_errors(p):
    """|p_m − (p_a + p_b)/2| of every mid-edge node, p (c, 10 or 20, 3)."""
    edges, corners = (TET_EDGES, 4) if p.shape[1] == 10 else (HEX_EDGES, 8)
    a, b = np.array(edges).T
    return np.linalg.norm(p[:, corners:] - (p[:, a] + p[:, b]) / 2, axis=2)


@pytest.mark.parametrize("name", GMSH + OTHERS)
def test_order_of_nodes(name):
    mesh = read_mesh(MESHES / name)
    ((family, nodes),) = mesh.cells.items()
    p = mesh.points[nodes]
    assert family == name[:5]
    assert (volumes(p) > 0).all()
    assert volumes(p).sum() == pytest.approx(2 * 0.5 * 0.5, rel=1e-5)  # small fields of Nastran: 6 digits
    assert middle_errors(p).max() < DIGITS


@pytest.mark.parametrize("swap", [(8, 9), (4, 5), (0, 1)])
def test_order_of_nodes_is_seen(swap):
    mesh = read_mesh(MESHES / "tet10_41.msh")
    nodes = mesh.cells["tet10"].copy()
    nodes[:, swap] = nodes[:, swap[::-1]]
    p = mesh.points[nodes]
    assert (volumes(p) < 0).all() or middle_errors(p).max() > 1e4 * DIGITS


@pytest.mark.parametrize("name", GMSH)
def test_gmsh_groups(name):
    mesh = read_mesh(MESHES / name)
    family = name[:5]
    n = len(mesh.cells[family])
    where = {set_name: mesh.points[rows] for set_name, rows in mesh.node_sets.items()}
    on_face = np.flatnonzero(mesh.points[:, 0] < DIGITS)
    assert mesh.node_sets["clamp"].tolist() == mesh.node_sets["fixed"].tolist() == on_face.tolist()
    assert mesh.node_sets["end"].tolist() == np.flatnonzero(mesh.points[:, 0] > 2 - DIGITS).tolist()
    assert len(where["edge"]) == 3
    assert np.allclose(where["edge"][:, [0, 2]], [2, 0], atol=DIGITS)
    assert np.allclose(where["corner"], [[2, 0.5, 0.5]], atol=DIGITS)
    assert set(where) == {"clamp", "fixed", "end", "edge", "corner"}

    # each cell once, though version 2 writes it once for each of its groups
    assert len(np.unique(np.sort(mesh.cells[family], axis=1), axis=0)) == n
    assert set(mesh.cell_sets) == {"left", "physical 4", "body"}
    assert mesh.cell_sets["body"][family].tolist() == list(range(n))
    centres = mesh.points[mesh.cells[family]].mean(axis=1)
    assert mesh.cell_sets["left"][family].tolist() == np.flatnonzero(centres[:, 0] < 1).tolist()
    assert mesh.cell_sets["physical 4"][family].tolist() == np.flatnonzero(centres[:, 0] > 1).tolist()


def test_gmsh_formats_agree():
    first, *others = (read_mesh(MESHES / name) for name in GMSH if name.startswith("tet10"))
    for other in others:
        assert np.allclose(first.points, other.points, atol=1e-15)
        assert first.node_ids.tolist() == other.node_ids.tolist()
        order = [np.lexsort(np.sort(mesh.cells["tet10"], axis=1).T) for mesh in (first, other)]
        assert np.array_equal(first.cells["tet10"][order[0]], other.cells["tet10"][order[1]])


def test_gmsh_tags_with_gaps(tmp_path):
    path = tmp_path / "gaps.msh"
    path.write_text(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n5\n"
        "70 0 0 0\n9 1 0 0\n30 0 1 0\n2 0 0 1\n500 5 5 5\n$EndNodes\n"
        "$Elements\n1\n8 4 2 0 1 70 9 30 2\n$EndElements\n"
    )
    mesh = read_mesh(path)
    assert mesh.node_ids.tolist() == [70, 9, 30, 2]  # 500 is in no cell
    assert mesh.points.tolist() == [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    assert mesh.cells["tet4"].tolist() == [[0, 1, 2, 3]]


def test_gmsh_entity_without_cells(tmp_path):
    """Version 4.1 may list an entity of a group with no cell in it."""
    path = tmp_path / "none.msh"
    path.write_text(
        '$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n3 1 "body"\n3 2 "void"\n$EndPhysicalNames\n'
        "$Entities\n0 0 0 2\n1 0 0 0 1 1 1 1 1 0\n2 0 0 0 1 1 1 1 2 0\n$EndEntities\n"
        "$Nodes\n1 4 1 4\n3 1 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n$EndNodes\n"
        "$Elements\n2 1 1 1\n3 1 4 1\n1 1 2 3 4\n3 2 4 0\n$EndElements\n"
    )
    mesh = read_mesh(path)
    assert mesh.cell_sets == {"body": {"tet4": [0]}}
    assert mesh.node_sets["void"].tolist() == []


@pytest.mark.parametrize("name", [name for name in OTHERS if name.endswith(".bdf")])
def test_nastran_properties(name):
    mesh = read_mesh(MESHES / name)
    family = name[:5]
    centres = mesh.points[mesh.cells[family]].mean(axis=1)
    assert mesh.cell_sets["pid 1"][family].tolist() == np.flatnonzero(centres[:, 0] < 1).tolist()
    assert mesh.cell_sets["pid 2"][family].tolist() == np.flatnonzero(centres[:, 0] > 1).tolist()
    assert mesh.node_sets["pid 7"].tolist() == np.flatnonzero(mesh.points[:, 0] > 2 - DIGITS).tolist()


NASTRAN = """SOL 103
CEND
BEGIN BULK
$ a tetrahedron: numbers without E, ids with gaps
GRID          12             0.0     0.0     0.0
GRID,7,,1.,.0,0.
GRID*                  5                             0.0           2.0+0
*                    0.0
GRID           3             0.0     0.0  3.00-1
GRID           4             9.0     9.0     9.0
CTETRA         1       6      12       7       5       3
ENDDATA
"""


def test_nastran_fields(tmp_path):
    path = tmp_path / "one.bdf"
    path.write_text(NASTRAN)
    mesh = read_mesh(path)
    assert mesh.node_ids.tolist() == [12, 7, 5, 3]
    assert mesh.points.tolist() == [[0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 0.3]]
    assert mesh.cell_sets == {"pid 6": {"tet4": [0]}}


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("ENDDATA\n", "", "got no ENDDATA"),
        (
            "      12             0.0",
            "      12       3     0.0",
            "line 5: GRID 12 is given in coordinate system 3",
        ),
        ("      5       3\n", "       5\n", "line 11: CTETRA 1 has 3 nodes, expected 4 or 10"),
        ("      5       3\n", "      5      99\n", "names a node that the file does not have"),
        ("  3.00-1", "   three", "line 9: expected GRID, id, system, x, y, z"),
        ("GRID           4", "GRID           3", "GRID 3 is defined twice"),
        ("$ a tetrahedron", "INCLUDE 'more.bdf' $", "line 4: INCLUDE is not carried out"),
    ],
)
def test_nastran_mistakes(tmp_path, old, new, message):
    path = tmp_path / "one.bdf"
    assert old in NASTRAN
    path.write_text(NASTRAN.replace(old, new))
    with pytest.raises(MeshError, match=message):
        read_mesh(path)


@pytest.mark.parametrize("ending", ["vtu", "vtk"])
def test_vtk_cell_data_become_sets(tmp_path, ending):
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]], float)
    cells = [("tetra", [[0, 1, 2, 3], [1, 4, 2, 3]]), ("triangle", [[0, 1, 2]])]
    data = {
        "material": [np.array([3, 8]), np.array([5])],
        "number": [np.arange(2), np.array([2])],
        "quality": [np.array([0.5, 0.7]), np.array([1.0])],
    }
    path = tmp_path / f"two.{ending}"
    meshio.write(path, meshio.Mesh(points, cells, cell_data=data))
    mesh = read_mesh(path)
    assert mesh.cell_sets["material 3"] == {"tet4": [0]}
    assert mesh.cell_sets["material 8"] == {"tet4": [1]}
    assert mesh.node_sets["material 5"].tolist() == [0, 1, 2]
    assert not any(name.startswith("quality") for name in (*mesh.node_sets, *mesh.cell_sets))
    assert mesh.node_ids.tolist() == [1, 2, 3, 4, 5]


def test_vtk_numbers_of_many_cells_are_no_sets(tmp_path):
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], float)
    path = tmp_path / "many.vtu"
    cells = [("tetra", [[0, 1, 2, 3]] * 51)]
    data = {"id": [np.arange(51)], "group": [np.arange(51) % 50]}
    meshio.write(path, meshio.Mesh(points, cells, cell_data=data))
    assert set(read_mesh(path).cell_sets) == {f"group {i}" for i in range(50)}


@pytest.mark.parametrize("nodes", ["0 1 2 3 4 5", "0 2 1 3 5 4"])
def test_vtk_wedges_of_either_sense(tmp_path, nodes):
    path = tmp_path / "wedge.vtk"
    path.write_text(
        "# vtk DataFile Version 3.0\nwedge\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 6 double\n"
        "0 0 0  2 0 0  0 1 0  0 0 3  2 0 3  0 1 3\n"
        f"CELLS 1 7\n6 {nodes}\nCELL_TYPES 1\n13\n"
    )
    mesh = read_mesh(path)
    assert volumes(mesh.points[mesh.cells["wedge6"]]) == pytest.approx([3.0])


@pytest.mark.parametrize("ending", ["bdf", "vtu", "inp"])
@pytest.mark.parametrize("kind", ["tet10", "hex20"])
def test_files_of_meshio(tmp_path, kind, ending):
    whole = read_mesh(MESHES / f"{kind}_41.msh")
    name = {"tet10": "tetra10", "hex20": "hexahedron20"}[kind]
    path = tmp_path / f"{kind}.{ending}"
    meshio.write(path, meshio.Mesh(whole.points, [(name, whole.cells[kind])]))
    mesh = read_mesh(path)
    ((family, nodes),) = mesh.cells.items()
    assert family == ("hex20r" if (kind, ending) == ("hex20", "inp") else kind)  # meshio writes C3D20RH
    assert np.array_equal(nodes, whole.cells[kind])
    assert np.allclose(mesh.points, whole.points, rtol=0, atol=1e-11)  # Nastran's wide fields hold 12 digits


def test_units():
    size = {unit: np.ptp(read_mesh(MESHES / "hex20_41.msh", unit).points[:, 0]) for unit in UNITS}
    expected = {
        "m": 2.0,
        "mm": 2e-3,
        "cm": 2e-2,
        "um": 2e-6,
        "in": 0.0508,
        "ft": 0.6096,
    }  # 1 in = 25.4 mm, 1 ft = 12 in
    assert size == pytest.approx(expected)
    with pytest.raises(MeshError, match="got length_unit 'km', expected one of m, mm, cm, um, in, ft"):
        read_mesh(MESHES / "hex20_41.msh", "km")


def test_notices(caplog):
    caplog.set_level(logging.INFO, "modalfmu")
    read_mesh(MESHES / "tet10_41.msh")
    assert caplog.messages == []  # the triangles only mark the boundary
    read_mesh(MESHES / "tet10_small.bdf")
    assert caplog.messages == ["cells left out, not solid: 1 CBAR, 8 CTRIA6"]


def test_notice_of_loose_shells(tmp_path, caplog):
    caplog.set_level(logging.INFO, "modalfmu")
    path = tmp_path / "fin.msh"
    path.write_text(
        '$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n2 1 "fin"\n2 2 "skin"\n$EndPhysicalNames\n'
        "$Nodes\n6\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 2 0 0\n6 2 1 0\n$EndNodes\n"
        "$Elements\n3\n1 4 2 0 1 1 2 3 4\n2 2 2 1 1 2 5 6\n3 2 2 2 1 1 2 3\n$EndElements\n"
    )
    mesh = read_mesh(path)
    assert mesh.node_sets["fin"].tolist() == [1]  # what of the fin is in a solid cell
    assert mesh.node_sets["skin"].tolist() == [0, 1, 2]
    assert caplog.messages == ["cells left out, not solid: 2 tri3", "nodes dropped, in no solid cell: 2"]


@pytest.mark.parametrize("name", [*GMSH, *OTHERS])
@pytest.mark.parametrize("share", [0.02, 0.3, 0.5, 0.8, 0.97])
def test_file_cut_off(tmp_path, name, share):
    whole = (MESHES / name).read_bytes()
    if name.endswith(".inp"):  # what follows the elements of a deck may be cut at the end of a line unseen
        whole = whole[: whole.index(b"*ELSET,")]
    path = tmp_path / f"cut{Path(name).suffix}"
    path.write_bytes(whole[: int(share * len(whole))])
    with pytest.raises(MeshError, match=r"^cut\.") as caught:
        read_mesh(path)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("name", ["empty.msh", "empty.inp", "empty.vtu", "empty.bdf"])
def test_empty_file(tmp_path, name):
    (tmp_path / name).touch()
    with pytest.raises(MeshError, match=f"^{name}: the file is empty"):
        read_mesh(tmp_path / name)


@pytest.mark.parametrize("name", ["noise.msh", "noise.inp", "noise.vtu", "noise.vtk", "noise.bdf"])
def test_no_mesh_at_all(tmp_path, name, capsys):
    (tmp_path / name).write_bytes(bytes(range(256)) * 40)
    with pytest.raises(MeshError, match=f"^{name}: "):
        read_mesh(tmp_path / name)
    assert capsys.readouterr() == ("", "")


def test_paths_that_are_no_file(tmp_path):
    with pytest.raises(MeshError, match=r"^gone\.msh: no such file in "):
        read_mesh(tmp_path / "gone.msh")
    with pytest.raises(MeshError, match="got a folder"):
        read_mesh(tmp_path)
    (tmp_path / "part.step").write_text("ISO-10303-21;")
    with pytest.raises(MeshError, match=r"got the ending '\.step', expected one of \.msh, \.inp"):
        read_mesh(tmp_path / "part.step")


def test_cells_that_cannot_be_integrated():
    with pytest.raises(MeshError, match=r"got 2 hex27 cells.*Mesh\.SecondOrderIncomplete = 1"):
        read_mesh(MESHES / "hex27_41.msh")


def test_no_solid_cell(tmp_path):
    path = tmp_path / "shell.vtu"
    meshio.write(path, meshio.Mesh(np.eye(3), [("triangle", [[0, 1, 2]])]))
    with pytest.raises(MeshError, match="got no solid cells but 1 tri3; mesh the volume"):
        read_mesh(path)


def one_tet(**changes):
    fields = {
        "points": np.vstack([np.zeros(3), np.eye(3)]),
        "cells": {"tet4": np.array([[0, 1, 2, 3]])},
        "node_ids": np.array([10, 20, 30, 40]),
        "node_sets": {"tip": np.array([3])},
        "cell_sets": {"all": {"tet4": np.array([0])}},
    }
    return Mesh(**{**fields, **changes})


def test_bounds():
    mesh = one_tet(points=np.array([[0, 0, -1], [2, 0, 0], [0, 3, 0], [0, 0, 5.0]]))
    assert mesh.bounds.tolist() == [[0, 0, -1], [2, 3, 5]]
    assert mesh.diagonal == pytest.approx(7.0)  # √(2² + 3² + 6²)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"points": np.zeros((4, 2))}, r"got points \(4, 2\)"),
        (
            {"points": np.vstack([np.eye(3), [0, 0, np.nan]])},
            "1 nodes have coordinates that are not finite.*node 40",
        ),
        (
            {"cells": {"tet4": np.array([[0, 1, 2, 4]])}},
            r"tet4 cell 1 names nodes \[0, 1, 2, 4\]; expected 0 to 3",
        ),
        ({"cells": {"tet4": np.array([[0, 1, 2, -1]])}}, "tet4 cell 1 names nodes"),
        ({"cells": {"tet4": np.array([[0, 1, 2, 1]])}}, "1 degenerate tet4 cells.*nodes 10, 20, 30, 20"),
        (
            {"cells": {"tet10": np.array([[0, 1, 2, 3]])}},
            r"tet10: got cells of shape \(1, 4\); expected \(c, 10\)",
        ),
        ({"cells": {"brick": np.array([[0, 1, 2, 3]])}}, "family 'brick'; expected one of tet4, "),
        ({"cells": {}}, "got no solid cell"),
        ({"node_sets": {"tip": np.array([3, 1])}}, "node set 'tip': expected sorted unique rows"),
        ({"cell_sets": {"all": {"tet4": np.array([1])}}}, "cell set 'all' 'tet4': expected"),
    ],
)
def test_mesh_mistakes(changes, message):
    assert one_tet().cells["tet4"].shape == (1, 4)
    with pytest.raises(MeshError, match=message):
        one_tet(**changes)


def test_rows_of():
    ids = np.array([30, 10, 20])
    assert rows_of(np.array([[10, 20], [30, 15]]), ids).tolist() == [[1, 2], [0, -1]]
    assert rows_of(np.array([1]), np.zeros(0, np.int64)).tolist() == [-1]
