"""The native FMU on every platform that can be executed here, and from its sources: the same numbers."""

import json
import os
import re
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path
from urllib.parse import quote

import numpy as np
import pytest
from examples import PRELUDE, oscillator, run_master, two_ports
from exports import exports

from fmu_src import toolchain
from fmu_src.native_fmu import build_native_fmu
from fmu_src.runtime.instance import Instance
from fmu_src.runtime.model import Floats, ReducedModel
from fmu_src.toolchain import (
    FLAGS,
    PLATFORMS,
    compile_library,
    fmi_headers,
    library_name,
)

NATIVE = Path(__file__).parent / "native"
STEPS = 40
WARNINGS = ("-std=c11", "-Wall", "-Wextra", "-Werror", "-pedantic")
SHARED = ("-O2", "-shared", "-fPIC", "-fvisibility=hidden")
AARCH64_LIBRARIES = Path("/usr/aarch64-linux-gnu")  # of Debian's libc6-arm64-cross


def tool(name: str) -> str:
    """The path of a program; the test is skipped where it is not installed."""
    places = os.pathsep.join([os.environ["PATH"], "/usr/lib/wine", str(Path(sys.executable).parent)])
    found = shutil.which(name, path=places)
    if found is None:
        pytest.skip(f"{name} is not installed")
    return found


def run(*command: object, **environment: str) -> str:
    done = subprocess.run(
        [*map(str, command)],
        capture_output=True,
        text=True,
        encoding="utf-8",
        timeout=300,
        env={**os.environ, **environment},
    )
    assert done.returncode == 0, f"{done.stdout[-2000:]}\n{done.stderr[-4000:]}"
    return done.stdout


def expected(model: ReducedModel) -> Floats:
    """What the master of tests/native/master.h reads, by the Python twin; (STEPS, Reals)."""
    instance, time, rows = Instance(model), 0.0, []
    instance.initialising = False
    inputs = [*range(len(model.inputs))]
    for k in range(STEPS):
        instance.set_inputs(inputs, [((7 * k + 3 * j) % 11 - 5) / 4 for j in inputs])
        h = (0.001, 0.02, 0.3, 0.0625)[k % 4]
        assert instance.advance(time, h) is None
        time += h
        rows.append(instance.reals().copy())
    return np.array(rows)


def numbers(text: str) -> Floats:
    return np.array([[float(word) for word in line.split()] for line in text.splitlines()])


def assert_same(found: Floats, reference: Floats) -> None:
    """Column by column to 1e-12 of its peak: the modes of the tests are damped, roundings die down."""
    assert found.shape == reference.shape
    peak = np.abs(reference).max(axis=0)
    assert (np.abs(found - reference) <= 1e-12 * peak).all(), np.abs(found - reference).max(axis=0) / peak


def damped() -> ReducedModel:
    """Two ports; no rigid mode, in which roundings would add up."""
    return two_ports(lam=np.array([3.0, 7.0, 30.0, 30.0, 400.0, 9000.0]))


