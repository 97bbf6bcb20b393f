"""The root of the exception tree."""


class ModalFmuError(Exception):
    """A mistake of the user's, told in one line: what was got, what was expected, how to mend it."""


class ModelError(ModalFmuError):
    """A reduced model, or the resource files it is read from, is not what it must be."""
