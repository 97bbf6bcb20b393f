"""fmuResourceLocation as a path, by the rules of both kinds of systems."""

import ctypes
import sys
from pathlib import Path, PurePosixPath, PureWindowsPath

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from native_reader import Refused, in_folder, library, location, read_guid

unhurried = settings(deadline=None)  # the first example may compile the library
EVERYWHERE = [
    ("file:///a/b/resources", "/a/b/resources"),
    ("file:///a/b/resources/", "/a/b/resources"),
    ("file:///a/b/resources//", "/a/b/resources"),
    ("file:/a/b", "/a/b"),
    ("file://localhost/a/b", "/a/b"),
    ("FILE://LocalHost/a/b", "/a/b"),
    ("file:///with%20space", "/with space"),
    ("file:///with space", "/with space"),
    ("file:///%C3%A4%e2%82%ac", "/ä€"),
    ("file:///ä€", "/ä€"),
    ("file:///100%25/%2525", "/100%/%25"),
    ("file:///a+b/#1/?x&y;z=1", "/a+b/#1/?x&y;z=1"),
    ("file:///a%2Fb", "/a/b"),
    ("file:///localhost/a", "/localhost/a"),
    ("file:///", ""),
    ("/a/b c/%20", "/a/b c/%20"),  # a path is no URI
    ("/a/b/", "/a/b"),
    ("relative/path", "relative/path"),
    ("file_1/x", "file_1/x"),
]
POSIX = [
    ("file:////a/b", "/a/b"),
    ("file://localhost//a", "/a"),
    ("file:///C:/a", "/C:/a"),
    ("file:///a\\", "/a\\"),
    ("C:\\a", "C:\\a"),
]
WINDOWS = [
    ("file:///C:/a/b", "C:/a/b"),
    ("file:/C:/a/b", "C:/a/b"),
    ("file:C:/a/b", "C:/a/b"),
    ("file://C:/a/b", "C:/a/b"),
    ("file:////C:/a/b", "C:/a/b"),
    ("file://localhost/c:/a/b/", "c:/a/b"),
    ("file:///C|/a", "C:/a"),
    ("file:///C%3A/a%20b", "C:/a b"),
    ("file:///C:\\a\\b\\", "C:\\a\\b"),
    ("file:///C:", "C:"),
    ("file:///C:/", "C:"),
    ("file://server/share/x", "//server/share/x"),
    ("file:////server/share/x/", "//server/share/x"),
    ("file://///server/share/x", "//server/share/x"),
    ("file:\\\\server\\share", "\\\\server\\share"),
    ("C:\\a b\\", "C:\\a b"),
    ("c:/a", "c:/a"),
    ("\\\\server\\share\\x", "\\\\server\\share\\x"),
]
REFUSED = [
    (None, "empty"),
    ("", "empty"),
    ("http://host/a", "expected a file URI"),
    ("https:///a", "expected a file URI"),
    ("jar:file:/a", "expected a file URI"),
    ("files:///a", "expected a file URI"),
    ("file:", "no absolute path"),
    ("file://", "no absolute path"),
    ("file://localhost", "no absolute path"),
    ("file:a/b", "no absolute path"),
    ("file:///a%", "two digits"),
    ("file:///a%2", "two digits"),
    ("file:///a%2x", "two digits"),
    ("file:///a%x2", "two digits"),
    ("file:///a%00b", "two digits"),
]


@pytest.mark.parametrize(
    ("uri", "windows", "path"),
    [(u, w, p) for u, p in EVERYWHERE for w in (False, True)]
    + [(u, False, p) for u, p in POSIX]
    + [(u, True, p) for u, p in WINDOWS],
)
def test_paths(uri: str, windows: bool, path: str) -> None:
    assert location(uri, windows) == path


@pytest.mark.parametrize(("uri", "reason"), REFUSED)
@pytest.mark.parametrize("windows", [False, True])
def test_what_names_no_folder(uri: str | None, windows: bool, reason: str) -> None:
    with pytest.raises(Refused, match=reason):
        location(uri, windows)


@pytest.mark.parametrize("uri", ["file://server/share/x", "file://server", "file://localhost.de/x"])
def test_hosts_are_reached_on_windows_only(uri: str) -> None:
    with pytest.raises(Refused, match="names a host"):
        location(uri, windows=False)
    assert location(uri, windows=True) == uri.removeprefix("file:")


def test_bytes_that_are_no_utf8_are_the_system_s_own() -> None:
    assert location(b"file:///a\xff/%ff", windows=False) == "/a\udcff/\udcff"


names = st.text(st.characters(codec="utf-8", exclude_characters="/\\\0"), min_size=1, max_size=8).filter(
    lambda name: name not in (".", "..")
)


@unhurried
@given(st.lists(names, min_size=1, max_size=4))
def test_every_path_comes_back_from_its_uri(parts: list[str]) -> None:
    posix = PurePosixPath("/", *parts)
    assert location(posix.as_uri(), windows=False) == str(posix)
    windows = PureWindowsPath("C:/", *[part.replace(":", "_") for part in parts])
    assert location(windows.as_uri(), windows=True) == windows.as_posix()


def test_without_memory() -> None:
    library().allow_allocations(ctypes.c_size_t(0))
    try:
        with pytest.raises(Refused, match="no memory"):
            location("file:///a", windows=False)
    finally:
        library().allow_allocations(ctypes.c_size_t(-1))
    assert location("file:///a", windows=False) == "/a"


@pytest.mark.parametrize("folder", ["plain", "with space", "ä€ und %20", "#1?&"])
def test_the_files_of_a_folder_are_found_by_its_uri(tmp_path: Path, folder: str) -> None:
    resources = tmp_path / folder
    resources.mkdir()
    (resources / "guid.txt").write_text("{found}\n")
    for uri in (resources.as_uri(), f"{resources.as_uri()}/", str(resources)):
        path = location(uri, windows=sys.platform == "win32")
        assert read_guid(in_folder(path.encode())) == "{found}"
