"""Abaqus and CalculiX decks as people write them."""

import gzip
import logging
from pathlib import Path

import numpy as np
import pytest

from precompute.deck import read_deck
from precompute.elements import INTERPOLATIONS
from precompute.errors import MeshError
from precompute.read_mesh import read_mesh

CUBE = """*Heading
 two cubes, one above the other
*NODE, NSET=Nall
10, 0., 0., 0.
11, 1., 0., 0.
12, 1., 1., 0.
13, 0., 1., 0.
20, 0., 0., 1.
21, 1., 0., 1.
22, 1., 1., 1.
23, 0., 1., 1.
30, 0., 0., 2.
31, 1., 0., 2.
32, 1., 1., 2.
33, 0., 1., 2.
*ELEMENT, TYPE=C3D8, ELSET=lower
5, 10, 11, 12, 13, 20, 21, 22, 23
*ELEMENT, TYPE=C3D8R, ELSET=upper
7, 20, 21, 22, 23, 30, 31, 32, 33
"""


CALCULIX = Path("/usr/share/doc/calculix-ccx-test/examples/test")


def mesh_of(tmp_path: Path, text: str, **files: str):
    for name, content in files.items():
        (tmp_path / f"{name}.inc").write_text(content)
    path = tmp_path / "deck.inp"
    path.write_text(text)
    return read_mesh(path)


def ids_of(mesh, name):
    return mesh.node_ids[mesh.node_sets[name]].tolist()


def test_two_cubes(tmp_path):
    mesh = mesh_of(tmp_path, CUBE)
    assert mesh.node_ids.tolist() == [10, 11, 12, 13, 20, 21, 22, 23, 30, 31, 32, 33]
    assert mesh.points[7].tolist() == [0, 1, 1]
    assert mesh.cells["hex8"].tolist() == [list(range(8))]
    assert mesh.cells["hex8r"].tolist() == [list(range(4, 12))]
    assert mesh.cell_sets == {"lower": {"hex8": [0]}, "upper": {"hex8r": [0]}}
    assert ids_of(mesh, "Nall") == mesh.node_ids.tolist()


def numbered(values, width):
    """Numbers in lines of `width`, each but the last ending in a comma."""
    lines = [", ".join(map(str, values[i : i + width])) for i in range(0, len(values), width)]
    return ",\n".join(lines) + "\n"


@pytest.mark.parametrize(
    ("kind", "family"),
    [
        ("C3D4", "tet4"),
        ("C3D10", "tet10"),
        ("C3D8", "hex8"),
        ("C3D8R", "hex8r"),
        ("C3D20", "hex20"),
        ("C3D20R", "hex20r"),
        ("C3D6", "wedge6"),
    ],
)
@pytest.mark.parametrize("width", [4, 11, 16, 99])
def test_types_and_lines_that_go_on(tmp_path, kind, family, width):
    reference = INTERPOLATIONS[family.rstrip("r")].nodes
    k = len(reference)
    nodes = "".join(f"{i + 1}, {x:.6f}, {y:.6f}, {z:.6f}\n" for i, (x, y, z) in enumerate(reference))
    cells = [[cell, *range(1, k + 1)] for cell in (3, 8)]
    with_commas = "".join(numbered(cell, width) for cell in cells)
    without = with_commas.replace(",\n", "\n")
    for text in (with_commas, without):
        mesh = mesh_of(tmp_path, f"*node\n{nodes}*Element, type = {kind.lower()}\n{text}")
        assert mesh.cells[family].tolist() == [list(range(k))] * 2
        assert np.allclose(mesh.points, reference, atol=1e-6)  # as many digits as were written


def test_forms_of_numbers_and_comments(tmp_path):
    text = (
        '** by hand\n\n*Node , nset = "All nodes"\n 1, 1.0D+00, -2.5d-1, 3.\n\n** next\n2,1,0,0,\n'
        "3, .5E0, 1\n4 ,0,,1\n5, 9, 9, 9, 0.0, 0.0, 1.0\n*ELEMENT,TYPE=C3D4\n\t1,1,2,3,4\n"
        "*step\n*node file\nU\n*end step\n"
    )
    mesh = mesh_of(tmp_path, text.replace("\n", "\r\n"))
    assert mesh.points.tolist() == [[1, -0.25, 3], [1, 0, 0], [0.5, 1, 0], [0, 0, 1]]
    assert ids_of(mesh, "All nodes") == [1, 2, 3, 4]


