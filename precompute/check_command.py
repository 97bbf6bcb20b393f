"""The command that asks an FMU whether it does what FMI 2.0 demands: check."""

import json
import math
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from .console import progress, show
from .errors import ModalFmuError


def check(
    fmu: Path,
    /,
    *,
    json_: Annotated[bool, Parameter(name="--json", negative="")] = False,
    steps: int = 24,
    patience: float = 60.0,
) -> int:
    """Drive an FMU through legal and illegal calls and say where it departs from FMI 2.0.

    The FMU runs in processes of its own, so one that crashes or hangs is a finding too. It is code of
    whoever made it: check only what you would run.

    Exit code 0: no errors and no warnings, 1: some, 2: not such an FMU.

    Example:

        modalfmu check cantilever.fmu

    Parameters
    ----------
    fmu
        Any FMI 2.0 co-simulation FMU with a binary for this platform.
    json_
        One object for programs on stdout instead of tables.
    steps
        How many steps a run takes.
    patience
        How long a group of checks may take, in s; a call that takes a quarter of it hangs.
    """
    from .check.report import as_json, tables
    from .check.verdict import check_fmu

    if steps < 4:
        raise ModalFmuError(f"--steps: got {steps}, expected at least 4")
    if not (math.isfinite(patience) and patience > 0):
        raise ModalFmuError(f"--patience: got {patience}, expected a number of seconds > 0")
    with progress() as tell:
        verdict = check_fmu(fmu, steps, patience, progress=tell)
    if json_:
        print(json.dumps(as_json(verdict), indent=1))
    else:
        show(*tables(verdict))
    return 0 if verdict.good else 1
