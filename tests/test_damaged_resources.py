"""Resources that are not as they were written: both twins refuse them, whatever is damaged."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from examples import oscillator
from model_files import HEADER, assert_read, assert_same, files_of, with_text, written
from native_reader import Refused, in_memory, read_guid, read_native

from fmu_src.runtime.errors import ModelError
from fmu_src.runtime.resources import ARRAYS, read_model

FILES = ["model.json", "model.sha256", *(f"{key}.npy" for key in ARRAYS)]


def flips(content: bytes) -> Iterator[bytes]:
    """The content with one bit changed, for every bit."""
    for bit in range(8 * len(content)):
        damaged = bytearray(content)
        damaged[bit // 8] ^= 1 << bit % 8
        yield bytes(damaged)


@pytest.mark.parametrize("name", FILES)
def test_every_flipped_bit_and_every_cut_is_refused(tmp_path: Path, name: str) -> None:
    files = files_of(oscillator(description="ü"))
    content = files[f"model/{name}"]
    assert_read(files, tmp_path, oscillator())
    for damaged in (*flips(content), *(content[:length] for length in range(len(content)))):
        changed = {**files, f"model/{name}": damaged}
        with pytest.raises(Refused, match=r"^model/.*: its checksum is not that of model\."):
            read_native(in_memory(changed))
        written({f"model/{name}": damaged}, tmp_path)
        with pytest.raises(ModelError, match=r"^[^/]*: its checksum is not that of model\."):
            read_model(tmp_path / "model")


def test_every_flipped_bit_of_the_guid_gives_another_or_none() -> None:
    guid = "{01234567-89ab-cdef-0123-456789abcdef}"
    for damaged in flips(f"{guid}\n".encode()):
        try:
            found = read_guid(in_memory({"guid.txt": damaged}))
        except Refused:
            continue
        assert found != guid


def test_headers_with_a_right_checksum_are_judged_alike(tmp_path: Path) -> None:
    """Of a flip or a cut that came before the checksum: it is refused by both, or both read the same."""
    files = files_of(oscillator(description="ü"))
    text = files[HEADER]
    folder = written(files, tmp_path)
    accepted = 0
    for damaged in (*flips(text), *(text[:length] for length in range(len(text)))):
        changed = with_text(files, damaged)
        written({name: changed[name] for name in (HEADER, "model/model.sha256")}, tmp_path)
        try:
            model = read_model(folder)
        except ModelError:
            with pytest.raises(Refused):
                read_native(in_memory(changed))
        else:
            assert_same(read_native(in_memory(changed)), model)
            accepted += 1
    # white space, the description, units, digits of alpha, letters of names: of nine changes per byte a few
    assert 0 < accepted < 2 * len(text)
