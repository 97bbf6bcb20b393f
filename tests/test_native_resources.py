"""The resource reader of the native twin: it reads what the Python twin reads."""

import ctypes
import json
import math
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from driven import driven
from examples import EVERYTHING, everything, legal, oscillator, two_ports
from hypothesis import given, settings
from hypothesis import strategies as st
from model_files import (
    HEADER,
    assert_read,
    assert_refused,
    assert_same,
    files_of,
    saved,
    with_array,
    with_header,
    with_text,
    written,
)
from native_reader import Refused, in_folder, in_memory, library, read_guid, read_native

from fmu_src.runtime.kinds import (
    ALL_INPUTS,
    ALL_OUTPUTS,
    BASE,
    ENERGY,
    GRAVITY,
    ROWS,
    inputs_of,
    outputs_of,
)
from fmu_src.runtime.model import Port, ReducedModel
from fmu_src.runtime.resources import ARRAYS
from precompute.spring_damper import spring_damper

GUID = "{01234567-89ab-cdef-0123-456789abcdef}"
ALLOCATIONS = 13  # model.json, its checksum, its values, its ports' names, the model, eight arrays
INPUTS, OUTPUTS = (*ALL_INPUTS,), (*ALL_OUTPUTS,)

MODELS: list[Callable[[], ReducedModel]] = [
    oscillator,
    two_ports,
    lambda: oscillator(initial="static", description='ü€\U0001f600 "\\ \t\n'),
    lambda: two_ports(ports=(Port("in_1", INPUTS[:3], ()), Port("out", (), OUTPUTS[:5]))),
    lambda: oscillator(ports=(Port("only_in", ("force.z",), ()),), C=np.zeros((0, 1))),
    lambda: oscillator(ports=(Port("only_out", (), ("velocity.y",)),), B=np.zeros((1, 0)), C=np.ones((1, 1))),
    lambda: oscillator(ports=(Port("none", (), ()), Port("tip", ("force.x",), OUTPUTS[3:6]))),
    everything,
    lambda: everything(residual=False, coupled=False),
    driven,
    lambda: driven(k=1, dashpots=False),
    lambda: with_ports(EVERYTHING[::-1]),
    lambda: with_ports((Port("energy", (), ("strain",)),)),  # no row of C and R
    lambda: with_ports((Port("all", INPUTS, OUTPUTS), Port("base", (*BASE,), ()))),
    lambda: with_ports((Port("gravity", (*GRAVITY,), ()), Port("energy", (), (*ENERGY,)))),
    lambda: spring_damper("no_modes", {"x": 500.0, "rz": 2.0}, {"x": 3.0}),
]


def with_ports(ports: tuple[Port, ...]) -> ReducedModel:
    """Two modes; every array random and full where it may be."""
    rng = np.random.default_rng(3)
    m = sum(len(port.inputs) for port in ports)
    k = sum("motion" in key for port in ports for key in port.inputs)
    s = sum(ROWS[outputs_of(port.name)[key].law] for port in ports for key in port.outputs)
    S, D, M_s, K_s = (rng.standard_normal((size, size)) for size in (m, k + 2, k, k))
    return ReducedModel(
        name="ports",
        description="",
        alpha=0.0,
        beta=0.0,
        D_rest=D @ D.T,
        R=rng.standard_normal((s, m)),
        R_in=S @ S.T,
        ports=ports,
        M_s=M_s @ M_s.T,
        K_s=K_s @ K_s.T,
        **legal(
            ports,
            np.array([*[0.0] * k, 1.0, 2.0]),
            rng.standard_normal((k + 2, m)),
            rng.standard_normal((s, k + 2)),
        ),
    )


@pytest.mark.parametrize("build", MODELS)
def test_both_twins_read_the_same(tmp_path: Path, build: Callable[[], ReducedModel]) -> None:
    assert_read(files_of(build()), tmp_path, build())
    assert_same(read_native(in_folder(tmp_path)), build())


finite = st.floats(allow_nan=False, allow_infinity=False)
positive = st.floats(0, allow_infinity=False)
names = st.from_regex(r"[A-Za-z_][A-Za-z0-9_]{0,20}", fullmatch=True)


