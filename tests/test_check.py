"""`modalfmu check`: what it finds in our FMUs, what it refuses in one line, crashes and hangs as findings."""

import dataclasses
import json
import re
import shutil
import stat
import struct
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path
from shutil import which
from tempfile import TemporaryDirectory

import pytest
from examples import everything, two_ports

import precompute.check
from fmu_src.archive import write_archive
from fmu_src.native_fmu import build_native_fmu
from fmu_src.python_fmu import build_python_fmu
from fmu_src.toolchain import host_platform
from precompute.check.arguments import LARGE, resource_location
from precompute.check.child import FAULT
from precompute.check.demands import DEMANDS
from precompute.check.description import read_description
from precompute.check.driver import Fmu, Refused, binary
from precompute.check.finding import Finding, Skipped
from precompute.check.groups import GROUPS
from precompute.check.library import CALLS
from precompute.check.process import run_group
from precompute.check.report import as_json
from precompute.check.runs import difference, fresh_run
from precompute.check.units import exponents
from precompute.check.unpack import unpack
from precompute.check.verdict import Verdict, check_fmu
from precompute.cli import main

CC = which("gcc") if host_platform() == "linux64" else None
PACKAGE = Path(precompute.check.__file__).parent
DESCRIPTION = "modelDescription.xml"
EVERY = [check.name for checks in GROUPS.values() for check in checks]
# what pythonfmu 0.7.0's library does, and no slave can mend: it compares no GUID, dies of a URI that does not
# begin with file:/// or has escaped characters, keeps the address of the callbacks' struct, leaves the
# pointer of a freed state, and holds on to some kilobytes of each instance
PYTHONFMU = {"guid-mismatch-accepted", "resource-location", "pointer-kept", "state-free", "memory-growth"}


