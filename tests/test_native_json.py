"""JSON of the native twin against Python's: the same documents, the same numbers, the same refusals."""

import hashlib
import json
import math
import os
import shutil
import subprocess
import sys
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from native_reader import Refused, parse_json, sha256

DEPTH = 16  # JSON_DEPTH of json.h
unhurried = settings(deadline=None)  # the first example compiles the library


def oracle(content: bytes) -> Any:
    """Python's json without what RFC 8259 does not have; ValueError where it is no document."""
    value = json.loads(content.decode(), parse_int=float, parse_constant=_no_constant)
    _no_lone_surrogate(value)
    return value


def _no_constant(name: str) -> float:
    raise ValueError(name)


def _no_lone_surrogate(value: Any) -> None:
    if isinstance(value, str):
        value.encode()
    elif isinstance(value, list):
        for item in value:
            _no_lone_surrogate(item)
    elif isinstance(value, dict):
        _no_lone_surrogate([*value.keys(), *value.values()])


def bits(value: Any) -> Any:
    """Numbers by their bits, so that -0 is not 0."""
    if isinstance(value, float):
        return ("number", value.hex())
    if isinstance(value, list):
        return [bits(item) for item in value]
    if isinstance(value, dict):
        return {key: bits(item) for key, item in value.items()}
    return value


texts = st.text(st.characters(codec="utf-8"))
scalars = st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False) | texts
documents = st.recursive(
    scalars, lambda inner: st.lists(inner) | st.dictionaries(texts, inner), max_leaves=20
).filter(lambda value: depth(value) <= DEPTH)


def depth(value: Any) -> int:
    if isinstance(value, list):
        return 1 + max(map(depth, value), default=0)
    if isinstance(value, dict):
        return 1 + max(map(depth, value.values()), default=0)
    return 0


@unhurried
@given(documents, st.booleans(), st.sampled_from([None, 0, 3, "\t\r "]))
def test_documents_of_every_kind(value: Any, ascii_only: bool, indent: Any) -> None:
    content = json.dumps(value, ensure_ascii=ascii_only, indent=indent).encode()
    assert bits(parse_json(content)) == bits(oracle(content))


mutations = st.lists(
    st.tuples(
        st.integers(0, 200),
        st.integers(0, 2),
        st.sampled_from(
            [b'"', b"\\", b"[", b"]", b"{", b"}", b",", b":", b"0", b"1", b"-", b".", b"e", b"\\u12"]
        )
        | st.sampled_from(
            [b"\\ud83d", b"\\uDE00", b"\\u0000", b" ", b"\n", b"true", b"nul", b"\x00", b"\x1f"]
        )
        | st.binary(min_size=1, max_size=2),
    ),
    min_size=1,
    max_size=4,
)


@settings(max_examples=1000, deadline=None)
@given(documents, mutations)
def test_damaged_documents_are_judged_alike(value: Any, changes: list[tuple[int, int, bytes]]) -> None:
    content = json.dumps(value, ensure_ascii=False).encode()
    for place, removed, inserted in changes:
        place %= len(content) + 1
        content = content[:place] + inserted + content[place + removed :]
    try:
        expected = oracle(content)
    except (ValueError, RecursionError):
        with pytest.raises(Refused):
            parse_json(content)
        return
    if depth(expected) <= DEPTH:
        assert bits(parse_json(content)) == bits(expected)


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b" ",
        b"[1,]",
        b"[,1]",
        b"[1 2]",
        b'{"a" 1}',
        b'{"a":}',
        b"{1: 2}",
        b'{"a": 1,}',
        b"[1}",
        b"[",
        b'"',
        b'"\\',
        b'"\\x"',
        b'"\\u12g4"',
        b'"\\ud800"',
        b'"\\ud800\\n"',
        b'"\\ud800\\ud800"',
        b'"\\udc00\\ud800"',
        b'"\\u12',
        b'"a\nb"',
        b'"\x7f\x80"',
        b'"\xc0\x80"',  # 0 in two bytes
        b'"\xc1\xbf"',
        b'"\xe0\x9f\xbf"',  # U+07FF in three bytes
        b'"\xed\xa0\x80"',  # a surrogate
        b'"\xf0\x8f\xbf\xbf"',  # U+FFFF in four bytes
        b'"\xf4\x90\x80\x80"',  # beyond U+10FFFF
        b'"\xf5\x80\x80\x80"',
        b'"\xe2\x82"',
        b'"\xe2\x82',
        b"\xef\xbb\xbf[]",  # a byte order mark
        b"nul",
        b"nulll",
        b"True",
        b"NaN",
        b"-Infinity",
        b"01",
        b"-",
        b"-a",
        b"+1",
        b"1.",
        b".5",
        b"1e",
        b"1e+",
        b"1,5",
        b"0x10",
        b"1 1",
        b"[] []",
        b"[]\0",
        b"// comment\n1",
        b"'a'",
    ],
)
def test_what_is_no_json(content: bytes) -> None:
    with pytest.raises(Refused, match=r"text: expected .* at byte \d+"):
        parse_json(content)
    with pytest.raises(ValueError):  # noqa: PT011  the oracle agrees, in whatever words
        oracle(content)