def test_sets(tmp_path):
    text = CUBE + (
        "*NSET, NSET=Base, UNSORTED\n13, 12,\n11, 10\n"
        "*nset, nset=even, generate\n10, 32, 2\n20, 23\n"
        "*Nset, Nset=both\nBASE, 33,\n"
        "*NSET, NSET=base\n20\n"
        "*ELSET, ELSET=All\nlower, UPPER\n"
        "*ELSET, ELSET=first, GENERATE\n1, 6\n"
        "*NSET, NSET=of upper, ELSET=Upper\n"
    )
    mesh = mesh_of(tmp_path, text)
    assert ids_of(mesh, "Base") == [10, 11, 12, 13, 20]  # the second *NSET adds to it
    assert ids_of(mesh, "even") == [10, 12, 20, 21, 22, 23, 30, 32]
    assert ids_of(mesh, "both") == [10, 11, 12, 13, 33]
    assert ids_of(mesh, "of upper") == [20, 21, 22, 23, 30, 31, 32, 33]
    assert mesh.cell_sets["All"] == {"hex8": [0], "hex8r": [0]}
    assert mesh.cell_sets["first"] == {"hex8": [0]}


def test_sets_that_name_what_is_not_there(tmp_path, caplog):
    caplog.set_level(logging.INFO, "modalfmu")
    mesh = mesh_of(
        tmp_path,
        CUBE
        + "*NSET, NSET=some\n10, 999\n*NSET, NSET=none\n998\n*ELSET, ELSET=e\n5, 99\n*ELSET, ELSET=f\n98\n",
    )
    assert ids_of(mesh, "some") == [10]
    assert ids_of(mesh, "none") == ids_of(mesh, "f") == []  # names stay, so that a selection can say why
    assert mesh.cell_sets["e"] == {"hex8": [0]}
    assert caplog.messages == [
        "set 'e' names 1 elements that the deck does not have; they are passed over",
        "set 'f' names 1 elements that the deck does not have; they are passed over",
        "set 'some' names 1 nodes that the deck does not have; they are passed over",
        "set 'none' names 1 nodes that the deck does not have; they are passed over",
    ]


@pytest.mark.parametrize(
    ("family", "kind", "plane"),
    [
        (
            "hex8",
            "C3D8",
            {"S1": (2, 0), "S2": (2, 1), "S3": (1, 0), "S4": (0, 1), "S5": (1, 1), "S6": (0, 0)},
        ),
        (
            "hex20",
            "C3D20",
            {"S1": (2, 0), "S2": (2, 1), "S3": (1, 0), "S4": (0, 1), "S5": (1, 1), "S6": (0, 0)},
        ),
        ("tet4", "C3D4", {"S1": (2, 0), "S2": (1, 0), "S4": (0, 0)}),
        ("tet10", "C3D10", {"S1": (2, 0), "S2": (1, 0), "S4": (0, 0)}),
        ("wedge6", "C3D6", {"S1": (2, 0), "S2": (2, 1), "S3": (1, 0), "S5": (0, 0)}),
    ],
)
def test_surfaces_of_element_faces(tmp_path, family, kind, plane):
    """Face i of the reference cell lies in the plane x_axis = value (Abaqus, "Element faces")."""
    reference = INTERPOLATIONS[family].nodes
    nodes = "".join(f"{i + 1}, {x:.6f}, {y:.6f}, {z:.6f}\n" for i, (x, y, z) in enumerate(reference))
    cell = numbered([1, *range(1, len(reference) + 1)], 12)
    surfaces = "".join(f"*SURFACE, NAME=face {face}\none, {face}\n" for face in plane)
    mesh = mesh_of(tmp_path, f"*NODE\n{nodes}*ELEMENT, TYPE={kind}, ELSET=one\n{cell}{surfaces}")
    for face, (axis, value) in plane.items():
        on_plane = np.flatnonzero(abs(reference[:, axis] - value) < 1e-12)
        assert mesh.node_sets[f"face {face}"].tolist() == on_plane.tolist(), face