@pytest.fixture(scope="module")
def libraries(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("libraries")
    found = {platform: folder / library_name(platform) for platform in PLATFORMS}
    for platform, library in found.items():
        compile_library(platform, library)
    return found


@pytest.fixture(scope="module")
def unpacked(libraries: dict[str, Path], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The FMU of `damped` for all platforms, extracted to a folder whose name is a trap."""
    folder = tmp_path_factory.mktemp("unpacked")
    fmu = build_native_fmu(damped(), folder / "two_ports.fmu", libraries=libraries)
    place = folder / "Prüfling 100 % #1"
    with zipfile.ZipFile(fmu) as archive:
        archive.extractall(place)
    return place


def guid(unpacked: Path) -> str:
    return (unpacked / "resources" / "guid.txt").read_text().strip()


def cross_compiled(platform: str, folder: Path) -> Path:
    """The harness for this platform; with the library's flags the compiler's own parts serve both."""
    program = folder / "harness.exe"
    flags = [flag for flag in FLAGS if flag not in ("-shared", "-fPIC", "-fvisibility=hidden")]
    flags += ["-target", PLATFORMS[platform].targets[0], "-I", str(fmi_headers())]
    flags += [] if platform == "win64" else ["-ldl"]
    run(sys.executable, "-m", "ziglang", "cc", *flags, NATIVE / "harness.c", "-o", program)
    return program


def master_run(
    launch: list[object],
    unpacked: Path,
    library: Path,
    model: ReducedModel,
    location: str,
    **environment: str,
) -> Floats:
    sizes = (len(model.inputs), Instance(model).layout.size, STEPS)
    return numbers(run(*launch, library, guid(unpacked), location, *sizes, **environment))


def native_run(library: Path, unpacked: Path, tmp_path: Path, location: str) -> Floats:
    program = tmp_path / "harness"
    run(tool("gcc"), *WARNINGS, "-I", fmi_headers(), NATIVE / "harness.c", "-o", program, "-ldl")
    return master_run([program], unpacked, library, damped(), location)


# --- the libraries


def test_linux64(unpacked: Path, tmp_path: Path) -> None:
    library = unpacked / "binaries" / "linux64" / "two_ports.so"
    found = native_run(library, unpacked, tmp_path, (unpacked / "resources").as_uri())
    reference = expected(damped())
    assert_same(found, reference)
    with pytest.raises(AssertionError):
        assert_same(found * (1 + 3e-12), reference)


def test_win64_under_wine(unpacked: Path, tmp_path: Path) -> None:
    wine = tool("wine64")
    program = cross_compiled("win64", tmp_path)
    library = unpacked / "binaries" / "win64" / "two_ports.dll"
    plain = tmp_path / "two_ports.dll"  # LoadLibraryA takes the name in the system's code page
    shutil.copy(library, plain)
    location = f"file:///Z:{quote(str(unpacked / 'resources'))}"
    quiet = {"WINEDEBUG": "-all", "WINEPREFIX": str(tmp_path / "wine")}
    found = master_run([wine, program], unpacked, plain, damped(), location, **quiet)
    assert_same(found, expected(damped()))


def test_aarch64_linux_under_qemu(unpacked: Path, tmp_path: Path) -> None:
    qemu = tool("qemu-aarch64-static")
    if not AARCH64_LIBRARIES.is_dir():
        pytest.skip("libc6-arm64-cross is not installed")
    program = cross_compiled("aarch64-linux", tmp_path)
    library = unpacked / "binaries" / "aarch64-linux" / "two_ports.so"
    found = master_run(
        [qemu, "-L", AARCH64_LIBRARIES, program],
        unpacked,
        library,
        damped(),
        (unpacked / "resources").as_uri(),
    )
    assert_same(found, expected(damped()))


@pytest.mark.parametrize("platform", PLATFORMS)
def test_only_the_functions_of_fmi_are_exported(platform: str, libraries: dict[str, Path]) -> None:
    header = (fmi_headers() / "fmi2Functions.h").read_text()
    declared = set(re.findall(r"FMI2_Export \w+\s+(fmi2\w+);", header))
    assert len(declared) == 44
    found = exports(libraries[platform].read_bytes())
    assert [sorted(names) for names in found] == [sorted(declared)] * len(PLATFORMS[platform].targets)


@pytest.mark.parametrize("platform", ["linux64", "aarch64-linux"])
def test_glibc_2_17_is_enough(platform: str, libraries: dict[str, Path]) -> None:
    """The versions that the library names are those of its symbols."""
    named = re.findall(rb"GLIBC_(\d+)\.(\d+)", libraries[platform].read_bytes())
    assert named
    assert max((int(major), int(minor)) for major, minor in named) <= (2, 17)


def test_a_library_depends_on_its_sources_only(
    libraries: dict[str, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The folders it was compiled in and from leave nothing in it."""
    sources = tmp_path / "sources elsewhere"
    shutil.copytree(toolchain.SOURCES, sources)
    monkeypatch.setattr(toolchain, "SOURCES", sources)
    for platform, library in libraries.items():
        again = tmp_path / "elsewhere" / platform / "library"
        compile_library(platform, again)
        assert again.read_bytes() == library.read_bytes(), platform
    with (sources / "common.c").open("a") as file:  # negative control
        file.write("__attribute__((used)) static const char where[] = __FILE__;\n")
    compile_library("linux64", tmp_path / "with its place")
    assert b"elsewhere" in (tmp_path / "with its place").read_bytes()


# --- the sources


def test_sources_compile_without_a_warning(unpacked: Path, tmp_path: Path) -> None:
    library = tmp_path / "two_ports.so"
    run(tool("gcc"), *WARNINGS, *SHARED, unpacked / "sources" / "modalfmu.c", "-o", library, "-lm")
    found = native_run(library, unpacked, tmp_path, (unpacked / "resources").as_uri())
    assert_same(found, expected(damped()))


def test_sources_call_no_function_by_a_shared_name(unpacked: Path, tmp_path: Path) -> None:
    """A host may share another FMU's functions: nothing that gcc leaves to the loader bears an fmi2 name."""
    library = tmp_path / "two_ports.so"
    run(tool("gcc"), *SHARED, "-std=c11", unpacked / "sources" / "modalfmu.c", "-o", library, "-lm")
    left = run(tool("readelf"), "--relocs", "--wide", library)
    assert "fmi2" not in left
    assert "sin" in left  # and the names are there to be seen


def test_embedded_model_needs_no_file(unpacked: Path, tmp_path: Path) -> None:
    library = tmp_path / "two_ports.so"
    source = unpacked / "sources" / "modalfmu.c"
    run(tool("gcc"), *WARNINGS, *SHARED, "-DMODALFMU_EMBEDDED_MODEL", source, "-o", library, "-lm")
    found = native_run(library, unpacked, tmp_path, "file:///there/is/no/such/folder")
    assert_same(found, expected(damped()))
    needed = run(tool("nm"), "-D", "--undefined-only", library)
    assert "fopen" not in needed
    assert "sin" in needed  # and the names are there to be seen


def test_two_parts_in_one_program(tmp_path: Path) -> None:
    gcc = tool("gcc")
    models = [oscillator("soft", 1.0), oscillator("stiff", 400.0)]
    objects, guids = [], []
    for model in models:
        fmu = build_native_fmu(model, tmp_path / f"{model.name}.fmu", libraries={})
        folder = tmp_path / model.name
        with zipfile.ZipFile(fmu) as archive:
            archive.extractall(folder)
        objects.append(tmp_path / f"{model.name}.o")
        guids.append(guid(folder))
        flags = ("-DMODALFMU_EMBEDDED_MODEL", f"-DFMI2_FUNCTION_PREFIX={model.name}_")
        run(gcc, *WARNINGS, *flags, "-c", folder / "sources" / "modalfmu.c", "-o", objects[-1])
    program = tmp_path / "two_parts"
    run(gcc, *WARNINGS, "-I", fmi_headers(), NATIVE / "two_parts.c", *objects, "-o", program, "-lm")
    found = numbers(run(program, *guids, 1, Instance(models[0]).layout.size, STEPS))
    soft, stiff = np.split(found, 2)
    assert_same(soft, expected(models[0]))
    assert_same(stiff, expected(models[1]))


MASTER = """
part = Part(sys.argv[1])
part.initialise()
t, rows = 0.0, []
for k in range(int(sys.argv[2])):
    h = (0.001, 0.02, 0.3, 0.0625)[k % 4]
    part.fmu.setReal([0, 1, 2], [((7 * k + 3 * j) % 11 - 5) / 4 for j in range(3)])
    part.step(t, h)
    t += h
    rows.append(part.everything().tolist())
print(json.dumps(rows))
"""


def test_fmpy_compiles_what_it_then_runs(tmp_path: Path) -> None:
    """An FMU that carries its sources only."""
    environment = {"PATH": os.pathsep.join([str(Path(tool("cmake")).parent), os.environ["PATH"]])}
    tool("gcc")
    tool("make")
    fmu = build_native_fmu(damped(), tmp_path / "two_ports.fmu", libraries={})
    with zipfile.ZipFile(fmu) as archive:
        assert not [name for name in archive.namelist() if name.startswith("binaries/")]
    command = (sys.executable, "-m", "fmpy", "compile", "--all-warnings", "--warning-as-error", fmu)
    run(*command, **environment)
    found = json.loads(run_master(PRELUDE + MASTER, fmu, STEPS, cwd=tmp_path))
    assert_same(np.array(found), expected(damped()))