@pytest.fixture(scope="module")
def good(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build_native_fmu(two_ports(), tmp_path_factory.mktemp("good") / "two_ports.fmu")


def content(fmu: Path) -> dict[str, bytes]:
    with zipfile.ZipFile(fmu) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def changed(fmu: Path, target: Path, old: str, new: str) -> Path:
    """A copy with a text of its description replaced."""
    files = content(fmu)
    text = files[DESCRIPTION].decode()
    assert old in text
    write_archive(target, {**files, DESCRIPTION: text.replace(old, new).encode()})
    return target


def names(verdict: Verdict) -> set[str]:
    return {finding.name for finding in verdict.findings}


# --- our own


def test_nothing_is_found_in_the_native_twin(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    fmu = build_native_fmu(everything(), tmp_path / "native.fmu")
    assert main(["check", str(fmu), "--json"]) == 0
    said = capsys.readouterr()
    assert said.out.isascii()  # also where the terminal knows no more
    assert said.err == ""
    told = json.loads(said.out)
    assert told["findings"] == []
    assert told["good"]
    left_out = {skip["check"]: skip["why"] for skip in told["not_checked"]}
    assert not [why for why in left_out.values() if FAULT in why]
    not_ours = {"null-callbacks", "set-fixed", "string-kept", "time-variable", "output-derivative of order 3"}
    assert {*left_out} == not_ours
    assert sorted([*told["checked"], *left_out]) == sorted(EVERY)


def test_what_is_found_in_the_python_twin_is_pythonfmus(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It crashes at two URIs and without its callbacks; the checks behind these are made all the same."""
    temporary = tmp_path / "temporary"
    temporary.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(temporary))
    monkeypatch.setenv("TMPDIR", str(temporary))
    verdict = check_fmu(build_python_fmu(two_ports(), tmp_path / "python.fmu"), steps=8)
    assert names(verdict) - {"nan-accepted", "dependencies-unused"} == PYTHONFMU
    assert sum("crashed with SIGSEGV" in finding.got for finding in verdict.findings) == 3
    assert not [skip for skip in verdict.skipped if FAULT in skip.why]
    assert sorted([*verdict.made, *(skip.check for skip in verdict.skipped)]) == sorted(EVERY)
    assert not list(temporary.iterdir())  # neither of processes that crashed


def test_a_plain_slave_of_pythonfmu_is_told_its_faults(tmp_path: Path) -> None:
    """Its own state holds registered variables only, its description has no InitialUnknowns."""
    script = tmp_path / "counter.py"
    script.write_text(
        "from pythonfmu import Fmi2Causality, Fmi2Slave, Real\n\n\n"
        "class Counter(Fmi2Slave):\n"
        "    def __init__(self, **kwargs):\n"
        "        super().__init__(**kwargs)\n"
        "        self.x, self.y, self._steps = 0.0, 0.0, 0\n"
        '        self.register_variable(Real("x", causality=Fmi2Causality.input, start=0.0))\n'
        '        self.register_variable(Real("y", causality=Fmi2Causality.output))\n\n'
        "    def do_step(self, current_time, step_size):\n"
        "        self._steps += 1\n"
        "        self.y = self.x + self._steps\n"
        "        return True\n"
    )
    command = [sys.executable, "-m", "pythonfmu", "build", "-f", str(script), "-d", str(tmp_path)]
    subprocess.run([*command, "--handle-state"], check=True, capture_output=True, timeout=120)
    found = names(check_fmu(tmp_path / "Counter.fmu", groups=("state", "calls")))
    assert {"model-description", "state-restore", "time-going-back", "step-zero", "past-stop-time"} <= found
    assert "legal-call-refused" not in found


# --- what is no such FMU


def not_a_zip(path: Path, good: Path) -> None:
    path.write_bytes(b"no zip at all")


def truncated(path: Path, good: Path) -> None:
    path.write_bytes(good.read_bytes()[: good.stat().st_size // 2])


def damaged(path: Path, good: Path) -> None:
    """One byte of the first file's compressed data."""
    raw = bytearray(good.read_bytes())
    raw[200] ^= 0xFF
    path.write_bytes(raw)


def with_entry(name: str, data: bytes = b"x", attributes: int = 0) -> Callable[[Path, Path], None]:
    def make(path: Path, good: Path) -> None:
        path.write_bytes(good.read_bytes())
        with zipfile.ZipFile(path, "a") as archive:
            entry = zipfile.ZipInfo(name)
            entry.external_attr = attributes << 16
            archive.writestr(entry, data)

    return make


def trap(path: Path, good: Path) -> None:
    """A file that says it is five thousand times as large as what it takes in the zip."""
    path.write_bytes(good.read_bytes())
    with zipfile.ZipFile(path, "a", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("resources/zeros", bytes(200_000))
    raw = bytearray(path.read_bytes())
    at = raw.rindex(b"resources/zeros") - 46  # its record in the directory
    (packed,) = struct.unpack_from("<I", raw, at + 20)
    struct.pack_into("<I", raw, at + 24, 5000 * packed)
    path.write_bytes(raw)


def described(old: str, new: str) -> Callable[[Path, Path], None]:
    return lambda path, good: void(changed(good, path, old, new))


def void(_: object) -> None:
    """What a maker of a file gives is not used."""


def without(part: str) -> Callable[[Path, Path], None]:
    def make(path: Path, good: Path) -> None:
        write_archive(path, {name: data for name, data in content(good).items() if part not in name})

    return make


def nothing(path: Path, good: Path) -> None:
    """No file."""


BAD: Mapping[str, tuple[Callable[[Path, Path], None], str]] = {
    "no file": (nothing, "there is no such file"),
    "a folder": (lambda path, good: path.mkdir(), "cannot be unpacked"),
    "no zip": (not_a_zip, "got no whole zip"),
    "empty": (lambda path, good: void(path.write_bytes(b"")), "got no whole zip"),
    "truncated": (truncated, "got no whole zip"),
    "damaged": (damaged, "zip"),
    "a path that climbs": (with_entry("../../climbed"), "leads out of the FMU"),
    "one that climbs by backslashes": (with_entry("..\\climbed"), "leads out of the FMU"),
    "an absolute path": (with_entry("/climbed"), "leads out of the FMU"),
    "a drive": (with_entry("C:climbed"), "leads out of the FMU"),
    "a link": (with_entry("resources/link", b"/etc", stat.S_IFLNK | 0o777), "got a link"),
    "a trap": (trap, "more than fits an FMU"),
    "no description": (without(DESCRIPTION), f"without {DESCRIPTION}"),
    "no binary": (without("binaries/"), "got binaries for no platform, expected"),
    "another platform": (without("binaries/linux64"), "expected"),
    "no XML": (described("<ModelVariables>", "<ModelVariables"), "cannot be read"),
    "an encoding that nobody knows": (described("UTF-8", "UTF-0"), "cannot be read"),
    "FMI 1": (described('fmiVersion="2.0"', 'fmiVersion="1.0"'), "got FMI 1.0, expected FMI 2.0"),
    "FMI 3": (described('fmiVersion="2.0"', 'fmiVersion="3.0"'), "got FMI 3.0, expected FMI 2.0"),
    "model exchange": (described("CoSimulation", "NoSimulation"), "model exchange only"),
}


@pytest.mark.parametrize("case", BAD)
def test_what_is_no_such_fmu_is_refused_in_one_line(
    case: str, good: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    make, words = BAD[case]
    path = tmp_path / "inner" / "bad.fmu"
    path.parent.mkdir()
    make(path, good)
    assert main(["check", str(path)]) == 2
    said = capsys.readouterr()
    assert said.out == ""
    (line,) = said.err.splitlines()
    assert line.startswith(f"error: {path}: ")
    assert words in line
    assert not list(tmp_path.rglob("*climbed*"))


# --- the command


def test_findings_as_a_table(good: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A FMU that gives no instance, for its resources have another GUID: nothing else can be asked."""
    bad = changed(good, tmp_path / "bad.fmu", ' guid="{', ' guid="{0')
    assert main(["check", str(bad)]) == 1
    said = capsys.readouterr().out
    assert re.search(r"^error +instantiation +fmi2Instantiate gave NULL", said, re.MULTILINE)
    assert "not checked: reset (the FMU does not get through its first step)" in said
    assert "bad.fmu: 1 error; " in said


def test_a_finding_for_programs() -> None:
    finding = Finding("instantiation", "fmi2Instantiate gave NULL")
    told = as_json(Verdict(Path("bad.fmu"), (finding,), ("functions",), (Skipped("reset", "no instance"),)))
    demand = dataclasses.asdict(DEMANDS["instantiation"])
    assert told["findings"] == [{"name": "instantiation", "got": finding.got, **demand}]
    assert told["not_checked"] == [{"check": "reset", "why": "no instance"}]
    assert not told["good"]
    assert as_json(Verdict(Path("good.fmu"), (), (), ()))["good"]


@pytest.mark.parametrize("option", [("--steps", "3"), ("--patience", "0"), ("--patience", "nan")])
def test_options_out_of_range(
    option: tuple[str, str], good: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["check", str(good), *option]) == 2
    assert f"{option[0]}: got" in capsys.readouterr().err


# --- crashes, hangs, and what comes after them


@cache
def compiled(source: str) -> bytes:
    """A library for this machine."""
    if CC is None:
        pytest.skip("compiled by gcc for linux64")
    with TemporaryDirectory() as place:
        code, library = Path(place, "it.c"), Path(place, "it.so")
        code.write_text(source)
        subprocess.run([CC, "-shared", "-fPIC", code, "-o", library], check=True, timeout=120)
        return library.read_bytes()


STUB = """
#include <stddef.h>
#include <stdlib.h>
const char *fmi2GetVersion(void) { return "2.0"; }
const char *fmi2GetTypesPlatform(void) { return "default"; }
void fmi2FreeInstance(void *c) { if (c) %s; }
void *fmi2Instantiate(void) { static int one; return &one; }
"""


@pytest.mark.parametrize(
    ("deed", "name", "words"),
    [
        ("abort()", "crash", "crashed with SIGABRT in fmi2FreeInstance, in the check first-step"),
        ("for (;;)", "hang", "no answer for 4 s in fmi2FreeInstance, in the check first-step"),
        ("exit(0)", "crash", "ended the process by itself in fmi2FreeInstance, in the check first-step"),
        ("_Exit(3)", "crash", "ended the process with exit code 3 in fmi2FreeInstance"),
    ],
)
def test_the_end_of_the_process_is_a_finding(
    deed: str, name: str, words: str, good: Path, tmp_path: Path
) -> None:
    unpack(good, tmp_path / "fmu")
    description = read_description(tmp_path / "fmu")
    calls = "\n".join(f"int fmi2{call}(void) {{ return 0; }}" for call in CALLS)
    binary(tmp_path / "fmu", description).write_bytes(compiled(STUB % deed + calls))
    result = run_group(tmp_path / "fmu", "begin", 4, 4.0)
    assert [finding.name for finding in result.findings] == [name]
    assert words in result.findings[0].got
    assert result.made == ("functions", "first-step", "unload")


def test_what_is_slow_does_not_hang(good: Path, tmp_path: Path) -> None:
    """Every call returns, but all of them take longer than the patience; what is left is checked."""
    unpack(good, tmp_path / "fmu")
    calls = "\n".join(f"int fmi2{call}(void) {{ usleep(700000); return 0; }}" for call in CALLS)
    source = "#include <unistd.h>\n" + STUB % "usleep(1)" + calls
    binary(tmp_path / "fmu", read_description(tmp_path / "fmu")).write_bytes(compiled(source))
    result = run_group(tmp_path / "fmu", "begin", 4, 4.0)
    assert result.findings == ()
    assert [(skip.check, skip.why[:30]) for skip in result.skipped] == [
        ("first-step", "it took longer than 4 s; give ")
    ]
    assert result.made == ("functions", "unload")


def test_one_instance_for_each_process_where_there_can_be_no_more(good: Path, tmp_path: Path) -> None:
    old = "<CoSimulation "
    once = changed(good, tmp_path / "once.fmu", old, f'{old}canBeInstantiatedOnlyOncePerProcess="true" ')
    unpack(once, tmp_path / "fmu")
    result = run_group(tmp_path / "fmu", "state", 4, 60.0)
    assert result.findings == ()
    assert {"state-restore", "state-inputs", "serialise-elsewhere"} <= {*result.made}
    assert {skip.check: skip.why for skip in result.skipped} == {
        "serialise": "canBeInstantiatedOnlyOncePerProcess is declared"
    }


# --- its parts


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("N.m", {"kg": 1, "m": 2, "s": -2}),
        ("kg.m2/s2", {"kg": 1, "m": 2, "s": -2}),
        ("m/s^2", {"m": 1, "s": -2}),
        ("1/s", {"s": -1}),
        ("W/(m2.K)", {"kg": 1, "s": -3, "K": -1}),
        ("rad/s", {"s": -1}),
        ("V.A", {"kg": 1, "m": 2, "s": -3}),
        ("N.s/m", {"kg": 1, "s": -1}),
        ("Pa.m2/N", {}),
        ("mm", None),
        ("degC", None),
        ("m/s/s", None),
        ("", None),
    ],
)
def test_exponents_of_a_units_name(name: str, expected: dict[str, int] | None) -> None:
    assert exponents(name) == expected


def test_runs_differ_where_they_do(good: Path, tmp_path: Path) -> None:
    """The control of every comparison: other inputs, a missing step; and the same is the same."""
    unpack(good, tmp_path / "fmu")
    fmu = Fmu(tmp_path / "fmu", read_description(tmp_path / "fmu"), 8, lambda call: None)
    run = fresh_run(fmu, 8)
    assert difference(run, fresh_run(fmu, 8)) is None
    assert difference(run, run[:-1]) == "it ended after 7 steps instead of 8"
    assert "after step 1" in (difference(run, fresh_run(fmu, 8, phase=1.0)) or "")
    with pytest.raises(Refused, match=r"fmi2SetReal gave fmi2Error: .*it cannot be set"):
        fmu.slave().set({next(v for v in fmu.description.variables if v.causality == "output"): 1.0})


def test_a_stop_time_that_never_comes(good: Path, tmp_path: Path) -> None:
    """Some exporters write the largest double."""
    unpack(good, tmp_path / "fmu")
    far = dataclasses.replace(read_description(tmp_path / "fmu"), stop=sys.float_info.max, step=1e-9)
    assert Fmu(tmp_path / "fmu", far, 24, lambda call: None).steps == 24


def test_large_resources_are_found_at_another_place(good: Path, tmp_path: Path) -> None:
    """Where a copy of them would be too much."""
    unpack(good, tmp_path / "fmu")
    with (tmp_path / "fmu" / "resources" / "large").open("wb") as sparse:
        sparse.truncate(LARGE)
    fmu = Fmu(tmp_path / "fmu", read_description(tmp_path / "fmu"), 4, lambda call: None)
    assert list(resource_location("escaped characters").run(fmu)) == []


def test_indices_of_no_variables_hinder_what_follows_them(good: Path, tmp_path: Path) -> None:
    for old, new in ((' derivative="', ' derivative="9'), ('<Unknown index="', '<Unknown index="9')):
        bad = changed(good, tmp_path / "bad.fmu", old, new)
        unpack(bad, tmp_path / "fmu")
        description = read_description(tmp_path / "fmu")
        hindered = {
            check.name for checks in GROUPS.values() for check in checks if check.hindrance(description)
        }
        assert {"derivative", "dependencies at initialisation"} <= hindered
        assert sum(name.startswith("directional-derivative") for name in hindered) == 2
        shutil.rmtree(tmp_path / "fmu")


def test_an_fmu_without_reals_is_not_asked_for_them(good: Path, tmp_path: Path) -> None:
    """A call for no variables is legal in every mode that has the call."""
    unpack(good, tmp_path / "fmu")
    bare = dataclasses.replace(read_description(tmp_path / "fmu"), variables=())
    asked = {check.name for check in GROUPS["calls"] if check.hindrance(bare) is None}
    left_out = {check.name for check in GROUPS["calls"]} - asked
    assert {name.split()[0] for name in left_out} == {"set-after-terminate", "get-before-initialisation"}


def test_every_finding_has_its_demand_and_its_line_in_the_readme() -> None:
    text = "".join(path.read_text(encoding="utf-8") for path in PACKAGE.glob("*.py"))
    used = {*re.findall(r'Finding\(\s*"([a-z-]+)"', text)}
    assert len(used) > 50
    assert used <= DEMANDS.keys()
    rows = re.findall(r"^\| `([a-z-]+)` \| (\w+) \| ([^|]+) \| (.*) \| (.*) \|$", _readme(), re.MULTILINE)
    assert {row[0]: row[1:] for row in rows} == {
        name: (d.severity, d.clause, d.demands, d.mend) for name, d in DEMANDS.items()
    }
    assert len(rows) == len(DEMANDS)


def _readme() -> str:
    return (PACKAGE / "README.md").read_text(encoding="utf-8")