def some_of(known: Mapping[str, object]) -> st.SearchStrategy[list[str]]:
    return st.lists(st.sampled_from([*known]), unique=True) if known else st.just([])


ports = st.lists(
    st.one_of(names, st.sampled_from(["gravity", "base", "energy"])).flatmap(
        lambda name: st.tuples(st.just(name), some_of(inputs_of(name)), some_of(outputs_of(name)))
    ),
    min_size=1,
    max_size=4,
    unique_by=lambda port: port[0],
).filter(lambda found: any(port[1] or port[2] for port in found))


@settings(max_examples=150, deadline=None)
@given(st.data(), ports, positive, positive, st.sampled_from(["rest", "static"]), st.booleans())
def test_models_of_every_kind(
    data: st.DataObject,
    found: list[tuple[str, list[str], list[str]]],
    alpha: float,
    beta: float,
    initial: Any,
    residual: bool,
) -> None:
    modes = sorted(data.draw(st.lists(positive, min_size=1, max_size=5)))
    listed = tuple(Port(name, tuple(inputs), tuple(outputs)) for name, inputs, outputs in found)
    k = sum("motion" in key for port in listed for key in port.inputs)
    n, m = k + len(modes), sum(len(port[1]) for port in found)
    s = sum(ROWS[outputs_of(name)[key].law] for name, _, outputs in found for key in outputs)

    def array(*shape: int, of: st.SearchStrategy[float] = finite) -> Any:
        size = math.prod(shape)
        seen = data.draw(st.lists(of, min_size=min(size, 6), max_size=min(size, 6)))
        return np.resize(np.array(seen, dtype=float), shape) if size else np.zeros(shape)

    def symmetric(n: int) -> Any:
        half = np.tril(array(n, n), -1)
        return half + half.T + np.diag(array(n, of=positive))

    model = ReducedModel(
        name=data.draw(names),
        description=data.draw(st.text(st.characters(min_codepoint=32, max_codepoint=0xD7FF))),
        alpha=alpha,
        beta=beta,
        D_rest=symmetric(n),
        R=array(s, m),
        R_in=symmetric(m),
        ports=listed,
        initial=initial if modes[0] > 0 else "rest",
        residual=residual,
        M_s=symmetric(k),
        K_s=symmetric(k),
        **legal(listed, np.array([*[0.0] * k, *modes]), array(n, m), array(s, n)),
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


@pytest.mark.parametrize(
    ("port", "key", "variable"),
    [
        ("gravity", "outputs", "displacement.x"),
        ("gravity", "inputs", "force.x"),
        ("gravity", "inputs", "acceleration.x"),
        ("base", "outputs", "acceleration.x"),
        ("base", "inputs", "x"),
        ("energy", "inputs", "force.x"),
        ("energy", "outputs", "displacement.x"),
        ("tip", "inputs", "x"),
        ("tip", "inputs", "acceleration.x"),
        ("tip", "inputs", "pressure.x"),
        ("tip", "inputs", "absolute_acceleration.x"),
        ("tip", "inputs", "reaction.x"),
        ("tip", "outputs", "pressure"),
        ("tip", "outputs", "kinetic"),
        ("tip", "outputs", "stress.yx"),
        ("tip", "outputs", "mises"),
        ("Gravity", "inputs", "x"),
    ],
)
def test_variables_of_other_ports(tmp_path: Path, port: str, key: str, variable: str) -> None:
    """The ports gravity, base and energy have variables of their own, and these alone."""
    listed = {"name": port, "inputs": [], "outputs": [], key: [variable]}
    files = with_header(files_of(two_ports()), ports=[listed])
    assert_refused(files, tmp_path, rf"^model/model\.json: port {port}: {key}: expected ", f"^port {port}: ")


@pytest.mark.parametrize(
    ("key", "place", "value"),
    [("R_in", (5, 6), 1e-9), ("R_in", (1, 0), 1.0), ("R_in", (3, 3), np.nan), ("R", (3, 2), np.inf)],
)
def test_feed_through_that_no_model_has(tmp_path: Path, key: str, place: Any, value: float) -> None:
    array = getattr(everything(), key).copy()
    array[place] += value
    files = with_array(files_of(everything()), key, saved(array))
    assert_refused(files, tmp_path, rf"^model/{key}\.npy: ", f"^{key}: ")


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
