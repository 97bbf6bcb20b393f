"""What the FMU says to a reader: the table of its modes, and what its host must have."""

from html import escape
from importlib.metadata import distribution, version
from textwrap import dedent

from .runtime.model import ReducedModel


def external_dependencies() -> str:
    """The text of `documentation/externalDependencies.txt`."""
    return f"""\
This FMU runs Python code. The host needs

  Python  3.11 or newer, as a shared library (libpython3.x.so, python3x.dll), 64 bit
  numpy   1.24 or newer, importable by that Python
  glibc   2.32 or newer on Linux

Binaries: linux64 and win64, from pythonfmu {version("pythonfmu")}. Nothing else is needed: the model
and the code that runs it are in resources/.

Hosts that are Python programs (FMPy, PyFMI) load the FMU as it is, from an environment with numpy.
Extract it to a folder whose path has no letters beyond ASCII and no %, ( or @: the library decodes no
escapes of the resource location but those of spaces.

Hosts that are not Python programs must have libpython in their process before they load the FMU:
  Linux    LD_PRELOAD=libpython3.x.so HOST …   (the path of that file, for your Python, and PYTHONHOME or an
           activated environment so that numpy is found)
  Windows  the folder of python3.dll and python3xx.dll on PATH, PYTHONHOME set to it

All FMUs of this kind in one process share one Python interpreter.
"""


def licences(*packages: str) -> str:
    """The licence texts of installed packages."""
    texts: list[str] = []
    for name in packages:
        files = [f for f in distribution(name).files or () if f.name.upper().startswith("LICEN")]
        texts += [f"{name} {version(name)}\n\n{f.read_text(encoding='utf-8')}" for f in files]
    return "\n\n".join(texts)


def fmi_licence(header: bytes) -> str:
    """Copyright and licence of the FMI headers, as one of them tells them at its beginning."""
    text = header.decode()
    notice = text[text.index("Copyright (C)") : text.index("*/")]
    return f"The FMI 2.0 headers in sources/\n\n{dedent('   ' + notice).strip()}\n"


def sources_readme(name: str) -> str:
    """The text of `sources/README.txt`: how to compile the part called `name` for another target."""
    return f"""\
The source code of {name}: modalfmu.c includes all the other files. It needs a C11 compiler and the C
library; no threads, no C++, no other library. The FMI 2.0 headers are here.

A shared library, which reads its model from the resources of the FMU:

  cc -std=c11 -O3 -shared -fPIC -fvisibility=hidden modalfmu.c -o {name}.so -lm

Linked into a program, the functions of each FMU with a prefix of their own ({name}_fmi2DoStep):

  cc -std=c11 -O3 -DFMI2_FUNCTION_PREFIX={name}_ -c modalfmu.c -o {name}.o

On a target without a file system the model comes from embedded_model.c, with either command:

  cc -std=c11 -O3 -DMODALFMU_EMBEDDED_MODEL ...

fmi2Instantiate then ignores fmuResourceLocation. Memory is taken by fmi2Instantiate, fmi2GetFMUstate and
fmi2DeSerializeFMUstate only, through the functions that the host gives.
"""


def index_html(
    model: ReducedModel,
    effective_mass: dict[str, list[float]] | None = None,
    total_mass: float | None = None,
    accuracy: str | None = None,
    references: str | None = None,
) -> str:
    """`documentation/index.html`: what the model is, its ports and its modes with units.

    accuracy: the name of a page beside it that tells how accurate the reduction is; references: of a text
    that tells of the reference results.
    """
    ratio = model.damping_ratio(model.alpha, model.beta)
    head = ["mode", "frequency / Hz", "damping ratio"]
    rows = [
        [str(i), f"{f:.6g}", f"{z:.4g}" if f > 0 else "rigid"]
        for i, (f, z) in enumerate(zip(model.frequency, ratio, strict=True), start=1)
    ]
    if effective_mass and total_mass:
        head += [f"effective mass in {axis} / %" for axis in effective_mass]
        for i, row in enumerate(rows):
            row += [f"{100 * mass[i] / total_mass:.1f}" for mass in effective_mass.values()]
    ports = [[port.name, ", ".join(port.inputs), ", ".join(port.outputs)] for port in model.ports]
    link = f'<p><a href="{escape(accuracy)}">Accuracy of the reduction</a></p>\n' if accuracy else ""
    link += f'<p><a href="{escape(references)}">Reference results</a></p>\n' if references else ""
    mass = f"<p>Total mass {total_mass:.6g} kg.</p>\n" if total_mass else ""
    return (
        f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><title>{escape(model.name)}</title>\n'
        "<style>body{font:15px sans-serif;margin:2em}td,th{padding:.2em .8em;text-align:right}"
        "th{border-bottom:1px solid}</style></head>\n"
        f"<body><h1>{escape(model.name)}</h1>\n<p>{escape(model.description)}</p>\n{mass}"
        f"<p>Reduced modal model of {model.r} modes, {_damping(model)}{_held(model)}. "
        "Each mode advances by the analytic solution of its equation of motion, "
        "exact for the force as it is given over the step, at any step size.</p>\n"
        f"{link}<h2>Ports</h2>\n{_table(['port', 'inputs', 'outputs'], ports)}"
        f"<h2>Modes</h2>\n{_table(head, rows)}</body></html>\n"
    )


def _damping(model: ReducedModel) -> str:
    """The damping beside the ratios of the table."""
    words = [f"damping &alpha; = {model.alpha:g} 1/s, &beta; = {model.beta:g} s"]
    if model.D_rest.any():
        words.append("and damping that couples modes" if len(model.coupled) else "and ratios of their own")
    return " ".join(words)


def _held(model: ReducedModel) -> str:
    """What the frequencies belong to where ports are driven."""
    held = [model.inputs[place] for place in model.motions]
    return f", of the part with {escape(', '.join(held))} held" if held else ""


def _table(head: list[str], rows: list[list[str]]) -> str:
    lines = ["<table><tr>" + "".join(f"<th>{escape(cell)}</th>" for cell in head) + "</tr>"]
    lines += ["<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in rows]
    return "\n".join(lines) + "</table>\n"
