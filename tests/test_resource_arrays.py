"""The arrays, their checksums right: both twins refuse what numpy.save did not write or no model has."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from driven import driven
from examples import two_ports
from model_files import HEADER, assert_read, assert_refused, files_of, saved, with_array, with_header

from fmu_src.runtime.model import row_starts


@pytest.mark.parametrize(
    "shape",
    [
        [],
        6,
        "6",
        [5],
        [7],
        [6, 1],
        [6.5],
        [-6],
        [0],
        [2**28],
        [2**28 + 1],
        [2**53],
        [1e300],
        [[6]],
        ["6"],
        [None],
        {"6": 6},
    ],
)
def test_shapes_that_do_not_fit(tmp_path: Path, shape: object) -> None:
    """2^28 modes would be 2^59 bytes of D_rest: nothing of that size is asked for."""
    files = files_of(two_ports())
    arrays = json.loads(files[HEADER])["arrays"]
    arrays["lam"]["shape"] = shape
    assert_refused(with_header(files, arrays=arrays), tmp_path, r"lam|D_rest|shape")


@pytest.mark.parametrize(
    ("modes", "reason"),
    [
        (16384, r"model/D_rest\.npy: its checksum|model/D_rest\.npy: got"),  # 2^31 bytes, the most
        (16385, "expected at most 2147483648 bytes"),
    ],
)
def test_enormous_shapes_whose_numbers_are_there_nowhere(tmp_path: Path, modes: int, reason: str) -> None:
    files = with_array(files_of(two_ports()), "lam", saved(np.zeros(modes)), [modes])
    arrays = json.loads(files[HEADER])["arrays"]
    arrays["D_rest"]["shape"] = [modes, modes]
    assert_refused(with_header(files, arrays=arrays), tmp_path, reason, r"^D_rest\.npy: ")


LAM = two_ports().lam
NPY = saved(LAM)


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"\x93NUMPY\x01\x00",
        b"PK\3\4 and more",
        NPY + b"\0",
        NPY + bytes(8),
        NPY[:-8],
        NPY[:-1],
        NPY[:6] + b"\2" + NPY[7:],  # version 2.0
        NPY[:8] + b"\xff\xff" + NPY[10:],  # a header longer than the file
        NPY[:8] + b"\x10\0" + NPY[10:],  # a header shorter than its text
        NPY[:8] + b"\x6e\0" + NPY[10:],  # the numbers begin among the spaces
        NPY[:8] + b"\x7e\0" + NPY[10:],  # or behind the newline
        NPY[:8] + b"\x7e\0" + NPY[10:] + bytes(8),  # so that as many numbers are left
        NPY[:127] + b" " + NPY[128:],  # no newline
        NPY[:126] + b"\n\n" + NPY[128:],  # two
        NPY[:126] + b"\t\n" + NPY[128:],
        NPY.replace(b"(6,)", b"(6, )"),
        NPY.replace(b"(6,)", b"(7,)"),
        NPY.replace(b"(6,), } ", b"(06,), }"),
        NPY.replace(b"(6,)", b"(6) "),
        NPY.replace(b"'<f8'", b"'>f8'"),
        NPY.replace(b"'<f8'", b"'<i8'"),
        NPY.replace(b"'<f8'", b"'|O' "),
        NPY.replace(b"False", b"True "),
        saved(LAM.astype(np.float32)),
        saved(LAM.astype(np.int64)),
        saved(LAM.reshape(6, 1)),
        saved(LAM.reshape(2, 3)),
        saved(np.array([{"a": 1}], dtype=object)),
        NPY.replace(b"'<f8'", b"print"),
    ],
)
def test_arrays_with_a_right_checksum_are_still_checked(tmp_path: Path, content: bytes) -> None:
    files = files_of(two_ports())
    assert content != NPY
    assert_read(with_array(files, "lam", NPY), tmp_path, two_ports())
    changed = with_array(files, "lam", content)
    assert_refused(
        changed, tmp_path, r"^model/lam\.npy: got \d+ bytes, expected", r"^lam\.npy: got \d+ bytes"
    )


@pytest.mark.parametrize("spaces", [0, 1, 7, 300])
def test_headers_of_any_length(tmp_path: Path, spaces: int) -> None:
    """Then the numbers need not begin at a multiple of eight bytes."""
    text = NPY[10:128].rstrip() + b" " * spaces + b"\n"
    content = NPY[:8] + len(text).to_bytes(2, "little") + text + NPY[128:]
    assert_read(with_array(files_of(two_ports()), "lam", content), tmp_path, two_ports())


def changed(array: Any, place: Any, value: float) -> Any:
    copy = array.copy()
    copy[place] = value
    return copy


@pytest.mark.parametrize(
    ("key", "array"),
    [
        *(("lam", changed(LAM, k, value)) for k in (0, 5) for value in (np.nan, np.inf)),
        ("lam", changed(LAM, 0, -1e-300)),
        ("lam", changed(LAM, 3, 29.999)),
        ("lam", changed(LAM, 5, -np.inf)),
        *(("B", changed(two_ports().B, (5, 2), value)) for value in (np.nan, np.inf, -np.inf)),
        *(("C", changed(two_ports().C, (4, 5), value)) for value in (np.nan, np.inf, -np.inf)),
        ("D_rest", changed(two_ports().D_rest, (5, 5), -1e-300)),
        ("D_rest", changed(two_ports().D_rest, (0, 5), 5e-324)),
        ("D_rest", changed(two_ports().D_rest, (5, 4), -5e-324)),
        ("D_rest", changed(two_ports().D_rest, (2, 1), np.nan)),
    ],
)
def test_numbers_that_no_model_has(tmp_path: Path, key: str, array: Any) -> None:
    files = with_array(files_of(two_ports()), key, saved(array))
    assert_refused(files, tmp_path, rf"^model/{key}\.npy: ", f"^{key}: ")


DRIVEN = driven()
THIRD = row_starts(DRIVEN.laws)[DRIVEN.outputs.index("left.reaction.y")] + 2


@pytest.mark.parametrize(
    ("key", "array"),
    [
        ("lam", changed(DRIVEN.lam, 2, 5e-324)),
        ("B", changed(DRIVEN.B, (0, 1), 0.5)),
        ("B", changed(DRIVEN.B, (2, 0), 1e-300)),
        ("B", DRIVEN.B[[1, 0, *range(2, len(DRIVEN.lam))]]),
        ("C", changed(DRIVEN.C, (THIRD, 3), 5e-324)),
        ("M_s", changed(DRIVEN.M_s, (0, 1), 7.0)),
        ("M_s", changed(DRIVEN.M_s, (0, 0), -1.0)),
        ("M_s", changed(DRIVEN.M_s, (2, 2), np.nan)),
        ("K_s", changed(DRIVEN.K_s, (2, 1), 7.0)),
        ("K_s", changed(DRIVEN.K_s, (1, 1), -1.0)),
    ],
)
def test_what_no_prescribed_motion_has(tmp_path: Path, key: str, array: Any) -> None:
    files = files_of(DRIVEN)
    assert_read(files, tmp_path, DRIVEN)
    changed_files = with_array(files, key, saved(array))
    assert_refused(changed_files, tmp_path, rf"^model/{key}\.npy: ", f"^{key}: ")


def test_a_motion_needs_a_mode_and_its_arrays(tmp_path: Path) -> None:
    """Three motions: 3 coordinates are none too few for them, but leave no mode."""
    files = files_of(DRIVEN)
    few = with_array(files, "lam", saved(np.zeros(3)), [3])
    assert_refused(few, tmp_path, r"^model/model\.json: lam: got no mode beside 3 prescribed motions")
    empty = with_array(files, "M_s", saved(np.zeros((0, 0))), [0, 0])
    assert_refused(empty, tmp_path, r"M_s: expected the shape 3 x 3", r"^M_s: got")
