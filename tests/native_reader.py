"""The reader of the native twin, called through ctypes: json.h, sha256.h, location.h, resources.h."""

import ctypes
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from native_library import TESTS, native_library

from fmu_src.runtime.kinds import Law
from fmu_src.runtime.model import Floats

READER = (
    "common.c",
    "json.c",
    "json_scalars.c",
    "sha256.c",
    "npy.c",
    "model.c",
    "kinds.c",
    "ports.c",
    "header.c",
    "resources.c",
    "folder.c",
    "location.c",
)
HELPERS = (TESTS / "counting_memory.c", TESTS / "memory_files.c")
CHECKED = ("-g", "-fsanitize=undefined", "-fno-sanitize-recover=all")
FOREVER = ctypes.c_size_t(-1)
LAWS: tuple[Law, ...] = (
    "position",
    "velocity",
    "acceleration",
    "reaction",
    "mises",
    "kinetic",
    "strain",
)  # of model.h


ARRAYS = ("D_rest", "B", "C", "R", "R_in", "M_s", "K_s")


class Refused(Exception):
    """The reason that C gave."""


class Memory(ctypes.Structure):
    _fields_ = (("allocate", ctypes.c_void_p), ("release", ctypes.CFUNCTYPE(None, ctypes.c_void_p)))


class Reason(ctypes.Structure):
    _fields_ = (("text", ctypes.c_char * 256),)

    def refuse(self) -> Refused:
        text = self.text.decode(errors="replace")
        assert text
        assert text.isprintable()  # one line
        return Refused(text)


class Json(ctypes.Structure):
    _fields_ = (
        ("kind", ctypes.c_int),
        ("size", ctypes.c_size_t),
        ("span", ctypes.c_size_t),
        ("number", ctypes.c_double),
        ("text", ctypes.c_void_p),
    )


class MemoryFile(ctypes.Structure):
    _fields_ = (("name", ctypes.c_char_p), ("bytes", ctypes.c_char_p), ("size", ctypes.c_size_t))


class MemoryFiles(ctypes.Structure):
    _fields_ = (("files", ctypes.POINTER(MemoryFile)), ("count", ctypes.c_size_t))


class Files(ctypes.Structure):
    _fields_ = (("read", ctypes.c_void_p), ("context", ctypes.c_void_p))


class CModel(ctypes.Structure):
    _fields_ = (
        ("name", ctypes.c_char_p),
        *((key, ctypes.c_size_t) for key in ("k", "r", "n", "m", "p", "s")),
        ("lam", ctypes.POINTER(ctypes.c_double)),
        *((key, ctypes.c_double) for key in ("alpha", "beta")),
        *((key, ctypes.POINTER(ctypes.c_double)) for key in ARRAYS),
        ("motions", ctypes.POINTER(ctypes.c_size_t)),
        *((key, ctypes.POINTER(ctypes.c_char_p)) for key in ("inputs", "outputs")),
        ("laws", ctypes.POINTER(ctypes.c_int)),
        ("residual", ctypes.c_bool),
        ("initial_static", ctypes.c_bool),
    )


