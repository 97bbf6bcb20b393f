"""model.json, its checksum right: both twins read the same texts and refuse the same ones."""

import json
from pathlib import Path

import numpy as np
import pytest
from examples import oscillator, two_ports
from model_files import HEADER, assert_read, assert_refused, files_of, with_header, with_text

from fmu_src.runtime.model import Port


@pytest.mark.parametrize(
    "text",
    [b"null", b"[]", b"1", b'"schema"', b"{}", b"\xff", b"", b"[" * 100_000, b'{"a":' * 100_000, b"{} {}"],
)
def test_a_header_that_is_something_else(tmp_path: Path, text: bytes) -> None:
    files = with_text(files_of(oscillator()), text)
    assert_refused(files, tmp_path, r"^model/model\.json: ", r"^model\.json: ")


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "utf-16-le", "utf-32", "utf-32-be", "latin-1"])
def test_a_header_in_another_encoding(tmp_path: Path, encoding: str) -> None:
    files = files_of(oscillator(description="ü"))
    text = files[HEADER].decode().encode(encoding)
    assert_refused(with_text(files, text), tmp_path, r"^model/model\.json: ", r"^model\.json: ")


OUTPUT_ONLY = oscillator(
    ports=(Port("tip", (), ("velocity.y",)),), B=np.zeros((1, 0)), C=np.ones((1, 1)), beta=7.0
)
IGNORED = '"schema": 3, "later": {}'


def with_replaced(right: str, other: str) -> dict[str, bytes]:
    """The files of OUTPUT_ONLY with one text of model.json, laid out in one line, replaced."""
    files = files_of(OUTPUT_ONLY)
    text = json.dumps(json.loads(files[HEADER]))
    assert text.count(right) == 1
    return with_text(files, text.replace(right, other).encode())


@pytest.mark.parametrize(
    ("right", "other"),
    [
        ('"schema": 3', '"schema": 3.0'),
        ('"schema": 3', '"schema": 3e0'),
        ('"shape": [1]', '"shape": [1.0]'),
        ('"shape": [1]', '"shape": [ 10e-1\t]'),
        ('"beta": 7.0', '"beta": 7'),
        ('"beta": 7.0', '"beta": 1e400, "beta": 7'),
        *(
            ('"schema": 3', IGNORED.format(value))
            for value in (
                r'"\ud83d\ude00"',
                r'"\u0000\uffff\u0041"',
                "1e400",
                "9" * 5000,
                "-0.0e-999",
                "[[[[[[[[[[{}]]]]]]]]]]",
                "\t\r\n null",
            )
        ),
    ],
)
def test_headers_written_otherwise(tmp_path: Path, right: str, other: str) -> None:
    assert_read(with_replaced(right, other), tmp_path, OUTPUT_ONLY)


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ('"schema": 3', '"schema": true'),
        ('"schema": 3', '"schema": 02'),
        ('"shape": [1]', '"shape": [true]'),
        ('"shape": [1]', '"shape": [1.5]'),
        ('"inputs": []', '"inputs": ""'),
        ('"inputs": []', '"inputs": {}'),
        ('"beta": 7.0', '"beta": 7, "beta": 1e400'),
        ('"beta": 7.0', '"beta": true'),
        ('"beta": 7.0', "'beta': 7.0"),
        *(
            ('"schema": 3', IGNORED.format(value))
            for value in (
                "NaN",
                "Infinity",
                "-Infinity",
                r'"\ud800"',
                r'"\udc00\ud800"',
                r'[{"\ud800": 1}]',
                r'"\x41"',
                r'"\u00e"',
                '"a\tb"',
                "1.",
                ".5",
                "+1",
                "0x1",
                "\uff11",
                "\u00a01",
                "[1,]",
                "{1: 2}",
                "nul",
                "",
                "/**/ 1",
            )
        ),
    ],
)
def test_headers_that_are_no_json_or_of_other_kinds(tmp_path: Path, right: str, wrong: str) -> None:
    assert_refused(with_replaced(right, wrong), tmp_path, r"^model/model\.json: ")


