"""System files over FMUs that are nothing but a description, and what the command makes of them."""

import zipfile
from collections.abc import Iterable
from pathlib import Path

import pytest
from described_fmus import describe_fmu
from fmpy.ssp.ssd import read_ssd
from lxml import etree

from precompute.cli import main

NS = {
    "ssc": "http://ssp-standard.org/SSP1/SystemStructureCommon",
    "ssd": "http://ssp-standard.org/SSP1/SystemStructureDescription",
    "ssv": "http://ssp-standard.org/SSP1/SystemStructureParameterValues",
}


def system_of(names: Iterable[str], *tables: str) -> str:
    """A system file over NAME.fmu and further tables."""
    components = "".join(f'[[component]]\nname = "{name}"\nfmu = "{name}.fmu"\n' for name in names)
    return '[system]\nname = "s"\n' + components + "\n".join(tables)


def wire(source: str, target: str, more: str = "") -> str:
    return f'[[connection]]\nfrom = "{source}"\nto = "{target}"\n{more}\n'


def packaged(folder: Path, text: str) -> Path:
    """The SSP of a system file that is right."""
    file = folder / "system.toml"
    file.write_text(text, encoding="utf-8")
    path = folder / "s.ssp"
    assert main(["ssp", str(file), "-o", str(path), "--no-certificate"]) == 0
    return path


def structure(path: Path) -> etree._Element:
    """SystemStructure.ssd, valid by FMPy's schema."""
    read_ssd(str(path), validate=True)
    with zipfile.ZipFile(path) as archive:
        return etree.fromstring(archive.read("SystemStructure.ssd"))


def refused(capsys: pytest.CaptureFixture[str], folder: Path, text: str) -> str:
    """The one line that refuses a system file; nothing is written."""
    file = folder / "system.toml"
    file.write_text(text, encoding="utf-8")
    capsys.readouterr()
    assert main(["ssp", str(file), "-o", str(folder / "s.ssp"), "--no-certificate"]) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert not (folder / "s.ssp").exists()
    errors = [line for line in said.err.splitlines() if not line.startswith(("note: ", "warning: "))]
    assert len(errors) == 1, said.err
    return errors[0].removeprefix("error: ").removeprefix(f"{file}: ")


def write_two(folder: Path) -> Path:
    """A folder with two FMUs as of parts, forces in, motions out; one that does not tell its dependencies."""
    for name in ("left", "right"):
        describe_fmu(
            folder / f"{name}.fmu",
            {"tip.force.x": "N", "tip.force.z": "N", "root.motion.x": "m/s2"},
            {"tip.displacement.x": "m", "tip.acceleration.x": "m/s2", "root.reaction.x": "N"},
            depends={
                "tip.displacement.x": [],
                "tip.acceleration.x": ["tip.force.x", "root.motion.x"],
                "root.reaction.x": ["tip.force.x", "root.motion.x"],
            },
            tool="modalfmu",
            others='<ScalarVariable name="mode" valueReference="9" causality="parameter" variability="fixed">'
            '<Integer start="0" min="0" max="3"/></ScalarVariable>'
            '<ScalarVariable name="on" valueReference="9" causality="input" variability="discrete">'
            '<Boolean start="false"/></ScalarVariable>',
        )
    describe_fmu(
        folder / "other.fmu",
        {"x": "mm", "t": "K", "plain": "", "odd": "furlong"},
        {"f": "kN", "temperature": "degC", "number": "", "odder": "furlong", "f_odd": "pond"},
    )
    return folder
