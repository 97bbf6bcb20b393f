"""The archive of the native FMU: what is in it, and what its identity is made of."""

import re
import zipfile
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np
import pytest
from examples import oscillator, two_ports
from fmpy.validation import validate_fmu

from fmu_src.embedded_model import embedded_model
from fmu_src.native_fmu import TWIN, build_native_fmu
from fmu_src.runtime.model import Port, ReducedModel
from fmu_src.runtime.resources import read_model
from fmu_src.toolchain import PLATFORMS, SOURCES, native_sources


@pytest.fixture
def libraries(tmp_path: Path) -> dict[str, Path]:
    """Files that stand for libraries: the packaging does not look inside."""
    found = {}
    for platform, recipe in PLATFORMS.items():
        found[platform] = tmp_path / f"{platform}{recipe.ending}"
        found[platform].write_bytes(platform.encode())
    return found


def contents(fmu: Path) -> dict[str, bytes]:
    with zipfile.ZipFile(fmu) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def test_everything_is_in_its_place(libraries: dict[str, Path], tmp_path: Path) -> None:
    extra = {"documentation/index.html": b"a page", "extra/shape.npy": b"numbers"}
    found = contents(build_native_fmu(two_ports(), tmp_path / "two_ports.fmu", extra, libraries))
    binaries = {name: content for name, content in found.items() if name.startswith("binaries/")}
    assert binaries == {
        "binaries/linux64/two_ports.so": b"linux64",
        "binaries/win64/two_ports.dll": b"win64",
        "binaries/darwin64/two_ports.dylib": b"darwin64",
        "binaries/aarch64-linux/two_ports.so": b"aarch64-linux",
    }
    assert extra.items() <= found.items()
    sources = {name.removeprefix("sources/") for name in found if name.startswith("sources/")}
    ours = {path.name for path in SOURCES.iterdir()}
    headers = {"fmi2Functions.h", "fmi2FunctionTypes.h", "fmi2TypesPlatform.h"}
    assert sources == ours | headers | {"embedded_model.c", "README.txt"}
    # whatever a source includes is beside it, or of the C library, or of the target's system
    included = {
        name for name in ours for name in re.findall(r'#include "(.+)"', native_sources()[name].decode())
    }
    assert included <= sources
    assert [name for name in found if "externalDependencies" in name] == []
    (tmp_path / "resources").mkdir()
    for name, content in found.items():
        if name.startswith("resources/model/"):
            (tmp_path / "resources" / Path(name).name).write_bytes(content)
    back = read_model(tmp_path / "resources")
    np.testing.assert_array_equal(back.C, two_ports().C)


def test_licences(libraries: dict[str, Path], tmp_path: Path) -> None:
    found = contents(build_native_fmu(two_ports(), tmp_path / "two_ports.fmu", libraries=libraries))
    assert b"MIT" in found["documentation/licenses/license.txt"]
    fmi = found["documentation/licenses/fmi-headers.txt"].decode()
    assert "Modelica Association" in fmi
    assert "IN NO EVENT SHALL" in fmi
    assert b"mingw-w64" in found["documentation/licenses/mingw-w64.txt"]
    del libraries["win64"]
    without = contents(build_native_fmu(two_ports(), tmp_path / "two_ports.fmu", libraries=libraries))
    assert "documentation/licenses/mingw-w64.txt" not in without


def test_same_content_same_bytes(libraries: dict[str, Path], tmp_path: Path) -> None:
    def built(model: ReducedModel, extra: dict[str, bytes] | None = None) -> bytes:
        return build_native_fmu(model, tmp_path / "one.fmu", extra, libraries).read_bytes()

    first = built(two_ports())
    assert built(two_ports()) == first
    guids = set()
    for model, extra in (
        (two_ports(), None),
        (two_ports(alpha=0.31), None),
        (two_ports(description="another text"), None),
        (two_ports(), {"extra/note.txt": b""}),
    ):
        built(model, extra)
        guids.add(guid_everywhere(tmp_path / "one.fmu"))
    libraries["linux64"].write_bytes(b"another library")
    built(two_ports())
    guids.add(guid_everywhere(tmp_path / "one.fmu"))
    assert len(guids) == 5


