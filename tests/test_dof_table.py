"""Tables of DOFs in the layouts of the programs that write them."""

import re

import numpy as np
import pytest
from matrix_files import write_lines

from precompute.dof_table import read_dof_table
from precompute.errors import MatrixError


def test_csv(tmp_path):
    """Names or numbers for directions, columns in any order, a byte order mark as Excel writes it."""
    lines = ["\ufeffNode, Direction", "7,x", "7,RZ", "", "12, 2", "12,6"]
    table = read_dof_table(write_lines(tmp_path / "dofs.csv", lines), 4)
    assert table.node.tolist() == [7, 7, 12, 12]
    assert table.direction.tolist() == [0, 5, 1, 5]
    assert np.isnan(table.points).all()


def test_csv_with_coordinates(tmp_path):
    lines = ["x,y,z,node,direction", "1.5,0,-2e3,7,x", ",,,8,x"]
    table = read_dof_table(write_lines(tmp_path / "dofs.csv", lines), 2)
    assert table.points[0].tolist() == [1.5, 0.0, -2000.0]
    assert np.isnan(table.points[1]).all()


def test_calculix(tmp_path):
    """node.direction is no decimal number: 10.1 is node 10, and 2.10 would be direction 10."""
    table = read_dof_table(write_lines(tmp_path / "job.dof", ["1.1", "10.1", "100.3"]), 3)
    assert table.node.tolist() == [1, 10, 100]
    assert table.direction.tolist() == [0, 0, 2]


def test_ansys_mapping(tmp_path):
    """Columns as HBMAT writes them, rows in the solver's order, supports left out."""
    lines = [
        "    Matrix Eqn          Node    DOF     ",
        "             1            18    UX  ",
        "             2            18    ROTZ",
        "             3             5    UY  ",
    ]
    table = read_dof_table(write_lines(tmp_path / "file.mapping", lines), 3)
    assert table.node.tolist() == [18, 18, 5]
    assert table.direction.tolist() == [0, 5, 1]


def test_ansys_nodal_vector(tmp_path):
    lines = ["%%MatrixMarket matrix array integer general ", "% Creator: ANSYS Inc", "2 1", "31", "3"]
    path = write_lines(tmp_path / "back.txt", lines)
    assert read_dof_table(path, 6).node.tolist() == [31, 31, 31, 3, 3, 3]
    assert read_dof_table(path, 12).direction.tolist() == [0, 1, 2, 3, 4, 5] * 2


@pytest.mark.parametrize(
    ("lines", "words"),
    [
        ([], "got the header '', expected node,direction[,x,y,z]"),
        (["7,x", "7,y"], "got the header '7,x', expected node,direction[,x,y,z]"),
        (["node,direction,x", "7,x,1", "7,y,1"], "got the header 'node,direction,x'"),
        (["node,direction", "7,x"], "got 1 rows, expected 2, those of the matrices; one line each"),
        (["node,direction", "7,x", "7,x"], "rows 1 and 2 are both node 7 x, expected each motion once"),
        (["node,direction", "7,x", "7,u"], "row 2: got direction 'u', expected x y z rx ry rz or 1 to 6"),
        (["node,direction", "7,x", "7,7"], "row 2: got degree of freedom 7 of node 7, expected 1 to 6"),
        (["node,direction", "7,x", "7,0"], "row 2: got degree of freedom 0 of node 7, expected 1 to 6"),
        (["node,direction", "7,x", "tip,y"], "row 2: got node 'tip', expected a number such as 17"),
        (["node,direction", "7,x", "0,y"], "got 1 nodes with numbers below 1, the first is 0"),
        (["node,direction", "7,x", "7"], "row 2: got 1 fields, expected 2: node,direction"),
        (["node,direction,x,y,z", "7,x,1,2,3", "7,y,1,2,e"], "row 2: got '7,y,1,2,e', expected numbers"),
        (["node,direction,x,y,z", "7,x,1,2,3", "7,y,1,2,inf"], "row 2: got '7,y,1,2,inf', expected numbers"),
        (["node,direction", "7,x", "9" * 20 + ",y"], "row 2: got node '99999999999999999999', expected"),
        (["node,direction", "7,x", "7," + "9" * 20], "row 2: got direction '99999999999999999999', expected"),
        (["node,direction", "7," + "x" * 200_000], "got no table (field larger than field limit"),
        (["7.1", "9" * 20 + ".2"], "line 2: got '99999999999999999999.2', expected node.direction"),
        (["7.1", "7,2"], "line 2: got '7,2', expected node.direction such as 21.3"),
        (["Matrix Eqn Node DOF", "1 7 UX", "2 7 TEMP"], "line 3: got DOF 'TEMP', expected one of UX, UY, UZ"),
        (["Matrix Eqn Node DOF", "1 7 UX", "3 7 UY"], "got equation numbers that do not run 1, 2, 3"),
        (["Matrix Eqn Node DOF", "1 7 UX", "2 " + "9" * 20 + " UY"], "line 3: got '2 99999999999999999999"),
        (["Matrix Eqn Node DOF", "1 7 UX", "2 UY"], "line 3: got '2 UY', expected equation, node, DOF"),
        (["%%MatrixMarket matrix array integer general", "2 1", "7", "8"], "got 2 nodes (2 1) for 2"),
        (["%%MatrixMarket matrix array integer general", "2 1", "a"], "got lines that are not one node"),
        (["%%MatrixMarket matrix array integer general", "1 1", "9" * 20], "got lines that are not one node"),
        (["%%MatrixMarket matrix array integer general"], "got 0 nodes (no size) for 2 rows"),
    ],
)  # fmt: skip
def test_bad_tables(tmp_path, lines, words):
    path = write_lines(tmp_path / "dofs", lines)
    with pytest.raises(MatrixError, match=re.escape(words)) as caught:
        read_dof_table(path, 2)
    assert "\n" not in str(caught.value)
