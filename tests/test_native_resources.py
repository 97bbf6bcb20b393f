"""The resource reader of the native twin: it reads what the Python twin reads."""

import ctypes
import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from examples import oscillator, two_ports
from hypothesis import given, settings
from hypothesis import strategies as st
from model_files import HEADER, assert_read, assert_same, files_of, with_text, written
from native_reader import Refused, in_folder, in_memory, library, read_guid, read_native

from fmu_src.runtime.model import INPUTS, OUTPUTS, Port, ReducedModel
from fmu_src.runtime.resources import ARRAYS

GUID = "{01234567-89ab-cdef-0123-456789abcdef}"
ALLOCATIONS = 9  # model.json, its checksum, its values, its ports' names, the model, four arrays

MODELS: list[Callable[[], ReducedModel]] = [
    oscillator,
    two_ports,
    lambda: oscillator(initial="static", description='ü€\U0001f600 "\\ \t\n'),
    lambda: two_ports(ports=(Port("in_1", INPUTS, ()), Port("out", (), OUTPUTS[:5]))),
    lambda: oscillator(ports=(Port("only_in", ("force.z",), ()),), C=np.zeros((0, 1))),
    lambda: oscillator(ports=(Port("only_out", (), ("velocity.y",)),), B=np.zeros((1, 0)), C=np.ones((1, 1))),
    lambda: oscillator(ports=(Port("none", (), ()), Port("tip", ("force.x",), OUTPUTS[3:6]))),
]


@pytest.mark.parametrize("build", MODELS)
def test_both_twins_read_the_same(tmp_path: Path, build: Callable[[], ReducedModel]) -> None:
    assert_read(files_of(build()), tmp_path, build())
    assert_same(read_native(in_folder(tmp_path)), build())


finite = st.floats(allow_nan=False, allow_infinity=False)
positive = st.floats(0, allow_infinity=False)
ports = st.lists(
    st.tuples(
        st.from_regex(r"[A-Za-z_][A-Za-z0-9_]{0,20}", fullmatch=True),
        st.lists(st.sampled_from(INPUTS), unique=True),
        st.lists(st.sampled_from(OUTPUTS), unique=True),
    ),
    min_size=1,
    max_size=4,
    unique_by=lambda port: port[0],
).filter(lambda found: any(port[1] or port[2] for port in found))


@settings(max_examples=150, deadline=None)
@given(st.data(), ports, positive, positive, st.sampled_from(["rest", "static"]))
def test_models_of_every_kind(
    data: st.DataObject,
    found: list[tuple[str, list[str], list[str]]],
    alpha: float,
    beta: float,
    initial: Any,
) -> None:
    lam = sorted(data.draw(st.lists(positive, min_size=1, max_size=5)))
    r, m, p = len(lam), sum(len(port[1]) for port in found), sum(len(port[2]) for port in found)

    def array(*shape: int, of: st.SearchStrategy[float] = finite) -> Any:
        size = math.prod(shape)
        return np.array(data.draw(st.lists(of, min_size=size, max_size=size)), dtype=float).reshape(shape)

    model = ReducedModel(
        name=data.draw(st.from_regex(r"[A-Za-z_][A-Za-z0-9_]{0,20}", fullmatch=True)),
        description=data.draw(st.text(st.characters(min_codepoint=32, max_codepoint=0xD7FF))),
        lam=np.array(lam),
        alpha=alpha,
        beta=beta,
        D_rest=np.diag(array(r, of=positive)),
        B=array(r, m),
        C=array(p, r),
        ports=tuple(Port(name, tuple(inputs), tuple(outputs)) for name, inputs, outputs in found),
        initial=initial if lam[0] > 0 else "rest",
    )
    assert_same(read_native(in_memory(files_of(model))), model)


def test_unknown_keys_and_other_layouts_of_the_header(tmp_path: Path) -> None:
    files = files_of(two_ports())
    header = json.loads(files[HEADER])
    later = {"later": {"a": [[None, True, -1e-5]]}, **dict(reversed(header.items())), "": []}
    for text in (json.dumps(later, separators=(",", ":")), json.dumps(later, indent="\t\r\n ")):
        assert_read(with_text(files, text.encode()), tmp_path, two_ports())


def test_the_last_of_equal_keys_counts_in_both_twins(tmp_path: Path) -> None:
    files = files_of(oscillator())
    text = files[HEADER].replace(b'"beta": 0.0', b'"beta": 7, "beta": 2, "alpha": 3e-2')
    assert_read(with_text(files, text), tmp_path, oscillator(alpha=0.03, beta=2.0))


@pytest.mark.parametrize("name", ["model.json", "model.sha256", *(f"{key}.npy" for key in ARRAYS)])
def test_missing_files(tmp_path: Path, name: str) -> None:
    files = files_of(two_ports())
    del files[f"model/{name}"]
    with pytest.raises(Refused, match=f"^model/{name}: is missing"):
        read_native(in_memory(files))
    written(files, tmp_path)
    with pytest.raises(Refused, match=f"^model/{name}: cannot be opened in the folder {tmp_path}"):
        read_native(in_folder(tmp_path))
    (tmp_path / "model" / name).mkdir()  # a folder opens on some systems, but has no size
    with pytest.raises(Refused, match=f"^model/{name}: "):
        read_native(in_folder(tmp_path))


@pytest.mark.parametrize("name", ["model.json", "model.sha256", *(f"{key}.npy" for key in ARRAYS)])
def test_larger_files_than_the_model_needs_are_not_even_read(tmp_path: Path, name: str) -> None:
    files = files_of(two_ports())
    written(files, tmp_path)
    with (tmp_path / "model" / name).open("r+b") as file:
        file.truncate(10 << 30)  # a hole: takes no place on the disk
    with pytest.raises(Refused, match=rf"^model/{name}: (got 10737418240 bytes, expected at most|cannot be)"):
        read_native(in_folder(tmp_path))


@pytest.mark.parametrize("from_memory", [True, False])
def test_memory_that_runs_out_anywhere(tmp_path: Path, from_memory: bool) -> None:
    files = files_of(two_ports())
    written(files, tmp_path)
    source = in_memory(files) if from_memory else in_folder(tmp_path)
    needed = ALLOCATIONS if from_memory else ALLOCATIONS + len(files)  # a path for each file
    for allocations in range(needed):
        with pytest.raises(Refused, match="no memory"):
            read_native(source, ctypes.c_size_t(allocations))
    assert_same(read_native(source, ctypes.c_size_t(needed)), two_ports())


@pytest.mark.parametrize("line", [GUID, GUID + "\n", GUID + "\r\n", "x" * 63 + "\r\n", "x"])
def test_guid(line: str) -> None:
    assert read_guid(in_memory({"guid.txt": line.encode()})) == line.rstrip()


@pytest.mark.parametrize(
    "content", [b"", b"\n", b"a\n\n", b"a\nb\n", b"a b", b"a\0", b"\xc3\xa4", b"x" * 64, b"x" * 99]
)
def test_what_is_no_guid(content: bytes) -> None:
    with pytest.raises(Refused, match=r"^guid\.txt: "):
        read_guid(in_memory({"guid.txt": content}))


def test_guid_without_file_or_memory(tmp_path: Path) -> None:
    with pytest.raises(Refused, match=r"^guid\.txt: cannot be opened"):
        read_guid(in_folder(tmp_path))
    library().allow_allocations(ctypes.c_size_t(0))
    try:
        with pytest.raises(Refused, match=r"^guid\.txt: no memory"):
            read_guid(in_memory({"guid.txt": GUID.encode()}))
    finally:
        library().allow_allocations(ctypes.c_size_t(-1))
