"""The seam: a reduced model as plain files, `model.json` and one little-endian `.npy` per array.

`model.json` holds the checksums of the arrays, `model.sha256` that of `model.json`.
"""

import hashlib
import io
import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NoReturn, TypeVar

import numpy as np

from .errors import ModelError
from .model import Floats, Port, ReducedModel

SCHEMA = 3
ARRAYS = {
    "lam": "1/s2",
    "D_rest": "1/s",
    "B": "kg^1/2.m/s2 per unit of the input",
    "C": "unit of the output per kg^1/2.m, with its derivatives by time",
    "R": "unit of the output per unit of the input",
    "R_in": "J per product of the units of two inputs, twice",
    "M_s": "J per product of the units of two prescribed velocities, twice",
    "K_s": "J per product of the units of two prescribed displacements, twice",
}
LIMIT = 1 << 31  # bytes of one file; a larger one is no reduced model
AGAIN = "build the FMU again"
NPY = b"\x93NUMPY\x01\x00"  # how a file of format 1.0 begins
KINDS = {str: "a text", float: "a number", list: "a list", bool: "true or false"}

T = TypeVar("T")


def write_model(model: ReducedModel) -> dict[str, bytes]:
    """The files of `resources/model/`, by name; anyone can open the arrays with `numpy.load`."""
    files = {f"{key}.npy": _npy(getattr(model, key)) for key in ARRAYS}
    header = {
        "schema": SCHEMA,
        "name": model.name,
        "description": model.description,
        "alpha": model.alpha,
        "beta": model.beta,
        "initial": model.initial,
        "residual": model.residual,
        "ports": [
            {"name": port.name, "inputs": list(port.inputs), "outputs": list(port.outputs)}
            for port in model.ports
        ],
        "arrays": {
            key: {
                "shape": list(getattr(model, key).shape),
                "unit": unit,
                "sha256": _sha256(files[f"{key}.npy"]),
            }
            for key, unit in ARRAYS.items()
        },
    }
    files["model.json"] = (json.dumps(header, indent=1, ensure_ascii=False) + "\n").encode()
    files["model.sha256"] = f"{_sha256(files['model.json'])}\n".encode()
    return files


def read_model(folder: Path) -> ReducedModel:
    """The model that `write_model` described; nothing is used before it is checked.

    Raises ModelError where a file is missing, damaged or does not fit the others.
    """
    try:
        header = _header(folder)
        if _of_kind(float, header["schema"]) != SCHEMA:
            raise ModelError(f"model.json: got schema {header['schema']:g}, expected {SCHEMA}; {AGAIN}")
        arrays = {key: _array(folder, key, header["arrays"][key]) for key in ARRAYS}
        ports = tuple(
            Port(_of_kind(str, port["name"]), _texts(port["inputs"]), _texts(port["outputs"]))
            for port in _of_kind(list, header["ports"])
        )
        return ReducedModel(
            name=_of_kind(str, header["name"]),
            description=_of_kind(str, header["description"]),
            alpha=_of_kind(float, header["alpha"]),
            beta=_of_kind(float, header["beta"]),
            initial=header["initial"],
            residual=_of_kind(bool, header["residual"]),
            ports=ports,
            **arrays,
        )
    except (KeyError, TypeError, ValueError, AttributeError, ArithmeticError, RecursionError) as error:
        raise ModelError(f"model.json: {type(error).__name__}: {error}; {AGAIN}") from error


def _npy(array: Floats) -> bytes:
    buffer = io.BytesIO()
    np.save(buffer, np.ascontiguousarray(array, dtype="<f8"), allow_pickle=False)
    return buffer.getvalue()


def _sha256(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


def _bytes(path: Path) -> bytes:
    try:
        if path.stat().st_size > LIMIT:
            raise ModelError(
                f"{path.name}: got {path.stat().st_size} bytes, expected at most {LIMIT}; {AGAIN}"
            )
        return path.read_bytes()
    except OSError as error:
        raise ModelError(f"{path.name}: cannot be read ({error.strerror}); {AGAIN}") from error


def _header(folder: Path) -> Any:
    """model.json, once it is what its checksum says: RFC 8259, all numbers as floats."""
    content = _bytes(folder / "model.json")
    if _bytes(folder / "model.sha256") != f"{_sha256(content)}\n".encode():
        raise ModelError(f"model.json: its checksum is not that of model.sha256; {AGAIN}")
    header = json.loads(content.decode(), parse_int=float, parse_constant=_no_number)
    json.dumps(header, ensure_ascii=False).encode()  # raises where a text holds half a surrogate pair
    return header


def _array(folder: Path, key: str, entry: Mapping[str, Any]) -> Floats:
    """One .npy file as numpy.save writes it, float64 in C order; its length must be what its shape takes."""
    content = _bytes(folder / f"{key}.npy")
    if _sha256(content) != entry["sha256"]:
        raise ModelError(f"{key}.npy: its checksum is not that of model.json; {AGAIN}")
    expected = [_of_kind(float, n) for n in entry["shape"]]
    shape = tuple(map(int, expected))
    start = 10 + int.from_bytes(content[8:10], "little")
    text = f"{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}".encode()
    begin = NPY + content[8:10] + text.ljust(start - 11) + b"\n"
    if [*shape] != expected or content[:start] != begin or len(content) != start + 8 * math.prod(shape):
        raise ModelError(f"{key}.npy: got {len(content)} bytes, expected float64 {shape}; {AGAIN}")
    return np.frombuffer(content, dtype="<f8", offset=start).reshape(shape).astype(np.float64)


def _of_kind(kind: type[T], value: object) -> T:
    if not isinstance(value, kind):
        raise TypeError(f"got {value!r}, expected {KINDS[kind]}")
    return value


def _texts(value: object) -> tuple[str, ...]:
    return tuple(_of_kind(str, item) for item in _of_kind(list, value))


def _no_number(word: str) -> NoReturn:
    raise ValueError(f"got {word}, expected a finite number")