@dataclass(frozen=True)
class NativeModel:
    """What C read, copied; names as in the ReducedModel of Python."""

    name: str
    lam: Floats
    alpha: float
    beta: float
    D_rest: Floats
    B: Floats
    C: Floats
    R: Floats
    R_in: Floats
    M_s: Floats
    K_s: Floats
    motions: tuple[int, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    laws: tuple[Law, ...]
    residual: bool
    initial: str


@cache
def library() -> ctypes.CDLL:
    found = native_library("reader", (*READER, *HELPERS), CHECKED)
    found.parse_json.restype = ctypes.POINTER(Json)
    found.location_path.restype = found.resource_location.restype = ctypes.c_void_p
    found.read_model.restype = ctypes.POINTER(CModel)
    found.read_guid.restype = ctypes.c_bool
    found.files_in_memory.restype = found.files_of_folder.restype = Files
    found.blocks_out.restype = ctypes.c_size_t
    return found


def memory() -> Memory:
    return Memory.in_dll(library(), "counting_memory")


def sha256(content: bytes) -> str:
    digest = ctypes.create_string_buffer(65)
    library().sha256(content, ctypes.c_size_t(len(content)), digest)
    return digest.value.decode()


def parse_json(content: bytes) -> Any:
    """The document, in the types of Python's json module with all numbers as floats."""
    text, reason = (ctypes.c_char * max(len(content), 1)).from_buffer_copy(content or b"\0"), Reason()
    root = library().parse_json(
        b"text", text, ctypes.c_size_t(len(content)), ctypes.byref(memory()), ctypes.byref(reason)
    )
    if not root:
        assert library().blocks_out() == 0
        raise reason.refuse()
    try:
        value, end = _value(root, 0)
        assert end == root[0].span
        return value
    finally:
        memory().release(ctypes.cast(root, ctypes.c_void_p))
        assert library().blocks_out() == 0


def _value(nodes: Any, at: int) -> tuple[Any, int]:
    """The value that begins at this node, and the place behind it."""
    node = nodes[at]
    if node.kind <= 2:
        return (None, False, True)[node.kind], at + 1
    if node.kind == 3:
        return node.number, at + 1
    if node.kind == 4:
        assert ctypes.string_at(node.text + node.size, 1) == b"\0"
        return ctypes.string_at(node.text, node.size).decode(), at + 1
    items, place = [], at + 1
    for _ in range(node.size * (node.kind - 4)):  # an object has two nodes a member
        item, place = _value(nodes, place)
        items.append(item)
    assert place == at + node.span
    return (items if node.kind == 5 else dict(zip(items[::2], items[1::2], strict=True))), place


def location(uri: str | bytes | None, windows: bool) -> str:
    reason = Reason()
    text = uri.encode() if isinstance(uri, str) else uri
    path = library().location_path(text, ctypes.c_bool(windows), ctypes.byref(memory()), ctypes.byref(reason))
    if not path:
        assert library().blocks_out() == 0
        raise reason.refuse()
    found = ctypes.string_at(path).decode(errors="surrogateescape")
    memory().release(ctypes.c_void_p(path))
    assert library().blocks_out() == 0
    return found


def in_memory(files: Mapping[str, bytes]) -> tuple[Files, object]:
    """Files by their names below resources/, and what must outlive them."""
    entries = (MemoryFile * len(files))(*((name.encode(), c, len(c)) for name, c in files.items()))
    everything = MemoryFiles(entries, len(files))
    return library().files_in_memory(ctypes.byref(everything)), (entries, everything, files)


def in_folder(resources: Path | bytes) -> tuple[Files, object]:
    path = resources if isinstance(resources, bytes) else str(resources).encode()
    kept = ctypes.create_string_buffer(path)
    return library().files_of_folder(kept), kept


def read_native(source: tuple[Files, object], allocations: ctypes.c_size_t = FOREVER) -> NativeModel:
    """The model in these files; Refused where it is not accepted. Nothing leaks in either case."""
    files, _kept = source
    reason = Reason()
    library().allow_allocations(allocations)
    model = library().read_model(ctypes.byref(files), ctypes.byref(memory()), ctypes.byref(reason))
    library().allow_allocations(FOREVER)
    if not model:
        assert library().blocks_out() == 0
        raise reason.refuse()
    found = _copy(model[0])
    library().free_model(model, ctypes.byref(memory()))
    assert library().blocks_out() == 0
    return found


def _copy(model: CModel) -> NativeModel:
    def array(values: Any, *shape: int) -> Floats:
        if 0 in shape:
            return np.empty(shape)
        return np.ctypeslib.as_array(values, shape).copy()

    k, n, m, p, s = model.k, model.n, model.m, model.p, model.s
    assert n == k + model.r
    return NativeModel(
        name=model.name.decode(),
        lam=array(model.lam, n),
        alpha=model.alpha,
        beta=model.beta,
        D_rest=array(model.D_rest, n, n),
        B=array(model.B, n, m),
        C=array(model.C, s, n),
        R=array(model.R, s, m),
        R_in=array(model.R_in, m, m),
        M_s=array(model.M_s, k, k),
        K_s=array(model.K_s, k, k),
        motions=tuple(model.motions[j] for j in range(k)),
        inputs=tuple(model.inputs[k].decode() for k in range(m)),
        outputs=tuple(model.outputs[k].decode() for k in range(p)),
        laws=tuple(LAWS[model.laws[k]] for k in range(p)),
        residual=model.residual,
        initial="static" if model.initial_static else "rest",
    )


def read_guid(source: tuple[Files, object]) -> str:
    files, _kept = source
    reason, guid = Reason(), ctypes.create_string_buffer(64)
    done = library().read_guid(ctypes.byref(files), ctypes.byref(memory()), guid, ctypes.byref(reason))
    assert library().blocks_out() == 0
    if not done:
        raise reason.refuse()
    return guid.value.decode()
