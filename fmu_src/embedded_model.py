"""The reduced model as C data, for targets that have no file system."""

from collections.abc import Iterable
from textwrap import fill

from .runtime.model import Floats, ReducedModel

COLUMNS = 110
ARRAYS = ("lam", "D_rest", "B", "C", "R", "R_in", "M_s", "K_s")


def embedded_model(model: ReducedModel, guid: str) -> str:
    """`embedded_model.c`: the constants `embedded_model` and `embedded_guid`, as model.h describes them.

    Every number is written so that it is read back exactly. C knows no empty array: one without entries
    has a 0 that is never read.
    """
    arrays = "\n".join(_array(f"double embedded_{key}", _numbers(getattr(model, key))) for key in ARRAYS)
    laws = [law.upper() for law in model.laws]
    return f"""\
/* The reduced model of {model.name}: data instead of files, where MODALFMU_EMBEDDED_MODEL is defined. */
static const char embedded_guid[] = "{guid}";

{arrays}
{_array("size_t embedded_motions", map(str, model.motions))}
{_array("char *const embedded_inputs", _texts(model.inputs))}
{_array("char *const embedded_outputs", _texts(model.outputs))}
{_array("Law embedded_laws", laws)}
static const ReducedModel embedded_model = {{
    .name = "{model.name}",
    .k = {model.k},
    .r = {model.r},
    .n = {len(model.lam)},
    .m = {len(model.inputs)},
    .p = {len(model.outputs)},
    .s = {len(model.C)},
    .lam = embedded_lam,
    .alpha = {float(model.alpha)!r},
    .beta = {float(model.beta)!r},
    .D_rest = embedded_D_rest,
    .B = embedded_B,
    .C = embedded_C,
    .R = embedded_R,
    .R_in = embedded_R_in,
    .M_s = embedded_M_s,
    .K_s = embedded_K_s,
    .motions = embedded_motions,
    .inputs = embedded_inputs,
    .outputs = embedded_outputs,
    .laws = embedded_laws,
    .residual = {_truth(model.residual)},
    .initial_static = {_truth(model.initial == "static")},
}};
"""


def _array(declaration: str, entries: Iterable[str]) -> str:
    lines = fill(", ".join(entries) or "0", COLUMNS, initial_indent="    ", subsequent_indent="    ")
    return f"static const {declaration}[] = {{\n{lines},\n}};\n"


def _numbers(array: Floats) -> list[str]:
    return [repr(x) for x in array.ravel().tolist()]  # row by row


def _texts(names: Iterable[str]) -> list[str]:
    return [f'"{name}"' for name in names]


def _truth(value: bool) -> str:
    return "true" if value else "false"