def test_surfaces(tmp_path, caplog):
    caplog.set_level(logging.INFO, "modalfmu")
    text = CUBE + (
        "*NSET, NSET=top\n30,31,32,33\n*SURFACE, NAME=nodes, TYPE=NODE\ntop, 1.\n20, 1.\n"
        "*SURFACE, TYPE=ELEMENT, NAME=faces\nLOWER, S1\n7, s2\n"
        "*SURFACE, NAME=free\nupper,\n"
    )
    mesh = mesh_of(tmp_path, text)
    assert ids_of(mesh, "nodes") == [20, 30, 31, 32, 33]
    assert ids_of(mesh, "faces") == [10, 11, 12, 13, 30, 31, 32, 33]
    assert "free" not in mesh.node_sets
    assert caplog.messages == [
        "line 28: surface 'free' is left out, it is not made of nodes or element faces"
    ]


def test_shells_are_left_out_but_their_sets_stay(tmp_path, caplog):
    caplog.set_level(logging.INFO, "modalfmu")
    text = CUBE + (
        "*NODE\n90, 5., 5., 5.\n*ELEMENT, TYPE=S4, ELSET=skin\n50, 10, 11, 12, 13\n"
        "*ELEMENT, TYPE=B31\n60, 30, 90\n*ELEMENT, TYPE=MASS, ELSET=m\n70, 90\n"
    )
    mesh = mesh_of(tmp_path, text)
    assert ids_of(mesh, "skin") == [10, 11, 12, 13]
    assert ids_of(mesh, "m") == []
    assert 90 not in mesh.node_ids
    assert caplog.messages == [
        "cells left out, not solid: 1 S4, 1 B31, 1 MASS",
        "nodes dropped, in no solid cell: 1",
    ]


@pytest.mark.parametrize(("kind", "family"), [("C3D8I", "hex8"), ("C3D8H", "hex8"), ("C3D8RT", "hex8r")])
def test_variants_are_told(tmp_path, caplog, kind, family):
    caplog.set_level(logging.INFO, "modalfmu")
    mesh = mesh_of(tmp_path, CUBE.replace("C3D8,", f"{kind},"))
    assert len(mesh.cells[family]) == (2 if family == "hex8r" else 1)
    assert caplog.messages == [f"line 16: {kind} is taken as {family}"]


CAE = """*Heading
*Part, name=Beam
{mesh}*Nset, nset=Set-1
 30, 31
*Elset, elset=Set-1
 5,
*End Part
*Assembly, name=Assembly
*Instance, name=Beam-1, part=Beam
{move}*End Instance
*Node
 10, 7., 7., 7.
*Nset, nset=reference
 10,
*Nset, nset=Set-1, instance=Beam-1
 10, 11, 12, 13
*Nset, nset=qualified
 Beam-1.Nall,
*Elset, elset=_face_S2, internal, instance=Beam-1
 7,
*Surface, type=ELEMENT, name=face
_face_S2, S2
*End Assembly
*Material, name=steel
"""
MESH = CUBE[CUBE.index("*NODE") :]


def test_part_and_assembly(tmp_path, caplog):
    caplog.set_level(logging.INFO, "modalfmu")
    mesh = mesh_of(tmp_path, CAE.format(mesh=MESH, move="0., 0., 0.\n0., 0., 0., 0., 0., 1., 0.\n"))
    assert mesh.points[0].tolist() == [0, 0, 0]  # not the assembly's reference point of the same number
    assert ids_of(mesh, "Set-1") == [10, 11, 12, 13]  # the assembly's, which loads and supports name
    assert mesh.cell_sets["Set-1"] == {"hex8": [0]}  # the part's, which sections name
    assert ids_of(mesh, "qualified") == mesh.node_ids.tolist()
    assert ids_of(mesh, "face") == [30, 31, 32, 33]
    assert ids_of(mesh, "reference") == []
    assert caplog.messages == ["line 34: the assembly's set 'Set-1' hides the part's set of that name"]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            lambda text: text.replace("{move}", "0., 0., 3.\n"),
            "line 26: the instance is translated or rotated",
        ),
        (
            lambda text: text.replace("{move}", "0., 0., 0.\n0., 0., 0., 0., 0., 1., 90.\n"),
            "line 26: the instance is translated or rotated",
        ),
        (
            lambda text: text.replace("*Assembly", "*Part, name=Two\n*End Part\n*Assembly"),
            r"line 25: got a second \*PART",
        ),
        (
            lambda text: text.replace("*End Assembly", "*Instance, name=B-2, part=Beam\n*End Instance"),
            r"line 40: got a second \*INSTANCE",
        ),
    ],
)
def test_parts_that_are_refused(tmp_path, change, message):
    text = change(CAE).replace("{mesh}", MESH).replace("{move}", "")
    with pytest.raises(MeshError, match=message):
        mesh_of(tmp_path, text)


