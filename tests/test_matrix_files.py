"""Files of one matrix: what each layout means, and what is wrong with a damaged one."""

import logging
import re
from pathlib import Path

import numpy as np
import pytest
import scipy.sparse
from matrix_files import write_lines
from scipy.sparse import csr_array

from precompute.errors import MatrixError
from precompute.matrix_entries import Entries
from precompute.number_lines import precision
from precompute.read_matrix import read_matrix
from precompute.rounding import EPS
from precompute.symmetric_matrix import symmetric_matrix

A = [[4.0, -1.0, 0.0], [-1.0, 3.0, -2.0], [0.0, -2.0, 5.0]]
MARKET = "%%MatrixMarket matrix coordinate real"


def matrix(path: Path) -> np.ndarray:
    return symmetric_matrix(read_matrix(path), path.name).toarray()


@pytest.fixture
def notices(caplog):
    caplog.set_level(logging.INFO, "modalfmu")
    return caplog


def test_matrix_market(tmp_path):
    """The coordinate example of its format: comments, then the size, then entries."""
    path = write_lines(
        tmp_path / "a.mtx",
        [
            f"{MARKET} symmetric",
            "% a comment",
            "",
            "3 3 5",
            "1 1 4",
            "2 1 -1",
            "2 2 3.0",
            "3 2 -2e0",
            "3 3 5",
        ],
    )
    assert matrix(path).tolist() == A


def test_matrix_market_array_goes_by_columns(tmp_path):
    lower = ["%%MatrixMarket matrix array real symmetric", "3 3", "4", "-1", "0", "3", "-2", "5"]
    assert matrix(write_lines(tmp_path / "a.mtx", lower)).tolist() == A
    whole = ["%%MatrixMarket matrix array real general", "3 3", *(str(a) for row in A for a in row)]
    assert matrix(write_lines(tmp_path / "b.mtx", whole)).tolist() == A


def test_symmetric_header_over_both_triangles(tmp_path):
    """Against the standard, but written by careless exporters; mirrored once more it would be doubled."""
    both = [f"{i + 1} {j + 1} {A[i][j]}" for i in range(3) for j in range(3) if A[i][j]]
    path = write_lines(tmp_path / "a.mtx", [f"{MARKET} symmetric", "3 3 7", *both])
    assert matrix(path).tolist() == A


def test_abaqus_matrix_input_in_any_order_of_nodes(tmp_path, notices):
    """Keywords Guide, *MATRIX INPUT; the triangle is one of the program's order, here 30, 7, 12."""
    path = write_lines(
        tmp_path / "job_STIF1.mtx",
        ["30,2, 30,2,  4.000000000000000e+00", "7,2, 30,2, -1.000000000000000e+00",
         "7,2, 7,2,  3.000000000000000e+00", "12,2, 7,2, -2.000000000000000e+00",
         "12,2, 12,2,  5.000000000000000e+00"],
    )  # fmt: skip
    entries = read_matrix(path)
    assert entries.labels.node.tolist() == [7, 12, 30]
    assert entries.labels.direction.tolist() == [1, 1, 1]
    order = [2, 0, 1]
    assert symmetric_matrix(entries, "").toarray()[np.ix_(order, order)].tolist() == A
    assert notices.messages == []


def test_labels_with_blanks_for_commas(tmp_path):
    path = write_lines(tmp_path / "a.mtx", ["1 1 1 1 4.0", "2 1 1 1 -1.0", "2 1 2 1 3.0"])
    assert matrix(path).tolist() == [[4, -1], [-1, 3]]


def test_fortran_exponents(tmp_path):
    path = write_lines(tmp_path / "a.sti", ["1 1  4.0D+00", "1 2 -1.0D+00", "2 2 3.0D+00"])
    assert matrix(path).tolist() == [[4, -1], [-1, 3]]


def test_one_triangle_is_completed_and_said(tmp_path, notices):
    path = write_lines(tmp_path / "a.mtx", ["1 1 4", "1 2 -1", "2 2 3", "2 3 -2", "3 3 5"])
    assert matrix(path).tolist() == A
    assert notices.messages == ["a.mtx holds one triangle; the other was taken as its mirror image"]


@pytest.mark.parametrize("layout", ["csr", "csc", "coo"])
def test_npz(tmp_path, layout):
    scipy.sparse.save_npz(tmp_path / "a.npz", csr_array(np.triu(A)).asformat(layout))
    assert matrix(tmp_path / "a.npz").tolist() == A


def test_npz_of_single_precision(tmp_path):
    scipy.sparse.save_npz(tmp_path / "a.npz", csr_array(np.array(A, dtype=np.float32)))
    assert read_matrix(tmp_path / "a.npz").precision == np.finfo(np.float32).eps


def test_repeated_entries_are_added_in_triplet_files(tmp_path, notices):
    """Unassembled cells, as SciPy and MATLAB take them."""
    path = write_lines(
        tmp_path / "a.mtx", [f"{MARKET} general", "2 2 5", "1 1 1", "1 1 3", "1 2 -1", "2 1 -1", "2 2 3"]
    )
    assert matrix(path).tolist() == [[4, -1], [-1, 3]]
    assert notices.messages == ["a.mtx: 1 entries are listed more than once; they were added up"]


