"""Exceptions of the off-line stage; every message is one line that says how to mend the mistake."""

from fmu_src.runtime.errors import ModalFmuError, ModelError

__all__ = [
    "EigenError",
    "MatrixError",
    "MeshError",
    "ModalFmuError",
    "ModelError",
    "PartError",
    "SelectionError",
    "SspError",
    "ZeroEnergyError",
]


class PartError(ModalFmuError):
    """The part file is not valid."""


class MeshError(ModalFmuError):
    """A mesh file cannot be read, or its cells cannot be integrated."""


class MatrixError(ModalFmuError):
    """A matrix of another program cannot be read, or is not the stiffness, mass or damping of a part."""


class SelectionError(ModalFmuError):
    """A selection matches nothing, or not what it must."""


class EigenError(ModalFmuError):
    """The modes asked for cannot be computed."""


class SspError(ModalFmuError):
    """A system file is not valid, or what it connects does not fit together."""


class ZeroEnergyError(EigenError):
    """Motions without strain energy beyond the rigid motions of the whole body."""