def guid_everywhere(fmu: Path) -> str:
    """The one GUID of the description, the resources and the embedded model."""
    found = contents(fmu)
    guid = ET.fromstring(found["modelDescription.xml"]).attrib["guid"]
    assert re.fullmatch(r"\{[0-9a-f]{8}(-[0-9a-f]{4}){3}-[0-9a-f]{12}\}", guid)
    assert found["resources/guid.txt"].decode() == f"{guid}\n"
    assert f'embedded_guid[] = "{guid}";' in found["sources/embedded_model.c"].decode()
    return guid


def test_declared_capabilities(libraries: dict[str, Path], tmp_path: Path) -> None:
    fmu = build_native_fmu(two_ports(), tmp_path / "two_ports.fmu", libraries=libraries)
    root = ET.fromstring(contents(fmu)["modelDescription.xml"])
    both = {
        "modelIdentifier": "two_ports",
        "canNotUseMemoryManagementFunctions": "false",
        "canGetAndSetFMUstate": "true",
        "canSerializeFMUstate": "true",
        "providesDirectionalDerivative": "true",
    }
    exchange, simulation = root[0], root[1]
    assert (exchange.tag, simulation.tag) == ("ModelExchange", "CoSimulation")
    assert exchange.attrib == {**both, "completedIntegratorStepNotNeeded": "true"}
    assert simulation.attrib == {
        **both,
        "canHandleVariableCommunicationStepSize": "true",
        "canInterpolateInputs": "true",
        "maxOutputDerivativeOrder": "2",
    }
    for interface in (exchange, simulation):
        assert [file.attrib["name"] for file in interface.findall("SourceFiles/File")] == ["modalfmu.c"]


def test_log_categories_are_those_of_the_code() -> None:
    code = native_sources()["component.c"].decode()
    assert list(TWIN.log_categories) == re.findall(r'\{"(log\w+)", LOG_', code)


def test_fmpy_finds_nothing(tmp_path: Path) -> None:
    lam = np.array([3.0, 7.0, 30.0, 30.0, 400.0, 9000.0])
    for model in (two_ports(), two_ports("settled", lam=lam, initial="static"), oscillator()):
        assert validate_fmu(str(build_native_fmu(model, tmp_path / f"{model.name}.fmu"))) == []


def test_embedded_numbers_are_exact() -> None:
    extremes = np.array([0.0, 5e-324, 0.1, 1e22, 1.7976931348623157e308])
    shape = np.array([[-0.1, 1e-5, 2.5, 1 / 3, -1e300]])
    model = oscillator(
        lam=extremes,
        D_rest=np.diag(extremes),
        B=shape.T,
        C=np.repeat(shape, 3, axis=0),
        R=np.array([[0.1], [-5e-324], [3.0]]),
        R_in=np.array([[1 / 3]]),
    )
    text = embedded_model(model, "{guid}")
    for name in ("lam", "D_rest", "B", "C", "R", "R_in"):
        array = getattr(model, name)
        entries = re.search(rf"double embedded_{name}\[\] = \{{(.*?)\}};", text, re.DOTALL)
        assert entries is not None
        words = [word.strip() for word in entries[1].split(",") if word.strip()]
        assert [float(word) for word in words] == array.ravel().tolist()
        assert all("." in word or "e" in word for word in words)  # no integers, which may overflow in C
    assert max(map(len, text.splitlines())) <= 110


def test_embedded_arrays_are_never_empty() -> None:
    """C knows no array without entries."""
    text = embedded_model(
        oscillator(B=np.zeros((1, 0)), C=np.zeros((1, 1)), ports=(Port("tip", (), ("velocity.x",)),)),
        "{guid}",
    )
    assert "embedded_inputs[] = {\n    0,\n};" in text
    assert "embedded_B[] = {\n    0,\n};" in text
    assert ".m = 0," in text
    assert ".laws = embedded_laws," in text
