"""The first inputs of the fuzz target of the resource reader: `python tests/fuzz/seeds.py FOLDER`.

Sound models and faults that a reader should meet, in the container format of resources.c.
"""

import io
import json
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))
sys.path.insert(0, str(Path(__file__).parents[2]))

from driven import driven
from examples import everything, oscillator, two_ports

from fmu_src.runtime.resources import ARRAYS, write_model

GUID = b"{01234567-89ab-cdef-0123-456789abcdef}\n"
SOUND, MEND, FAIL = 0, 1, 2  # the switches of the target


def container(
    files: Mapping[str, bytes], switches: int = MEND, allocations: int = 0, guid: bytes = GUID
) -> bytes:
    """Switches, allocations, then every file with its size before it."""
    names = ["model.json", "model.sha256", *(f"{key}.npy" for key in ARRAYS)]
    return bytes([switches, allocations]) + sized(guid) + b"".join(sized(files[name]) for name in names)


def sized(content: bytes) -> bytes:
    return len(content).to_bytes(2, "little") + content


def seeds() -> Iterator[tuple[str, bytes]]:
    """Names and contents."""
    small, larger = write_model(oscillator()), write_model(two_ports())
    static = write_model(oscillator(initial="static", description='ü\u20ac\U0001f600"\\'))
    yield "oscillator", container(small, SOUND)
    yield "two_ports", container(larger, SOUND)
    yield "static", container(static, SOUND)
    yield "everything", container(write_model(everything()), SOUND)
    moved = write_model(driven())
    yield "driven", container(moved, SOUND)
    for name, arrays in driven_changes().items():
        yield name, container({**moved, **arrays})
    for k in (0, 2, 3, 6, 9, 11):
        yield f"allocation_{k}", container(small, FAIL, k)
    yield "empty", b""
    yield "no_files", bytes([SOUND, 0])
    for k in (45, 300, 1000):
        yield f"cut_{k}", container(small)[:k]
    for k, guid in enumerate((b"{a}\n{b}\n", b"x" * 65, b"x" * 66, b"{a}\r\n")):
        yield f"guid_{k}", bytes([SOUND, 0]) + sized(guid)
    yield "short_checksum", container({**small, "model.sha256": small["model.sha256"][:-1]}, SOUND)
    yield "other_checksum", container({**small, "model.sha256": larger["model.sha256"]}, SOUND)
    for name, changes in header_changes().items():
        header = {**json.loads(larger["model.json"]), **changes}
        yield name, container({**larger, "model.json": json.dumps(header).encode()})
    for name, text in header_texts().items():
        yield name, bytes([MEND, 0]) + sized(GUID) + sized(text) + sized(b"")
    for name, arrays in array_changes().items():
        yield name, container({**larger, **arrays})


def header_changes() -> dict[str, dict[str, object]]:
    """Values that do not fit, and unknown keys, which do."""
    return {
        "unknown_keys": {"later": [{"a": [None, True, False, -1.5e-3, "\u00e9\u20ac\U0001f600\t"]}], "": {}},
        "two_equal_ports": {"ports": [{"name": "a", "inputs": ["force.x"], "outputs": []}] * 2},
        "repeated_input": {"ports": [{"name": "a", "inputs": ["force.x"] * 2, "outputs": []}]},
        "static_rigid": {"initial": "static"},
        "huge_shape": {"arrays": {"lam": {"shape": [2**28], "sha256": ""}}},
        "not_xml": {"description": "\uffff"},
        "no_variables": {"ports": [{"name": "a", "inputs": [], "outputs": []}]},
        "residual": {"residual": 1},
        "output_of_gravity": {"ports": [{"name": "gravity", "inputs": [], "outputs": ["displacement.x"]}]},
        "pressure_of_base": {"ports": [{"name": "base", "inputs": ["pressure"], "outputs": []}]},
    }


def header_texts() -> dict[str, bytes]:
    """Texts that are no JSON, or deep, or long."""
    return {
        "deep": b"[" * 40 + b"]" * 40,
        "surrogate": b'{"schema": "\\ud83d\\ude00\\ud800"}',
        "escapes": b'{"schema": "\\u0041\\"\\/\\b\\f\\x"}',
        "hexadecimal": b'["\\uD83D\\udE0g"]',
        "colon": b'{"a", 1}',
        "key": b'{"a": 1e5, 2: 3}',
        "digits": b"[0." + b"0" * 400 + b"7" * 900 + b"e+0000000000000000000000399, -0, 1E5]",
        "bytes": b'{"\xff": 1}',
    }


def array_changes() -> dict[str, dict[str, bytes]]:
    """Arrays that numpy.save wrote and no reduced model has."""
    return {
        "not_a_number": {"B.npy": saved(np.full((6, 3), np.nan))},
        "descending": {"lam.npy": saved(np.arange(6.0)[::-1])},
        "coupled": {"D_rest.npy": saved(np.ones((6, 6)))},
        "not_symmetric": {"D_rest.npy": saved(np.triu(np.ones((6, 6))))},
        "flexibility": {"R.npy": saved(np.ones((5, 3))), "R_in.npy": saved(np.triu(np.ones((3, 3))))},
        "fortran": {"D_rest.npy": saved(np.asfortranarray(np.ones((6, 6))))},
        "cut_header": {"lam.npy": saved(np.arange(6.0))[:120]},
        "short_header": {"lam.npy": b"\x93NUMPY\x01\x00\x01\x00\n"},
        "integers": {"lam.npy": saved(np.arange(6))},
    }


def driven_changes() -> dict[str, dict[str, bytes]]:
    """Rows and columns of prescribed motions that are not so."""
    model = driven()
    lam, B, C = (array.copy() for array in (model.lam, model.B, model.C))
    lam[2], B[1, 0] = 1.0, 1.0
    C[-1] = 1.0
    return {
        "stiff_motion": {"lam.npy": saved(lam)},
        "wrong_motion": {"B.npy": saved(B)},
        "elastic_modes": {"C.npy": saved(C)},
        "no_mass": {"M_s.npy": saved(-np.eye(3))},
        "one_sided": {"K_s.npy": saved(np.triu(np.ones((3, 3))))},
    }


def saved(array: np.ndarray) -> bytes:
    buffer = io.BytesIO()
    np.save(buffer, array)
    return buffer.getvalue()


def main(folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    for name, content in seeds():
        (folder / name).write_bytes(content)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
