"""A basis from a file: the general reduced deformation model, p' = p + U q [2.19, 2.20]."""

from pathlib import Path
from tokenize import TokenError

import numpy as np

from .arrays import Floats
from .errors import EigenError


def read_basis(path: Path, n: int) -> Floats:
    """U (n, k) of a .npy file: a row per DOF of the full model, in its order, a column per vector.

    Raises EigenError: not such a file, another number of rows, no columns, entries that are not finite
    real numbers.
    Source: James & Pai, ACM Trans. Graphics 21(3), 2002 (DyRT).
    """
    try:
        U = np.load(path, allow_pickle=False)
    except OSError as error:
        raise EigenError(f"basis: cannot read {path.name} ({error.strerror}); check its name") from error
    except (ValueError, EOFError, SyntaxError, TokenError, MemoryError, OverflowError) as error:
        raise EigenError(
            f"basis: {path.name} is no array of numbers that numpy.save wrote, expected one "
            f"({type(error).__name__})"
        ) from error
    if not isinstance(U, np.ndarray) or U.ndim != 2 or U.shape[0] != n or U.shape[1] == 0:
        raise EigenError(
            f"basis: {path.name} holds {getattr(U, 'shape', 'several arrays')}, expected ({n}, k): a row per "
            "DOF of the part in its order, a column per vector"
        )
    if U.dtype.kind not in "fiu" or not np.isfinite(U).all():
        raise EigenError(
            f"basis: {path.name} holds {U.dtype} with NaN, infinite or complex entries; "
            "expected finite real numbers"
        )
    return np.asarray(U, dtype=np.float64)
