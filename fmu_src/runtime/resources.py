"""The seam: a reduced model as plain files, `model.json` and one little-endian `.npy` per array."""

import hashlib
import io
import json
import math
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from .errors import ModelError
from .model import Floats, Port, ReducedModel

SCHEMA = 1
ARRAYS = {"lam": "1/s2", "D_rest": "1/s", "B": "kg^-1/2", "C": "kg^-1/2"}
LIMIT = 1 << 31  # bytes of one file; a larger one is no reduced model
AGAIN = "build the FMU again"
NPY = re.compile(
    rb"\x93NUMPY\x01\x00.."
    rb"\{'descr': '<f8', 'fortran_order': False, 'shape': \((?P<shape>[\d, ]{0,60})\), \} *\n",
    re.DOTALL,
)


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
        "ports": [
            {"name": port.name, "inputs": list(port.inputs), "outputs": list(port.outputs)}
            for port in model.ports
        ],
        "arrays": {
            key: {
                "shape": list(getattr(model, key).shape),
                "unit": unit,
                "sha256": hashlib.sha256(files[f"{key}.npy"]).hexdigest(),
            }
            for key, unit in ARRAYS.items()
        },
    }
    files["model.json"] = (json.dumps(header, indent=1, ensure_ascii=False) + "\n").encode()
    return files


def read_model(folder: Path) -> ReducedModel:
    """The model that `write_model` described; nothing is used before it is checked.

    Raises ModelError where a file is missing, damaged or does not fit the others.
    """
    try:
        header = json.loads(_bytes(folder / "model.json"))
        if header["schema"] != SCHEMA:
            raise ModelError(f"model.json: got schema {header['schema']!r}, expected {SCHEMA}; {AGAIN}")
        arrays = {key: _array(folder, key, header["arrays"][key]) for key in ARRAYS}
        ports = tuple(
            Port(_text(port["name"]), _texts(port["inputs"]), _texts(port["outputs"]))
            for port in header["ports"]
        )
        return ReducedModel(
            name=_text(header["name"]),
            description=_text(header["description"]),
            alpha=_number(header["alpha"]),
            beta=_number(header["beta"]),
            initial=header["initial"],
            ports=ports,
            **arrays,
        )
    except (KeyError, TypeError, ValueError, AttributeError, ArithmeticError, RecursionError) as error:
        raise ModelError(f"model.json: {type(error).__name__}: {error}; {AGAIN}") from error


def _npy(array: Floats) -> bytes:
    buffer = io.BytesIO()
    np.save(buffer, np.ascontiguousarray(array, dtype="<f8"), allow_pickle=False)
    return buffer.getvalue()


def _bytes(path: Path) -> bytes:
    try:
        if path.stat().st_size > LIMIT:
            raise ModelError(
                f"{path.name}: got {path.stat().st_size} bytes, expected at most {LIMIT}; {AGAIN}"
            )
        return path.read_bytes()
    except OSError as error:
        raise ModelError(f"{path.name}: cannot be read ({error.strerror}); {AGAIN}") from error


def _array(folder: Path, key: str, entry: Mapping[str, Any]) -> Floats:
    """One .npy file of format 1.0, float64 in C order; its length must be what its shape takes."""
    content = _bytes(folder / f"{key}.npy")
    if hashlib.sha256(content).hexdigest() != entry["sha256"]:
        raise ModelError(f"{key}.npy: its checksum is not that of model.json; {AGAIN}")
    found = NPY.match(content)
    shape = tuple(int(n) for n in found["shape"].split(b",") if n.strip()) if found else ()
    start = 10 + int.from_bytes(content[8:10], "little")
    if not found or list(shape) != entry["shape"] or len(content) != start + 8 * math.prod(shape):
        raise ModelError(f"{key}.npy: got {len(content)} bytes, expected float64 {entry['shape']}; {AGAIN}")
    return np.frombuffer(content, dtype="<f8", offset=start).reshape(shape).astype(np.float64)


def _text(value: object) -> str:
    if not isinstance(value, str):
        raise TypeError(f"got {value!r}, expected a text")
    return value


def _texts(value: list[object]) -> tuple[str, ...]:
    return tuple(_text(item) for item in value)


def _number(value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise TypeError(f"got {value!r}, expected a number")
    return float(value)