def test_entries_of_rounding_need_no_mirror(tmp_path):
    """1e-12 of the diagonals or less is the rounding of sums, on whichever side it is listed."""
    lines = ["1 1 4e9", "1 2 -1e9", "2 1 -1e9", "2 2 3e9", "2 3 1e-4", "3 3 5e9"]
    assert matrix(write_lines(tmp_path / "a.mtx", lines))[0, 1] == -1e9
    lines[4] = "2 3 1e0"
    with pytest.raises(MatrixError, match="without A_ji"):
        matrix(write_lines(tmp_path / "b.mtx", lines))


@pytest.mark.parametrize(("digits", "symmetric"), [(9, True), (10, False)])
def test_symmetry_is_judged_by_the_digits_printed(tmp_path, digits, symmetric):
    """The same difference of 1e-8 is one unit of the last of 9 digits, but ten units of the last of 10."""
    form = f"{{}} {{}} {{:.{digits - 1}e}}"
    values = [(1, 1, 4.0), (1, 2, -1.0), (2, 1, -1.00000001), (2, 2, 3.0)]
    path = write_lines(tmp_path / "a.mtx", [form.format(*value) for value in values])
    if symmetric:
        A = matrix(path)
        assert A[0, 1] == A[1, 0] == pytest.approx(-1.000000005, rel=1e-15)
    else:
        with pytest.raises(MatrixError, match=r"not symmetric: row 1, column 2 is -1, its mirror image"):
            matrix(path)


@pytest.mark.parametrize(
    ("number", "digits"),
    [("1.0320512820513e+06", 14), ("2.613069800570034E+010", 16), ("0.00123456", 6), ("-12345.60", 7)],
)
def test_precision(tmp_path, number, digits):
    """Half a unit of the last digit, beside that of double precision; short numbers are exact."""
    path = write_lines(tmp_path / "a.mtx", ["1 1 200", "2 2 0.00000000", f"3 3 {number}"])
    assert precision(path) == EPS + 0.5 * 10.0 ** (1 - digits)
    exact = write_lines(tmp_path / "b.mtx", ["1 1 200", "2 2 0.5"])
    assert precision(exact) == EPS


BAD = [
    (["%%MatrixMarket matrix coordinate complex symmetric", "1 1 1", "1 1 1 0"], "a complex symmetric"),
    (["%%MatrixMarket matrix coordinate pattern general", "1 1 1", "1 1"], "a pattern general matrix"),
    (["%%MatrixMarket vector", "1 1 1"], "got the header '%%matrixmarket vector'"),
    ([f"{MARKET} general", "3 1 2", "1 1 1", "2 1 1"], "got a 3 × 1 matrix, expected a square one"),
    ([f"{MARKET} general", "3 3"], "got '3 3' where the size is expected; is the file cut off?"),
    ([f"{MARKET} general", "2 2 3", "1 1 1", "2 2 1"], "got 2 entries, expected 3 of row, column, value"),
    ([f"{MARKET} general", "2 2 2", "1 1 1", "3 2 1"], "got entries outside rows and columns 1 to 2"),
    ([f"{MARKET} general", "2 2 2"], "got no entries; export the matrix again"),
    (["%%MatrixMarket matrix array real general", "2 2", "1", "2", "3"], "got 3 entries, expected 4"),
    (["1 1 4.0", "2 1"], "got the line '2 1', expected 3 numbers as in the first line"),
    (["1 1 4.0", "2 1 abc"], "got the line '2 1 abc', expected 3 numbers"),
    (["stiffness matrix", "1 1 4"], "got the line 'stiffness matrix', expected a matrix: Matrix"),
    (["0 1 4.0"], "got rows or columns below 1"),
    (["1.5 1 4.0"], "got 1.5 for a row, node or degree of freedom, expected a whole number"),
    (["1 1 nan", "2 2 1"], "got nan in row 1, column 1, expected finite numbers; 1 of 2 entries are not"),
    (["1 1 4", "2 2 inf"], "got inf in row 2, column 2, expected finite numbers; 1 of 2 entries are not"),
    (["1 1 0", "2 2 0.0"], "got zeros only"),
    (["1 1 1e300", "2 2 1"], "got entries up to 1e+300, expected 1e-100 to 1e+100"),
    (["1 1 1e-300", "2 2 0"], "got entries up to 1e-300, expected 1e-100 to 1e+100"),
    (["1 1 1.0", "1e30 1 2.0"], "got 1e+30 for a row, node or degree of freedom, expected a whole number"),
    (["1 1 1.0", "1 1_0 2.0"], "got lines that are not all numbers (could not convert string '1_0'"),
    (["%%MatrixMarket matrix array real general", "3000000 3000000", "1"], "got 1 entries, expected 9000000"),
    (["1 1 4", "1 2 -1", "2 1 -1", "2 2 3", "2 3 -2", "3 3 5"], "got 1 entries A_ij without A_ji and 2"),
    (["1 1 4", "1 2 -1", "2 1 -1.5", "2 2 3"], "not symmetric: row 1, column 2 is -1, its mirror image -1.5"),
    (["1 1 4", "2 2 3", "2 2 3"], "1 entries are listed more than once, the first is row 2, column 2"),
    (["1,1, 1,1, 4", "-3,1, -3,1, 4"], "got 1 nodes with numbers below 1, the first is -3"),
    (["1,11, 1,11, 4.0"], "row 1: got degree of freedom 11 of node 1, expected 1 to 6"),
    (["1, 1,1, 1,1, 4.0"], "got matrices of single elements; leave ELEMENT BY ELEMENT out"),
    (["1 2 3 4"], "got 4 numbers per line ('1 2 3 4'), expected row column value, or"),
    (["** of a job", "*MATRIX,TYPE=STIFFNESS", "1,2"], "got keywords instead of entries; write"),
    ([], "got no entries; export the matrix again"),
]  # fmt: skip