def test_nesting_is_bounded() -> None:
    assert depth(parse_json(b"[" * DEPTH + b"]" * DEPTH)) == DEPTH
    for levels in (DEPTH + 1, 1_000_000):
        with pytest.raises(Refused, match="fewer levels"):
            parse_json(b"[" * levels + b"]" * levels)
        with pytest.raises(Refused, match="fewer levels"):
            parse_json(b'{"a":' * levels)


def test_the_last_of_equal_keys_counts() -> None:
    assert parse_json(b'{"a": 1, "b": [2], "a": 3}') == {"a": 3.0, "b": [2.0]}


decimals = st.builds(
    "{}{}{}{}".format,
    st.sampled_from(["", "-"]),
    st.from_regex(r"(0|[1-9][0-9]{0,40})", fullmatch=True),
    st.just("") | st.from_regex(r"\.[0-9]{1,40}", fullmatch=True),
    st.just("") | st.builds("e{}".format, st.integers(-400, 400)),
)


@settings(max_examples=1000, deadline=None)
@given(decimals)
def test_decimal_numbers_are_rounded_to_the_nearest(text: str) -> None:
    assert bits(parse_json(text.encode())) == bits(float(text))


def exact_decimal(value: Fraction) -> str:
    """All digits of a dyadic fraction, with an exponent."""
    power = value.denominator.bit_length() - 1
    return f"{value.numerator * 5**power}e-{power}"


@unhurried
@given(st.integers(0, 0x7FEFFFFFFFFFFFFE), st.sampled_from(["", "0", "1"]))
def test_halfway_between_two_doubles(pattern: int, more: str) -> None:
    """Ties to even; one more digit, however far behind, decides."""
    below, above = np.array([pattern, pattern + 1], dtype=np.uint64).view(np.float64).tolist()
    digits, exponent = exact_decimal((Fraction(below) + Fraction(above)) / 2).split("e")
    text = f"{digits}.{'0' * 1200}{more}e{exponent}" if more else f"{digits}e{exponent}"
    expected = above if more == "1" or pattern % 2 else below
    assert parse_json(text.encode()) == expected


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("0." + "0" * 400 + "1e401", 1.0),
        ("1" + "0" * 5000 + "e-5000", 1.0),
        ("0." + "0" * 5000 + "25e5000", 0.25),
        ("9" * 2000 + "e-2000", 1.0),
        ("1e400", math.inf),
        ("-1e99999999999999999999999", -math.inf),
        ("1e-99999999999999999999999", 0.0),
        ("0e99999999999999999999999", 0.0),
        ("1e00000000000000000000000000000002", 100.0),
        ("5e-324", 5e-324),
        ("2.2250738585072011e-308", 2.2250738585072011e-308),  # the largest denormal, once an endless loop
    ],
)
def test_long_and_extreme_numbers(text: str, expected: float) -> None:
    assert parse_json(text.encode()) == expected


def test_numbers_in_a_locale_with_a_decimal_comma(tmp_path: Path) -> None:
    localedef = shutil.which("localedef")
    if not localedef:
        pytest.skip("no localedef on this system, which makes the locale")
    source = tmp_path / "source"
    source.write_text('LC_NUMERIC\ndecimal_point ","\nthousands_sep "."\ngrouping 3;3\nEND LC_NUMERIC\n')
    command = [localedef, "-c", "-i", source, "-f", "ANSI_X3.4-1968", tmp_path / "comma"]
    subprocess.run(command, capture_output=True, check=False)  # returns 1 for the categories left out
    script = (
        "import ctypes, locale\nfrom native_reader import parse_json\n"
        "locale.setlocale(locale.LC_NUMERIC, 'comma')\n"
        "strtod = ctypes.CDLL(None).strtod\nstrtod.restype = ctypes.c_double\n"
        "assert strtod(b'0,5', None) == 0.5\n"  # the locale is in force
        "assert parse_json(b'[0.5, 1234.5678e-1, -1e3]') == [0.5, 123.45678, -1e3]\n"
    )
    folders = [str(Path(__file__).parent), str(Path(__file__).parents[1])]
    environment = {**os.environ, "LOCPATH": str(tmp_path), "PYTHONPATH": os.pathsep.join(folders)}
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, env=environment)
    if "unsupported locale" in done.stderr:
        pytest.skip("localedef could not make the locale")
    assert done.returncode == 0, done.stderr


def test_sha256_of_every_length_around_the_blocks() -> None:
    rng = np.random.default_rng(5)
    for size in (*range(201), 1000, 65_536, 1_000_003):
        content = rng.bytes(size)
        assert sha256(content) == hashlib.sha256(content).hexdigest()
