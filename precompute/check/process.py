"""A group of checks in a process of its own: a crash or a hang there is a finding here."""

import json
import os
import signal
import subprocess
import sys
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from .child import AGAIN, END
from .finding import Finding, Skipped
from .groups import GROUPS
from .journal import last_note, notes

# freed and new memory is filled with a pattern by glibc, so that using either shows
ENVIRONMENT = {"MALLOC_PERTURB_": "165", "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
HANGS = 2  # in a group, then it is left
LAST = 0.25  # of the patience: a call that takes all of it hangs
SLOW = "slow"


@dataclass(frozen=True)
class Result:
    """Of a group: what was found, the checks that were made, those that were not."""

    findings: tuple[Finding, ...]
    made: tuple[str, ...]
    skipped: tuple[Skipped, ...]


def run_group(folder: Path, group: str, steps: int, patience: float) -> Result:
    """The checks of GROUPS[group] of the unpacked FMU; patience: s for all of them.

    After a crash the checks that are left go on in a new process.
    """
    findings: list[Finding] = []
    made: list[str] = []
    skipped: list[Skipped] = []
    hangs = 0
    names = [check.name for check in GROUPS[group]]
    with TemporaryDirectory(prefix="check", ignore_cleanup_errors=True) as place:
        work = Path(place)
        while True:
            end = _run(work, [str(folder), str(work), group, str(steps), *made], patience)
            current = _read(work / "results", findings, made, skipped)
            if end is None and current == END:
                break
            if end is None and current == AGAIN:
                continue
            end = end or "ended the process by itself"
            if end == SLOW and current in names:
                hangs += 1
                why = f"it took longer than {patience:g} s; give it more by --patience"
                skipped.append(Skipped(current, why))
                if hangs >= HANGS:
                    break
                continue
            what = last_note(work / "journal")
            place_of_it = f" in {what}" if what else ""
            if current in names:
                crash = GROUPS[group][names.index(current)].crash
                hung = end.startswith("no answer")
                hangs += hung
                name = "hang" if hung and crash == "crash" else crash
                findings.append(Finding(name, f"{end}{place_of_it}, in the check {current}"))
            else:
                findings.append(Finding("crash", f"{end}{place_of_it}"))
                break
            if hangs >= HANGS:
                break
    not_made = [name for name in names if name not in made]
    skipped += [Skipped(name, "the FMU crashes, hangs or is slow too often") for name in not_made]
    left_out = {skip.check for skip in skipped}
    return Result(
        tuple(dict.fromkeys(findings)), tuple(name for name in made if name not in left_out), tuple(skipped)
    )


def _run(work: Path, arguments: list[str], patience: float) -> str | None:
    """None where the process ended well, SLOW where its calls return but take too long, else how it ended."""
    (work / "results").write_text("", encoding="utf-8")
    with (work / "said").open("wb") as said:
        process = subprocess.Popen(
            [sys.executable, "-m", "precompute.check.child", *arguments],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=said,
            cwd=work,
            env={**os.environ, **ENVIRONMENT, "PYTHONPATH": _search_path(), **_temporary(work)},
        )
        hangs = True
        try:
            _wait(process, (1 - LAST) * patience)
            for _ in range(2):  # where the machine is busy a call that hangs may have begun late
                before = notes(work / "journal")
                _wait(process, LAST * patience)
                if hangs := notes(work / "journal") == before:
                    break
        finally:  # also where the user breaks it off
            if (code := process.poll()) is None:
                process.kill()
                process.wait()
        if code is None:
            return f"no answer for {patience:g} s" if hangs else SLOW
    if code == 0:
        return None
    text = (work / "said").read_text(encoding="utf-8", errors="replace").strip()
    words = f" ({text.splitlines()[-1].strip()})" if text else ""
    if code < 0:
        return f"crashed with {signal.Signals(-code).name}{words}"
    return f"ended the process with exit code {code}{words}"


def _wait(process: "subprocess.Popen[bytes]", seconds: float) -> None:
    """Until it has ended, or not longer than that."""
    with suppress(subprocess.TimeoutExpired):
        process.wait(seconds)


def _temporary(work: Path) -> dict[str, str]:
    """What a process leaves behind that crashes or is ended goes with the folder of its group."""
    return dict.fromkeys(("TMPDIR", "TEMP", "TMP"), str(work))


def _search_path() -> str:
    """Where this package lies, before what the user has."""
    own = str(Path(__file__).parents[2])
    return os.pathsep.join([own, *filter(None, [os.environ.get("PYTHONPATH")])])


def _read(results: Path, findings: list[Finding], made: list[str], skipped: list[Skipped]) -> str:
    """Add what the process told; gives the check it was at."""
    current = ""
    for text in results.read_text(encoding="utf-8").splitlines():
        try:
            line = json.loads(text)
        except ValueError:
            continue  # it was being written
        if "check" in line:
            current = line["check"]
            made += [current] * (current not in (END, AGAIN))
        elif "finding" in line:
            findings.append(Finding(line["finding"], line["got"]))
        else:
            skipped.append(Skipped(line["skipped"], line["why"]))
    return current