@pytest.mark.parametrize(("lines", "words"), BAD, ids=[words[:30] for _, words in BAD])
def test_bad_text(tmp_path, lines, words):
    path = write_lines(tmp_path / "K.mtx", lines)
    with pytest.raises(MatrixError, match=re.escape(words)) as caught:
        matrix(path)
    assert "\n" not in str(caught.value)


def test_comments_before_the_entries(tmp_path):
    """Two asterisks are a comment in Abaqus's files, one is a keyword."""
    lines = ["** Stiffness of a job", "1,1, 1,1, 4.0", "1,2, 1,2, 3.0"]
    assert matrix(write_lines(tmp_path / "a.mtx", lines)).tolist() == [[4.0, 0.0], [0.0, 3.0]]


def test_missing_file_and_folder(tmp_path):
    with pytest.raises(MatrixError, match=r"^K.mtx: no such file in "):
        read_matrix(tmp_path / "K.mtx")
    with pytest.raises(MatrixError, match=r"cannot be read \("):
        read_matrix(tmp_path)


def npz(path: Path, **changed: object) -> Path:
    """The arrays of save_npz(csr_array(A)), some changed, None left out."""
    good = csr_array(np.array(A))
    arrays = {
        "format": b"csr",
        "shape": good.shape,
        "data": good.data,
        "indices": good.indices,
        "indptr": good.indptr,
    }
    arrays |= changed
    np.savez(path, **{key: np.asanyarray(value) for key, value in arrays.items() if value is not None})
    return path


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"indices": [0, 1, 0, 1, 2, 1, 3]}, "got indices outside 0 to 2"),
        ({"indices": [0, 1, 0, 1, 2, 1, -1]}, "got indices outside 0 to 2"),
        ({"indices": [0, 1, 0]}, "not one per entry"),
        ({"indices": [0.5] * 7}, "got indices or indptr that is no row of whole numbers"),
        ({"indptr": [0, 5, 2, 7]}, "got indptr that does not lead from 0 to 7 in 3 steps"),
        ({"indptr": [0, 2, 5]}, "got indptr that does not lead from 0 to 7 in 3 steps"),
        ({"indptr": None}, "got the arrays data, format, indices, shape of layout 'csr'"),
        ({"format": b"bsr"}, "of layout 'bsr', expected those of a sparse matrix in csr, csc, coo"),
        ({"shape": (3, 4)}, "got a 3 × 4 matrix, expected a square one"),
        ({"data": np.ones(7) * 1j}, "got entries of type complex128"),
        ({"data": np.array([None] * 7)}, "got no readable .npz file"),  # pickled: never loaded
    ],
)
def test_bad_npz(tmp_path, changed, words):
    with pytest.raises(MatrixError, match=re.escape(words)) as caught:
        read_matrix(npz(tmp_path / "a.npz", **changed))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("size", [200, 700])
def test_npz_cut_off(tmp_path, size):
    """An archive whose table of contents is gone is still told as one, not as a line of strange text."""
    path = npz(tmp_path / "a.npz")
    assert isinstance(read_matrix(path), Entries)
    path.write_bytes(path.read_bytes()[:size])
    with pytest.raises(MatrixError, match=r"^a.npz: got no readable .npz file \("):
        read_matrix(path)


def test_npz_with_any_byte_wrong(tmp_path):
    """zipfile, zlib and NumPy each have errors of their own; all are told as one mistake, or do no harm."""
    path = tmp_path / "a.npz"
    scipy.sparse.save_npz(path, csr_array(np.array(A)))
    whole = path.read_bytes()
    rng, refused = np.random.default_rng(0), 0
    for place in range(len(whole)):
        damaged = bytearray(whole)
        damaged[place] ^= int(rng.integers(1, 256))
        path.write_bytes(damaged)
        try:
            read_matrix(path)
        except MatrixError:
            refused += 1
    assert refused > len(whole) // 2  # bytes of times and attributes do not matter
