"""The command `modalfmu`; nothing but the commands prints.

Exit codes: 0 done, 1 findings of `check` or a fault of modalfmu (with a traceback),
2 a mistake of the user (one line), 130 Ctrl-C.
"""

import io
import os
import sys
from collections.abc import Sequence
from importlib.metadata import version

from cyclopts import App, CycloptsError

from .check_command import check
from .console import complain, notices
from .errors import ModalFmuError
from .part_commands import build, inspect, modes
from .simulate_command import simulate
from .ssp_command import ssp

app = App(
    name="modalfmu",
    version=f"modalfmu {version('modalfmu')}",
    help="One deformable part in, one FMI 2.0 co-simulation FMU out.",
    help_format="markdown",
)
for command in (build, modes, inspect, simulate, ssp, check):
    app.command(command)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; gives its exit code."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")  # λ and → where the terminal knows ASCII only
    code: int | None = None
    try:
        with notices():
            chosen, bound, _ = app.parse_args(
                sys.argv[1:] if arguments is None else arguments, exit_on_error=False, print_error=False
            )
            code = chosen(*bound.args, **bound.kwargs)
        sys.stdout.flush()
    except (ModalFmuError, CycloptsError) as error:
        complain(str(error))
        return 2
    except KeyboardInterrupt:
        complain("interrupted")
        return 130
    except BrokenPipeError:
        # The reader has what it wanted; what is left in the buffer has nowhere to go.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    except OSError as error:
        if error.filename is None:
            raise
        complain(f"{error.filename}: {error.strerror}")
        return 2
    return code or 0


if __name__ == "__main__":
    sys.exit(main())
