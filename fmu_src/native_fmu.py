"""ReducedModel → .fmu: the native twin, whose library is the same for every part and reads its model."""

from collections.abc import Mapping
from importlib.metadata import version
from pathlib import Path

from .description import Twin, model_description
from .documentation import fmi_licence, licences, sources_readme
from .embedded_model import embedded_model
from .native_library import native_libraries
from .packaging import DESCRIPTION, write_fmu
from .runtime.model import ReducedModel
from .runtime.resources import write_model
from .toolchain import FMI_HEADERS, SINGLE_FILE, fmi_headers, native_sources

COMMON = {
    "canNotUseMemoryManagementFunctions": "false",
    "canGetAndSetFMUstate": "true",
    "canSerializeFMUstate": "true",
    "providesDirectionalDerivative": "true",
}
TWIN = Twin(
    generation_tool=f"modalfmu {version('modalfmu')}",
    interfaces={
        "ModelExchange": {"completedIntegratorStepNotNeeded": "true", **COMMON},
        "CoSimulation": {
            "canHandleVariableCommunicationStepSize": "true",
            "canInterpolateInputs": "true",
            "maxOutputDerivativeOrder": "2",
            **COMMON,
        },
    },
    log_categories={  # those of component.c
        "logStatusError": "Calls that were refused, with the reason.",
        "logStatusDiscard": "Steps that cannot be made, with the reason.",
        "logStepSizes": "A step size is new: its coefficients are computed, which takes longer than a step.",
        "logModel": "What was read, and which instructions of the processor are used.",
        "logAll": "All messages.",
    },
    sources=(SINGLE_FILE,),
)


def build_native_fmu(
    model: ReducedModel,
    path: Path,
    extra: Mapping[str, bytes] | None = None,
    libraries: Mapping[str, Path] | None = None,
) -> Path:
    """Write the FMU and return its path; the same content gives the same bytes.

    extra: more files of the archive by their names in it, such as `documentation/index.html`.
    libraries: by platform, as `native_libraries` gives them; None: those that are there.
    Raises ToolchainError without a library for this machine, OSError where the file cannot be written;
    nothing half-written is left behind.
    """
    headers = {name: (fmi_headers() / name).read_bytes() for name in FMI_HEADERS}
    chosen = native_libraries() if libraries is None else libraries
    files = {
        **{
            f"binaries/{platform}/{model.name}{library.suffix}": library.read_bytes()
            for platform, library in chosen.items()
        },
        **{f"resources/model/{name}": content for name, content in write_model(model).items()},
        **{f"sources/{name}": content for name, content in (native_sources() | headers).items()},
        "sources/README.txt": sources_readme(model.name).encode(),
        "documentation/licenses/license.txt": licences("modalfmu").encode(),
        "documentation/licenses/fmi-headers.txt": fmi_licence(headers[FMI_HEADERS[0]]).encode(),
        **(extra or {}),
    }
    if "win64" in chosen:  # its library holds the start-up code of this C run-time library
        mingw = Path(__file__).parent / "licenses" / "mingw-w64.txt"
        files["documentation/licenses/mingw-w64.txt"] = mingw.read_bytes()

    def files_with_guid(guid: str) -> dict[str, bytes]:
        return {
            DESCRIPTION: model_description(model, TWIN, guid),
            "resources/guid.txt": f"{guid}\n".encode(),
            "sources/embedded_model.c": embedded_model(model, guid).encode(),
        }

    return write_fmu(path, files, files_with_guid)
