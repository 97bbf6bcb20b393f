"""FMI-LS-REF: experiments with reference results in an FMU, as the layered standard of that name has them.

FMI-LS-REF 1.0.0-beta.1 (Modelica Association, July 2026) says where the files are and what the manifest
tells of them, MA-HS-Experiments (draft of June 2026) what an experiments file holds. Neither says more of the
tables than that they are CSV: here a column `time` and one per variable, by its name, in SI units.
"""

import csv
import io
import posixpath
import zipfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlsplit
from xml.etree import ElementTree as ET

import numpy as np
from numpy.typing import NDArray

from .errors import ModelError
from .experiments import Experiment
from .signals import signals_of

STANDARD = "org.fmi-standard.fmi-ls-ref"
FOLDER = f"extra/{STANDARD}"
MANIFEST = f"{FOLDER}/fmi-ls-manifest.xml"
VERSION = "1.0.0-alpha.1"  # what the text of 1.0.0-beta.1 says the manifest must say
ABOUT = "Layered Standard providing information on related files included in an FMU."  # the schema fixes it
NAMESPACE = "http://fmi-standard.org/fmi-ls-manifest"
EXPERIMENTS_TYPE = "application/x-ma-hs-experiments"
DOCUMENTATION = "documentation/fmi-ls-ref.txt"
EXPERIMENTS = "experiments.exp"
Read = Callable[[str], bytes]
"""The content of a file of the FMU by its name in it."""

UNSTATED = 1e-3  # the tolerance of experiments that state none

TEXT = """\
Reference results of this FMU, in the form of FMI-LS-REF 1.0.0-beta.1
(https://github.com/modelica/fmi-ls-ref): extra/org.fmi-standard.fmi-ls-ref/

  fmi-ls-manifest.xml   what is there
  experiments.exp       start, stop, step size and tolerance of each experiment (MA-HS-Experiments)
  NAME-in.csv           its inputs over time
  NAME-ref.csv          what the outputs must be

Each table has a column `time` in s and one per variable, by its name in modelDescription.xml, in SI units.

To repeat an experiment: set all inputs to the first row in initialization mode; set the inputs of a row,
make the step to the next row, compare the outputs with that row. An input is held over a step. Where
there is an experiment `step`, its inputs are constant, so that any step sizes give the same results.

The tolerance is the largest |output - reference|, as a part of the largest |reference| that an output of
the same unit has in the experiment. The references were not computed by the library of this FMU but by
the equations of the reduced model in Python, from the model in resources/model/.
"""


def write_experiments(experiments: Sequence[Experiment]) -> dict[str, bytes]:
    """Files of the archive by name; none where there are no experiments."""
    if not experiments:
        return {}
    files = {MANIFEST: _manifest(), f"{FOLDER}/{EXPERIMENTS}": _experiments_file(experiments)}
    for e in experiments:
        files[f"{FOLDER}/{e.name}-in.csv"] = _table(e.stimuli)
        files[f"{FOLDER}/{e.name}-ref.csv"] = _table(e.references)
    return {**files, DOCUMENTATION: TEXT.encode()}


def read_experiments(fmu: Path) -> tuple[Experiment, ...]:
    """The experiments that an FMU carries, ours or another's; () where it has no manifest of FMI-LS-REF.

    fmu: the file, or the folder it was unpacked into. Left out: experiments without references, those of
    other kinds than a transient simulation or with files that are not CSV, those that need a parameter file.
    Raises ModelError where a file is damaged or not there.
    """
    try:
        if fmu.is_dir():
            return tuple(_read(_files_of(fmu))) if (fmu / MANIFEST).is_file() else ()
        with zipfile.ZipFile(fmu) as archive:
            return tuple(_read(archive.read)) if MANIFEST in archive.namelist() else ()
    except (OSError, ValueError, KeyError, zipfile.BadZipFile, ET.ParseError) as error:
        raise ModelError(f"{fmu.name}: its reference results cannot be read ({error})") from error


def _files_of(folder: Path) -> Read:
    """The content of the files of an unpacked FMU."""

    def read(name: str) -> bytes:
        if not (folder / name).is_file():
            raise ValueError(f"there is no {name}")
        return (folder / name).read_bytes()

    return read