def test_descriptions_of_any_characters_that_xml_holds(tmp_path: Path) -> None:
    model = oscillator(description='\t\r\n "\\ \x7f\x85 ü\ud7ff\ue000\ufffd\U00010000\U0001fffe\U0010ffff')
    assert_read(files_of(model), tmp_path, model)


PORT = {"name": "tip", "inputs": ["force.x"], "outputs": ["displacement.x", "velocity.x", "acceleration.x"]}


@pytest.mark.parametrize(
    ("key", "value"),
    [
        *(
            (key, None)
            for key in (
                *("schema", "name", "description", "alpha", "beta"),
                *("initial", "residual", "ports", "arrays"),
            )
        ),
        *(("schema", value) for value in (1, 2, 4, 0, 1.5, "3", [3])),
        *(("name", value) for value in (7, "", "two words", "1st", "a\n", "two\nlines", "a\0", "ä", "a.b")),
        *(("description", value) for value in (1, ["a"], "a\0", "\1", "\x0b", "\x1f", "\ufffe", "b\uffff")),
        *(("alpha", value) for value in ("0.5", True, -1e-300, 10**400, [0.0])),
        *(("beta", value) for value in ("x", -1.0, float("nan"), float("inf"))),
        *(("initial", value) for value in ("moving", "", "Rest", "static\0", 1, ["rest"])),
        *(("residual", value) for value in ("true", 1, 0.0, [True], {})),
        *(("ports", value) for value in (3, [], {}, "", [3], [[]], [{}], ["tip"], [PORT, PORT])),
        *(("ports", [{**PORT, "name": value}]) for value in ("", "a b", "a\0", 1, None)),
        *(("ports", [{**PORT, "inputs": value}]) for value in ("", 1, {}, [1], ["force.w"], ["force.x"] * 2)),
        *(
            ("ports", [{**PORT, "inputs": [value]}])
            for value in ("reaction.x", "force.x\0", "force.", "", None)
        ),
        *(
            ("ports", [{**PORT, "outputs": value}])
            for value in (["pressure"], [["velocity.x"]], ["velocity.x"] * 3)
        ),
        ("ports", [{"name": "tip", "inputs": [], "outputs": []}]),
        ("ports", [{**PORT, "inputs": ["force.x", "force.y"]}]),  # B has one column
        ("ports", [{**PORT, "outputs": ["velocity.x", "velocity.y"]}]),  # C has three rows
        *(("arrays", value) for value in ([], {}, 1, {"lam": []}, {"lam": {}}, {"lam": {"shape": []}})),
    ],
)
def test_header_that_does_not_fit(tmp_path: Path, key: str, value: object) -> None:
    files = files_of(oscillator())
    header = json.loads(files[HEADER])
    assert header["ports"] == [PORT]
    if value is None:
        del header[key]
        changed = with_text(files, json.dumps(header).encode())
    else:
        changed = with_header(files, **{key: value})
    assert_refused(changed, tmp_path, r"^model/model\.json: ")


@pytest.mark.parametrize("twice", [None, "a", "port_250", "z"])
def test_equal_port_names_anywhere_among_many(tmp_path: Path, twice: str | None) -> None:
    names = ["a", *(f"port_{k}" for k in range(500)), "z", *([twice] if twice else [])]
    found = [{"name": name, "inputs": [], "outputs": []} for name in names]
    files = with_header(files_of(oscillator()), ports=[*found, PORT])
    if twice is None:
        assert_read(files, tmp_path, oscillator())
    else:
        assert_refused(files, tmp_path, f"got two ports {twice}, expected unique names", "unique names")


def test_a_static_start_has_no_rigid_mode(tmp_path: Path) -> None:
    files = with_header(files_of(two_ports()), initial="static")
    assert_refused(files, tmp_path, "static start", "static")
    files = with_header(files_of(oscillator()), initial="static")
    assert_read(files, tmp_path, oscillator(initial="static"))
