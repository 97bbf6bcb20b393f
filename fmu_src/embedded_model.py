"""The reduced model as C data, for targets that have no file system."""

from collections.abc import Iterable
from textwrap import fill

from .runtime.model import Floats, ReducedModel

COLUMNS = 110


def embedded_model(model: ReducedModel, guid: str) -> str:
    """`embedded_model.c`: the constants `embedded_model` and `embedded_guid`, as model.h describes them.

    Every number is written so that it is read back exactly. C knows no empty array: one without entries
    has a 0 that is never read.
    """
    kinds = [kind.upper() for kind in model.output_kinds]
    return f"""\
/* The reduced model of {model.name}: data instead of files, where MODALFMU_EMBEDDED_MODEL is defined. */
static const char embedded_guid[] = "{guid}";

{_array("double embedded_lam", _numbers(model.lam))}
{_array("double embedded_D_rest", _numbers(model.D_rest))}
{_array("double embedded_B", _numbers(model.B))}
{_array("double embedded_C", _numbers(model.C))}
{_array("char *const embedded_inputs", _texts(model.inputs))}
{_array("char *const embedded_outputs", _texts(model.outputs))}
{_array("OutputKind embedded_output_kinds", kinds)}
static const ReducedModel embedded_model = {{
    .name = "{model.name}",
    .r = {len(model.lam)},
    .m = {len(model.inputs)},
    .p = {len(model.outputs)},
    .lam = embedded_lam,
    .alpha = {float(model.alpha)!r},
    .beta = {float(model.beta)!r},
    .D_rest = embedded_D_rest,
    .B = embedded_B,
    .C = embedded_C,
    .inputs = embedded_inputs,
    .outputs = embedded_outputs,
    .output_kinds = embedded_output_kinds,
    .initial_static = {"true" if model.initial == "static" else "false"},
}};
"""


def _array(declaration: str, entries: Iterable[str]) -> str:
    lines = fill(", ".join(entries) or "0", COLUMNS, initial_indent="    ", subsequent_indent="    ")
    return f"static const {declaration}[] = {{\n{lines},\n}};\n"


def _numbers(array: Floats) -> list[str]:
    return [repr(x) for x in array.ravel().tolist()]  # row by row


def _texts(names: Iterable[str]) -> list[str]:
    return [f'"{name}"' for name in names]