def _manifest() -> bytes:
    ET.register_namespace("fmi-ls", NAMESPACE)
    root = ET.Element(
        "fmiReferences",
        {
            f"{{{NAMESPACE}}}fmi-ls-name": STANDARD,
            f"{{{NAMESPACE}}}fmi-ls-version": VERSION,
            f"{{{NAMESPACE}}}fmi-ls-description": ABOUT,
        },
    )
    ET.SubElement(
        root,
        "Related",
        type=EXPERIMENTS_TYPE,
        source=EXPERIMENTS,
        role="experiment/validation",
        description="Inputs over time with the outputs that the FMU must give.",
    )
    return _xml(root)


def _experiments_file(experiments: Sequence[Experiment]) -> bytes:
    root = ET.Element("Experiments", name="Reference results", description=f"See {DOCUMENTATION}.")
    for e in experiments:
        one = ET.SubElement(
            root,
            "Experiment",
            name=e.name,
            description=e.description,
            startTime=repr(e.start),
            stopTime=repr(e.stop),
            stepSize=repr(e.step),
            tolerance=repr(e.tolerance),
        )
        ET.SubElement(one, "Stimuli", source=f"{e.name}-in.csv")
        ET.SubElement(one, "References", source=f"{e.name}-ref.csv")
    return _xml(root)


def _xml(root: ET.Element) -> bytes:
    ET.indent(root)
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{ET.tostring(root, encoding="unicode")}\n'.encode()


def _table(signals: NDArray[Any]) -> bytes:
    """Times to the last digit, all else to twelve."""
    names = signals.dtype.names or ()
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(names)
    for row in signals.tolist():
        writer.writerow([repr(row[0]), *(f"{x:.12g}" for x in row[1:])])
    return text.getvalue().encode()


def _read(content: Read) -> Iterator[Experiment]:
    for related in ET.fromstring(content(MANIFEST)).iter("Related"):
        role = related.get("role", "").split("/")[0]
        place = _inside(MANIFEST, related.get("source", ""))
        if role == "experiment" and place is not None:
            for element in ET.fromstring(content(place)).iter("Experiment"):
                yield from _experiment(content, place, element)


def _experiment(content: Read, place: str, element: ET.Element) -> Iterator[Experiment]:
    """start, stop and step are attributes, or those of a TransientSimulation in the schema's latest draft."""
    tables = {}
    for child in element:
        if child.tag in ("Stimuli", "References") and child.get("type", "text/csv") == "text/csv":
            source = _inside(place, child.get("source", ""))
            if source is None:
                return
            tables[child.tag] = _read_table(source, content(source))
        elif child.tag not in ("TransientSimulation", "Annotations"):
            return
    references = tables.get("References")
    if references is None or references.dtype.names == ("time",):
        return
    time = references["time"]
    transient = element.find("TransientSimulation")
    given: Mapping[str, str] = {**element.attrib, **({} if transient is None else transient.attrib)}
    start, stop = float(given.get("startTime", time[0])), float(given.get("stopTime", time[-1]))
    step = float(given.get("stepSize", (stop - start) / max(len(time) - 1, 1)))
    tolerance = float(given.get("tolerance", UNSTATED))
    if not (np.isfinite([start, stop, step, tolerance]).all() and stop > start and step > 0 < tolerance):
        raise ValueError(f"{place}: expected a start before the stop, a step and a tolerance > 0")
    stimuli = tables.get("Stimuli", signals_of(["time"], np.array([[start], [stop]])))
    name, description = given.get("name", ""), given.get("description", "")
    yield Experiment(name, description, start, stop, step, tolerance, stimuli, references)


def _inside(base: str, source: str) -> str | None:
    """The name in the archive of a URI relative to the file `base`; None of what lies elsewhere."""
    uri = urlsplit(source)
    place = posixpath.normpath(posixpath.join(posixpath.dirname(base), unquote(uri.path)))
    outside = uri.scheme or uri.netloc or not uri.path or place.startswith(("..", "/"))
    return None if outside else place


def _read_table(place: str, content: bytes) -> NDArray[Any]:
    rows = [row for row in csv.reader(io.StringIO(content.decode("utf-8-sig"))) if row]
    names = [name.strip() for name in rows[0]] if rows else []
    if names[:1] != ["time"] or len({*names}) < len(names) or len(rows) < 2:
        raise ValueError(f"{place}: expected rows below a header that begins with time, each name once")
    if any(len(row) != len(names) for row in rows):
        raise ValueError(f"{place}: expected {len(names)} cells in each row")
    table = np.array(rows[1:], dtype=float)
    if not np.isfinite(table).all() or (np.diff(table[:, 0]) < 0).any():
        raise ValueError(f"{place}: expected finite numbers, times in ascending order")
    return signals_of(names, table)
