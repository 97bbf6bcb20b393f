"""ReducedModel → .fmu: the Python twin, packaged with pythonfmu.

pythonfmu runs every FMU of a process in one interpreter and finds an FMU's code by its module name.
So the payload carries a name of its own, made from its content: two parts, or two versions of one
part, run side by side.
"""

import importlib
import sys
import tempfile
import zipfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from importlib.metadata import version
from pathlib import Path

from pythonfmu import FmuBuilder

from . import runtime
from .description import Twin, model_description
from .documentation import external_dependencies, licences
from .packaging import DESCRIPTION, digest, write_fmu
from .runtime.model import ReducedModel
from .runtime.resources import write_model

PLATFORMS = ("linux64", "win64")  # of the library that pythonfmu brings
TWIN = Twin(
    generation_tool=f"modalfmu {version('modalfmu')} (pythonfmu {version('pythonfmu')})",
    interfaces={
        "CoSimulation": {
            "needsExecutionTool": "true",  # a Python interpreter with numpy on the host
            "canHandleVariableCommunicationStepSize": "true",
            "canNotUseMemoryManagementFunctions": "true",
            "canGetAndSetFMUstate": "true",
            "canSerializeFMUstate": "true",
        }
    },
    log_categories={
        "logStatusWarning": "Log messages with fmi2Warning status.",
        "logStatusDiscard": "Log messages with fmi2Discard status.",
        "logStatusError": "Calls that were refused, with the reason.",
        "logStatusFatal": "Log messages with fmi2Fatal status.",
        "logAll": "Log all messages.",
    },
)


def build_python_fmu(model: ReducedModel, path: Path, extra: Mapping[str, bytes] | None = None) -> Path:
    """Write the FMU and return its path; the same content gives the same bytes.

    extra: more files of the archive by their names in it, such as `documentation/index.html`.
    Raises OSError where the file cannot be written; nothing half-written is left behind.
    """
    files = {
        **_payload(model),
        "documentation/externalDependencies.txt": external_dependencies().encode(),
        "documentation/licenses/license.txt": licences("modalfmu", "pythonfmu").encode(),
        **(extra or {}),
    }
    return write_fmu(path, files, lambda guid: {DESCRIPTION: model_description(model, TWIN, guid)})


def _payload(model: ReducedModel) -> dict[str, bytes]:
    """Binaries and resources: what pythonfmu makes of the runtime under its own module name."""
    sources = {p.name: p.read_bytes() for p in sorted(Path(runtime.__path__[0]).glob("*.py"))}
    arrays = write_model(model)
    module = f"{model.name}_{digest({**sources, **arrays})[:8]}"
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        _write(folder / module, sources)
        _write(folder / "model", arrays)
        entry = folder / f"{module}_fmu.py"
        entry.write_text(
            f"from {module}.host import keep\nfrom {module}.slave import ModalSlave\n\nkeep(globals())\n\n\n"
            f'class Part(ModalSlave):\n    """The reduced model of {model.name}."""\n'
        )
        raw = folder / "raw.fmu"
        with _imports_undone(folder):
            FmuBuilder.build_FMU(entry, dest=raw, project_files=[folder / module, folder / "model"])
        with zipfile.ZipFile(raw) as archive:
            return {
                name: archive.read(name)
                for name in archive.namelist()
                if name != DESCRIPTION and not name.endswith("/")
            }


@contextmanager
def _imports_undone(folder: Path) -> Iterator[None]:
    """The builder imports the payload from a scratch folder: forget it afterwards."""
    before, path = set(sys.modules), list(sys.path)
    sys.path.insert(0, str(folder))
    importlib.invalidate_caches()
    writes_bytecode, sys.dont_write_bytecode = sys.dont_write_bytecode, True
    try:
        yield
    finally:
        sys.path[:] = path
        sys.dont_write_bytecode = writes_bytecode
        for name in set(sys.modules) - before:
            origin = getattr(sys.modules[name], "__file__", None)
            if origin and Path(origin).is_relative_to(folder):
                del sys.modules[name]


def _write(folder: Path, files: Mapping[str, bytes]) -> None:
    folder.mkdir()
    for name, content in files.items():
        (folder / name).write_bytes(content)
