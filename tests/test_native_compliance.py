"""What checkers of FMI 2.0 say of the native FMUs of all ready parts."""

import subprocess
import sys
import zipfile
from collections.abc import Callable, Mapping
from functools import cache, partial
from pathlib import Path

import fmpy
import numpy as np
import pytest
from driven import driven
from examples import everything, oscillator, two_ports
from fmpy.validation import validate_fmu
from lxml import etree
from ready_parts import reduction
from structures import gaps_static, moved_gaps_static

from fmu_src.archive import write_archive
from fmu_src.native_fmu import build_native_fmu
from fmu_src.runtime.model import Port, ReducedModel

SCHEMA = Path(fmpy.__file__).parent / "schema" / "fmi2" / "fmi2ModelDescription.xsd"
FMUTOOL = [sys.executable, "-m", "fmu_manipulation_toolbox.cli.fmutool"]


def ready_model(name: str) -> ReducedModel:
    return reduction(name).model


def no_outputs() -> ReducedModel:
    ports = (Port("tip", ("force.x",), ()),)
    return oscillator("no_outputs", ports=ports, C=np.zeros((0, 1)))


MODELS: Mapping[str, Callable[[], ReducedModel]] = {
    **{name: partial(ready_model, name) for name in ("bracket", "cantilever", "ring", "tuning_fork")},
    "two_ports": two_ports,
    "static": gaps_static,
    "everything": everything,
    "no_outputs": no_outputs,
    "driven": driven,
    "driven static": moved_gaps_static,
}


@pytest.fixture(scope="module", params=MODELS)
def fmu(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    model = MODELS[request.param]()
    return build_native_fmu(model, tmp_path_factory.mktemp("checked") / f"{model.name}.fmu")


def description(fmu: Path) -> bytes:
    with zipfile.ZipFile(fmu) as archive:
        return archive.read("modelDescription.xml")


def with_description(fmu: Path, target: Path, old: bytes, new: bytes) -> Path:
    """A copy with one text of modelDescription.xml replaced."""
    with zipfile.ZipFile(fmu) as archive:
        files = {name: archive.read(name) for name in archive.namelist()}
    assert old in files["modelDescription.xml"]
    files["modelDescription.xml"] = files["modelDescription.xml"].replace(old, new, 1)
    write_archive(target, files)
    return target


@cache
def schema() -> etree.XMLSchema:
    return etree.XMLSchema(etree.parse(SCHEMA))


def fmutool(fmu: Path) -> list[str]:
    """The lines of its report that are neither progress nor praise."""
    done = subprocess.run(
        [*FMUTOOL, "-input", str(fmu), "-check"],
        capture_output=True,
        text=True,
        encoding="utf-8",
        timeout=120,
    )
    lines = (done.stdout + done.stderr).splitlines()
    assert any("compliant" in line or "validate" in line for line in lines), lines  # it has checked
    return [line for line in lines if not line.startswith("INFO")]


def test_fmpy_finds_nothing(fmu: Path) -> None:
    assert validate_fmu(str(fmu)) == []


def test_fmutool_finds_nothing(fmu: Path) -> None:
    assert fmutool(fmu) == []


def test_valid_by_the_schema(fmu: Path) -> None:
    schema().assertValid(etree.fromstring(description(fmu)))


def test_both_interfaces_are_there(fmu: Path) -> None:
    root = etree.fromstring(description(fmu))
    assert [root[k].tag for k in (0, 1)] == ["ModelExchange", "CoSimulation"]
    identifiers = {root[k].get("modelIdentifier") for k in (0, 1)}
    assert identifiers == {root.get("modelName")}


def test_checkers_see_mistakes(tmp_path: Path) -> None:
    """The control: what each of them is for."""
    fmu = build_native_fmu(two_ports(), tmp_path / "good.fmu")
    unknown_unit = with_description(fmu, tmp_path / "unit.fmu", b'unit="N"', b'unit="kN"')
    assert validate_fmu(str(unknown_unit)) != []
    state = with_description(fmu, tmp_path / "state.fmu", b'derivative="', b'derivative="9')
    assert fmutool(state) != []
    order = with_description(
        fmu, tmp_path / "order.fmu", b"<ModelStructure>", b"<Structure/><ModelStructure>"
    )
    assert not schema().validate(etree.fromstring(description(order)))
