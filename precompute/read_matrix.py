"""One matrix file of any known format → its entries."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from .abaqus_matrix import read_text_matrix
from .errors import MatrixError
from .matrix_entries import Entries
from .matrix_market import BANNER, read_matrix_market
from .number_lines import number_lines
from .numpy_matrix import read_npz

ZIP = b"PK"  # how an archive begins, a damaged one too


def read_matrix(path: Path) -> Entries:
    """The entries of a file, whose format its content tells: NumPy .npz, Matrix Market, or text.

    Raises MatrixError, beginning with the file's name: no such file, another format, damage.
    """
    with naming(path):
        with path.open("rb") as file:
            start = file.read(64)
        if start.startswith(ZIP):
            return read_npz(path)
        if start.decode("latin-1").lower().startswith(BANNER):
            return read_matrix_market(path)
        if next(number_lines(path), "").startswith("*"):
            raise MatrixError(
                "got keywords instead of entries; write whole matrices by *MATRIX OUTPUT, not substructures"
            )
        return read_text_matrix(path)


@contextmanager
def naming(path: Path) -> Iterator[None]:
    """Mistakes within begin with the file's name."""
    try:
        yield
    except MatrixError as error:
        raise MatrixError(f"{path.name}: {error}") from None
    except FileNotFoundError:
        raise MatrixError(f"{path.name}: no such file in {path.resolve().parent}") from None
    except OSError as error:
        raise MatrixError(f"{path.name}: cannot be read ({error.strerror})") from None
