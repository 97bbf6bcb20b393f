"""Libraries of the native twin: which platforms there are, where they are found, what is said where not."""

import sys
from importlib.metadata import distribution
from pathlib import Path

import pytest

from fmu_src import native_library, toolchain
from fmu_src.native_library import cache_folder, native_libraries
from fmu_src.toolchain import (
    PLATFORMS,
    ToolchainError,
    compile_library,
    host_platform,
    library_name,
    native_sources,
    platforms_of,
    universal_binary,
)

HOST = host_platform()


@pytest.fixture
def nowhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """No library in the package, an empty cache; gives the cache's folder."""
    monkeypatch.setattr(native_library, "PACKAGED", tmp_path / "package")
    for name in ("XDG_CACHE_HOME", "LOCALAPPDATA", "HOME"):
        monkeypatch.setenv(name, str(tmp_path / "cache"))
    return cache_folder()


@pytest.fixture
def no_compiler(monkeypatch: pytest.MonkeyPatch) -> None:
    """As where ziglang is not installed."""
    monkeypatch.setitem(sys.modules, "ziglang", None)  # type: ignore[arg-type]  # None: it cannot be imported


def put(folder: Path, *platforms: str) -> dict[str, Path]:
    """Files that stand for libraries: finding them does not look inside."""
    libraries = {platform: folder / platform / library_name(platform) for platform in platforms}
    for library in libraries.values():
        library.parent.mkdir(parents=True)
        library.write_bytes(b"a library")
    return libraries


def test_platforms_by_name() -> None:
    assert platforms_of("all", "X") == ("linux64", "win64", "darwin64", "aarch64-linux")
    assert platforms_of("aarch64-linux, win64", "X") == ("win64", "aarch64-linux")
    for text in ("win32", "linux64,all", "", "linux64,"):
        with pytest.raises(ToolchainError, match=r"^X: got .* expected all, or some of linux64,win64"):
            platforms_of(text, "X")


def test_the_package_brings_the_library_of_its_machine() -> None:
    files = [str(file) for file in distribution("modalfmu").files or ()]
    if not any(file.startswith("fmu_src") for file in files):
        pytest.skip("an editable install, whose library is compiled again when the sources change")
    assert f"fmu_src/binaries/{HOST}/{library_name(str(HOST))}" in files


def test_a_library_is_compiled_once_and_kept(nowhere: Path) -> None:
    told: list[str] = []
    first = native_libraries([str(HOST)], lambda stage, _: told.append(stage))
    assert told == [f"compiling the library for {HOST}"]
    library = first[str(HOST)]
    assert library == nowhere / str(HOST) / library_name(str(HOST))
    assert [path.name for path in library.parent.iterdir()] == [library.name]  # no scratch file left
    written = library.stat().st_mtime_ns
    assert native_libraries([str(HOST)], lambda stage, _: told.append(stage)) == first
    assert native_libraries() == first  # what is there, and only that
    assert len(told) == 1
    assert library.stat().st_mtime_ns == written


def test_the_package_comes_before_the_cache(nowhere: Path, no_compiler: None) -> None:
    cached = put(nowhere, *PLATFORMS)
    assert native_libraries() == cached
    packaged = put(native_library.PACKAGED, str(HOST), "win64")
    assert native_libraries() == cached | packaged
    assert native_libraries(["win64"]) == {"win64": packaged["win64"]}


def test_old_libraries_are_not_found(
    nowhere: Path, no_compiler: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    put(nowhere, *PLATFORMS)
    changed = {**native_sources(), "common.h": b"another text"}
    monkeypatch.setattr(toolchain, "native_sources", lambda: changed)
    with pytest.raises(ToolchainError):
        native_libraries()


def test_without_a_compiler_the_error_says_how_to_get_one(nowhere: Path, no_compiler: None) -> None:
    message = r'the library for win64 is not there.*pip install "modalfmu\[cross\]"$'
    with pytest.raises(ToolchainError, match=message):
        native_libraries(["win64"])
    put(nowhere, "win64")
    with pytest.raises(ToolchainError, match=f"the library for {HOST} is not there"):
        native_libraries()


def test_a_machine_of_another_kind(nowhere: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It builds FMUs for others, with what is there."""
    monkeypatch.setattr(native_library, "host_platform", lambda: None)
    with pytest.raises(ToolchainError, match="--platform linux64,win64,darwin64,aarch64-linux"):
        native_libraries()
    there = put(nowhere, "linux64", "darwin64")
    assert native_libraries() == there


def test_a_fault_of_the_compiler_is_one_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "modalfmu.c").write_text("int broken(void) { return nothing; }\n")
    monkeypatch.setattr(toolchain, "SOURCES", tmp_path)
    library = tmp_path / "out" / "library.so"
    with pytest.raises(
        ToolchainError, match=r"x86_64-linux-gnu.*modalfmu\.c:1:.*undeclared.*nothing"
    ) as info:
        compile_library("linux64", library)
    assert "\n" not in str(info.value)
    assert list((tmp_path / "out").iterdir()) == []


def test_a_cache_that_cannot_be_written(nowhere: Path) -> None:
    nowhere.parent.parent.mkdir(parents=True, exist_ok=True)
    nowhere.parent.write_text("a file where the folder should be")
    with pytest.raises(OSError, match="cache"):
        native_libraries(["linux64"])


def test_a_user_without_a_home(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """What the package brings is found, what has to be kept somewhere is not, and the compiler still runs."""

    def no_home() -> Path:
        raise RuntimeError("Could not determine home directory.")

    for variable in ("HOME", "XDG_CACHE_HOME", "LOCALAPPDATA", "ZIG_GLOBAL_CACHE_DIR"):
        monkeypatch.delenv(variable, raising=False)
    monkeypatch.setattr(Path, "home", no_home)
    packaged = tmp_path / "packaged" / str(HOST) / library_name(str(HOST))
    compile_library(str(HOST), packaged)
    monkeypatch.setattr(native_library, "PACKAGED", tmp_path / "packaged")
    assert native_libraries() == {HOST: packaged}
    monkeypatch.setattr(native_library, "PACKAGED", tmp_path / "nothing")
    with pytest.raises(ToolchainError, match=r"set (XDG_CACHE_HOME|LOCALAPPDATA)"):
        native_libraries()


def test_headers_that_are_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(toolchain, "FMI_HEADERS", ("fmi2NoSuchHeader.h",))
    with pytest.raises(ToolchainError, match="pip install"):
        toolchain.fmi_headers()


def test_parts_of_a_universal_binary() -> None:
    """Bytes 4 … 11 of a Mach-O file are its processor, little-endian; in the table they are big-endian."""
    one, two = (b"\xcf\xfa\xed\xfe" + bytes([k, 0, 0, 1, 3, 0, 0, 0]) + bytes([k]) * 20000 for k in (7, 12))
    whole = universal_binary([one, two])
    assert whole[:8] == bytes.fromhex("cafebabe 00000002")
    assert whole[8:28] == bytes.fromhex("01000007 00000003 00004000 00004e2c 0000000e")
    assert whole[28:48] == bytes.fromhex("0100000c 00000003 0000c000 00004e2c 0000000e")
    assert whole[0x4000 : 0x4000 + len(one)] == one
    assert whole[0xC000 : 0xC000 + len(two)] == two