def test_include(tmp_path):
    nodes, elements = CUBE[CUBE.index("10, 0") :].split("*ELEMENT", 1)
    text = '*NODE\n*INCLUDE, INPUT=nodes.inc\n*include,input="elements.inc"\n*NSET,NSET=A,INPUT=a.inc\n'
    mesh = mesh_of(tmp_path, text, nodes=nodes, elements="*ELEMENT" + elements, a="10,\n30\n")
    assert len(mesh.points) == 12
    assert ids_of(mesh, "A") == [10, 30]


def test_include_mistakes(tmp_path):
    with pytest.raises(MeshError, match=r"cannot read .*gone\.inc: No such file"):
        mesh_of(tmp_path, "*INCLUDE, INPUT=gone.inc\n")
    with pytest.raises(MeshError, match=r"loop\.inc includes itself"):
        mesh_of(tmp_path, "*INCLUDE, INPUT=loop.inc\n", loop="*INCLUDE, INPUT=loop.inc\n")
    with pytest.raises(MeshError, match=r"line 2: expected \*INCLUDE, INPUT=file"):
        mesh_of(tmp_path, CUBE.replace("\n", "\n*INCLUDE\n", 1))
    with pytest.raises(
        MeshError, match=r"deck\.inp: bad\.inc line 2: expected a node: id, x, y, z, got '2, zero'"
    ):
        mesh_of(tmp_path, "*NODE\n*INCLUDE, INPUT=bad.inc\n", bad="1, 0, 0, 0\n2, zero\n")


def test_keyword_that_goes_on(tmp_path):
    mesh = mesh_of(tmp_path, CUBE.replace("*ELEMENT, TYPE=C3D8R, ", "*ELEMENT, TYPE=C3D8R,\n "))
    assert mesh.cell_sets["upper"] == {"hex8r": [0]}


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "5, 10, 11, 12,",
            "5, 10, 11,",
            r"line 17: element 5 of type C3D8 has 7 nodes, expected 8; is the file cut",
        ),
        (
            "5, 10, 11, 12,",
            "5, 10, 11, 12, 12,",
            "line 17: element 5 of type C3D8 has 9 nodes, expected 8; is the type",
        ),
        (
            "7, 20, 21, 22,",
            "7, 20, 21, 99,",
            r"line 18: element 7 names node 99, which the deck does not define",
        ),
        ("7, 20, 21, 22,", "7, 20, 21, 2o,", r"line 19: expected C3D8R: id and 8 nodes, got '7, 20, 21, 2o"),
        ("7, 20, 21, 22,", "7, 20, 21, 20,", "1 degenerate hex8r cells"),
        ("7, 20", "5, 20", "element 5 is defined twice"),
        ("11, 1., 0., 0.", "11, 1., O., 0.", "line 5: expected a node: id, x, y, z, got '11, 1., O., 0.'"),
        ("11, 1., 0., 0.", "11.5, 1., 0., 0.", "line 5: expected a node"),
        ("11, 1., 0., 0.", "nan, 1., 0., 0.", "line 5: expected a node"),
        (
            "11, 1., 0., 0.",
            "11, 1., inf, 0.",
            "1 nodes have coordinates that are not finite, the first is node 11",
        ),
        (
            "11, 1., 0., 0.",
            "10, 1., 0., 0.",
            r"node 10 is defined at \[0.0, 0.0, 0.0\] and \[1.0, 0.0, 0.0\]",
        ),
        ("*NODE,", "*NODE, SYSTEM=C,", r"line 3: \*NODE has SYSTEM=C; write rectangular coordinates"),
        ("TYPE=C3D8,", "", r"line 16: \*ELEMENT without a type"),
        ("TYPE=C3D8,", "TYPE=C3D15,", "line 16: C3D15 elements cannot be integrated"),
        ("TYPE=C3D8,", "TYPE=COH3D8,", "line 16: COH3D8 elements cannot be integrated"),
        ("*ELEMENT", "*NGEN\n10, 13\n*ELEMENT", r"line 16: \*NGEN is not carried out"),
        ("*ELEMENT", "*NSET\n10\n*ELEMENT", r"line 16: \*NSET without a name"),
        ("*ELEMENT", "*NSET, NSET=a\nb\n*ELEMENT", r"line 17: got the set 'b', which is not defined above"),
        ("*ELEMENT", "*NSET, NSET=a\n1 2\n*ELEMENT", "line 17: expected numbers, got '1 2'"),
        (
            "*ELEMENT",
            "*NSET, NSET=a, GENERATE\n10\n*ELEMENT",
            "line 17: expected first, last, step of GENERATE",
        ),
        (
            "*ELEMENT",
            "*NSET, NSET=a, GENERATE\n1,9,0\n*ELEMENT",
            "line 17: expected first, last, step of GENERATE",
        ),
    ],
)
def test_mistakes(tmp_path, old, new, message):
    assert old in CUBE
    with pytest.raises(MeshError, match=message) as caught:
        mesh_of(tmp_path, CUBE.replace(old, new, 1))
    assert str(caught.value).startswith("deck.inp: ")
    assert "\n" not in str(caught.value)


