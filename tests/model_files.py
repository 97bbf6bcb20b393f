"""The resource files of a model by name, changed with right checksums, and what both twins say of them."""

import hashlib
import io
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from native_reader import NativeModel, Refused, in_memory, read_native

from fmu_src.runtime.errors import ModelError
from fmu_src.runtime.model import ReducedModel
from fmu_src.runtime.resources import ARRAYS, read_model, write_model

HEADER = "model/model.json"


def files_of(model: ReducedModel) -> dict[str, bytes]:
    return {f"model/{name}": content for name, content in write_model(model).items()}


def with_text(files: Mapping[str, bytes], text: bytes) -> dict[str, bytes]:
    """Another model.json."""
    line = f"{hashlib.sha256(text).hexdigest()}\n"
    return {**files, HEADER: text, "model/model.sha256": line.encode()}


def with_header(files: Mapping[str, bytes], **changes: object) -> dict[str, bytes]:
    return with_text(files, json.dumps({**json.loads(files[HEADER]), **changes}).encode())


def with_array(
    files: Mapping[str, bytes], key: str, content: bytes, shape: object = None
) -> dict[str, bytes]:
    """Another file for an array."""
    arrays = json.loads(files[HEADER])["arrays"]
    arrays[key]["sha256"] = hashlib.sha256(content).hexdigest()
    arrays[key]["shape"] = arrays[key]["shape"] if shape is None else shape
    return {**with_header(files, arrays=arrays), f"model/{key}.npy": content}


def saved(array: Any) -> bytes:
    buffer = io.BytesIO()
    np.save(buffer, np.asarray(array))
    return buffer.getvalue()


def written(files: Mapping[str, bytes], resources: Path) -> Path:
    """The files in this folder; returns that of the model."""
    (resources / "model").mkdir(exist_ok=True)
    for name, content in files.items():
        (resources / name).unlink(missing_ok=True)  # some file systems take long to cut a file anew
        (resources / name).write_bytes(content)
    return resources / "model"


def assert_same(native: NativeModel, model: ReducedModel) -> None:
    for key in ("name", "alpha", "beta", "inputs", "outputs", "laws", "residual", "initial"):
        assert getattr(native, key) == getattr(model, key), key
    for key in ARRAYS:
        np.testing.assert_array_equal(getattr(native, key), getattr(model, key), strict=True)


def assert_read(files: Mapping[str, bytes], resources: Path, model: ReducedModel) -> None:
    """Both twins read this model."""
    native = read_native(in_memory(files))
    assert_same(native, model)
    assert_same(native, read_model(written(files, resources)))


def assert_refused(
    files: Mapping[str, bytes], resources: Path, reason: str, error: str = r"^[^\n]+\Z"
) -> None:
    """Both twins refuse, each in one line: `reason` is matched by that of C, `error` by that of Python."""
    with pytest.raises(Refused, match=reason):
        read_native(in_memory(files))
    with pytest.raises(ModelError, match=error):
        read_model(written(files, resources))
