"""What an FMU says of itself: its variables, checked against what the user names."""

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
from typing import Any
from zipfile import BadZipFile, ZipFile

import fmpy

from .errors import ModalFmuError

_PRESCRIBED = re.compile(r"\w+\.prescribed_(displacement|rotation)\.[xyz]")
_MOTION = re.compile(
    r"\w+\.start_(displacement|rotation|velocity|angular_velocity)\.[xyz]|modes\.(amplitude|velocity)\[\d+\]"
)
NUMBERS = ("Real", "Integer", "Boolean", "Enumeration")


@dataclass(frozen=True)
class Face:
    """The FMI 2.0 co-simulation face of an FMU.

    description: FMPy's ModelDescription; variables: name → FMPy's ScalarVariable, numbers only;
    stop, step: of the DefaultExperiment in s, None where it has none.
    """

    path: Path
    description: Any
    variables: Mapping[str, Any]
    start: float
    stop: float | None
    step: float | None

    @property
    def is_ours(self) -> bool:
        """An FMU of a part, or of a spring and damper, that this program wrote."""
        return (self.description.generationTool or "").startswith("modalfmu")

    @property
    def inputs(self) -> list[str]:
        """Names of the inputs."""
        return [name for name, v in self.variables.items() if v.causality == "input"]

    @property
    def outputs(self) -> list[str]:
        """Names of the outputs."""
        return [name for name, v in self.variables.items() if v.causality == "output"]

    @property
    def motions(self) -> list[str]:
        """What sets a part in motion without an input: start values of modes and of moved ports."""
        return [*filter(_MOTION.fullmatch, self.variables)]

    @property
    def amplitudes(self) -> list[str]:
        """x of the deformed shape: what is prescribed at ports, then modes.amplitude[1] and so on.

        None where it is not ours.
        """
        modes = (f"modes.amplitude[{i}]" for i in range(1, len(self.variables) + 1))
        return [*filter(_PRESCRIBED.fullmatch, self.variables), *filter(self.variables.__contains__, modes)]

    def unit(self, name: str) -> str:
        """The unit of a variable, empty where it has none."""
        return self.variables[name].unit or ""


def read_face(path: Path) -> Face:
    """The face of an FMU that runs here.

    Raises ModalFmuError as `describe` does, and where there is no binary for this platform.
    """
    face = describe(path)
    platforms = fmpy.supported_platforms(str(path))
    if fmpy.platform not in platforms:
        there = ", ".join(name for name in platforms if name != "c-code") or "no platform"
        raise ModalFmuError(
            f"{path}: got binaries for {there}, expected {fmpy.platform}; "
            f"build it with --platform {fmpy.platform}"
        )
    return face


def describe(path: Path) -> Face:
    """The face of an FMU, wherever it runs.

    Raises ModalFmuError, beginning with the file's name: no such file, no FMU, one that is not FMI 2.0
    co-simulation.
    """
    try:
        with ZipFile(path) as archive:
            archive.getinfo("modelDescription.xml")
        description = fmpy.read_model_description(str(path), validate=False)
        for variable in description.modelVariables:
            _number(variable.min), _number(variable.max)
        experiment = description.defaultExperiment
        start, stop, step = (
            _number(experiment and getattr(experiment, key)) for key in ("startTime", "stopTime", "stepSize")
        )
    except OSError as error:
        raise ModalFmuError(f"{path}: cannot be read ({error.strerror or error})") from None
    except (BadZipFile, KeyError):
        raise ModalFmuError(f"{path}: got no FMU (a zip with modelDescription.xml); is it whole?") from None
    except Exception as error:  # noqa: BLE001  FMPy and its XML reader raise anything on a damaged description
        raise ModalFmuError(f"{path}: its modelDescription.xml cannot be read ({error})") from None
    if description.fmiVersion != "2.0" or description.coSimulation is None:
        kind = "co-simulation" if description.coSimulation else "model exchange"
        raise ModalFmuError(
            f"{path}: got FMI {description.fmiVersion} {kind}, expected FMI 2.0 co-simulation"
        )
    variables = {v.name: v for v in description.modelVariables if v.type in NUMBERS}
    return Face(path, description, variables, start or 0.0, stop, step)


def read_settings(settings: Sequence[str], face: Face) -> dict[str, float]:
    """name=value … → values of inputs, parameters and initial states.

    Raises ModalFmuError: not name=value, an unknown or calculated variable, a value out of its range.
    """
    values: dict[str, float] = {}
    for setting in settings:
        name, equals, text = setting.partition("=")
        name = name.strip()
        if not equals:
            raise ModalFmuError(f"--set: got {setting!r}, expected name=value")
        values[name] = checked_setting("--set", name, text, face)
    return values


def checked_setting(where: str, name: str, text: str, face: Face) -> float:
    """The value that the variable `name` is to start with; an int for an Integer.

    Raises ModalFmuError, beginning with `where`, as `read_settings` does.
    """
    settable = [known for known, v in face.variables.items() if _settable(v)]
    if name in face.variables and name not in settable:
        raise ModalFmuError(f"{where}: {name!r} is calculated by the FMU; {_choice(name, settable)}")
    check_known(f"{where}: the FMU has no variable {name!r}", name, settable)
    return _checked(where, text, face.variables[name])


def check_known(what: str, name: str, known: Iterable[str]) -> None:
    """Raises ModalFmuError, `what` and the nearest known name, where `name` is not one of them."""
    known = list(known)
    if name not in known:
        raise ModalFmuError(f"{what}; {_choice(name, known)}")


def _choice(name: str, known: list[str]) -> str:
    near = get_close_matches(name, known, n=1, cutoff=0.0)
    return f"did you mean {near[0]!r}?" if near else "it has none that can be set"


def _settable(variable: Any) -> bool:
    return variable.causality == "input" or (
        variable.variability != "constant" and variable.initial in ("exact", "approx")
    )


def _checked(where: str, text: str, variable: Any) -> float:
    what = f"{where}: {variable.name}: got {text.strip()!r}"
    try:
        value = float(text)
    except ValueError:
        raise ModalFmuError(f"{what}, expected a number") from None
    low, high = (0.0, 1.0) if variable.type == "Boolean" else (_number(variable.min), _number(variable.max))
    if not math.isfinite(value):
        raise ModalFmuError(f"{what}, expected a finite number")
    if variable.type != "Real" and value != int(value):
        raise ModalFmuError(f"{what}, expected a whole number")
    if low is not None and value < low:
        raise ModalFmuError(f"{what}, expected at least {low:g}")
    if high is not None and value > high:
        raise ModalFmuError(f"{what}, expected at most {high:g}")
    return value if variable.type == "Real" else int(value)


def _number(text: Any) -> float | None:
    """None where there is none, or an infinite one: no bound."""
    value = None if text is None else float(text)
    return value if value is not None and math.isfinite(value) else None