def test_every_cut_is_seen(tmp_path):
    """Wherever the deck ends before its last element is whole, but where an end could not be told from a cut.

    The last number is made 333 where nodes 3 and 33 exist too: cut inside it, the line still is an element.
    """
    text = CUBE.replace("33\n", "333\n").replace("\n33,", "\n333,")
    text = text.replace("*ELEMENT", "3, 9., 9., 9.\n33, 8., 8., 8.\n*ELEMENT", 1)
    first_is_whole = text.index("*ELEMENT, TYPE=C3D8R")
    assert len(mesh_of(tmp_path, text).cells["hex8r"]) == 1
    for end in range(len(text) - 1):
        if not first_is_whole <= end < first_is_whole + len("*ELEMENT"):
            with pytest.raises(MeshError):
                mesh_of(tmp_path, text[:end])


def test_a_deck_without_a_last_line_end_is_whole(tmp_path):
    assert len(mesh_of(tmp_path, CUBE.rstrip()).cells["hex8r"]) == 1


def test_many_nodes_are_read_as_one(tmp_path):
    """The quick way for plain lines and the slow one for all others agree."""
    points = np.random.default_rng(0).normal(size=(50, 3))
    lines = [f"{2 * i + 1}, {x!r}, {y!r}, {z!r}" for i, (x, y, z) in enumerate(points.tolist())]
    cells = "".join(f"{i}, {2 * i + 1}, {2 * i + 3}, {2 * i + 5}, {2 * i + 7}\n" for i in range(47))
    for end in ("\n", ",\n"):
        mesh = mesh_of(tmp_path, f"*NODE\n{end.join(lines)}\n*ELEMENT, TYPE=C3D4\n{cells}")
        assert np.array_equal(mesh.points, points)
        assert mesh.node_ids.tolist() == list(range(1, 100, 2))


@pytest.mark.skipif(not CALCULIX.is_dir(), reason="the decks of Debian's calculix-ccx-test are not installed")
def test_decks_of_calculix(tmp_path):
    """Each is a mesh or one clear refusal; beamdy1 is 32 C3D20R that fill 1 × 1.5 × 8."""
    path = tmp_path / "deck.inp"
    refused = []
    for deck in sorted(CALCULIX.glob("*.inp.gz")):
        path.write_bytes(gzip.decompress(deck.read_bytes()))
        try:
            mesh = read_mesh(path)
        except MeshError as error:
            refused.append(str(error))
            continue
        if deck.name == "beamdy1.inp.gz":
            assert {family: len(cells) for family, cells in mesh.cells.items()} == {"hex20r": 32}
            assert np.ptp(mesh.points, axis=0) == pytest.approx([1.0, 1.5, 8.0])
    known = ("got no solid cells but", "cannot be integrated", "is the type right?")
    assert [error for error in refused if not any(words in error for words in known)] == []


def test_raw_mesh_keeps_every_node(tmp_path):
    path = tmp_path / "deck.inp"
    path.write_text(CUBE + "*NODE\n1, 0., 0., 0.\n")
    assert read_deck(path).node_ids[-1] == 1
