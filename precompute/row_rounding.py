"""The rounding of an exported K that its rows show, where the digits of its file do not."""

import numpy as np
from scipy.sparse import csr_array

from .arrays import Floats

ROUNDED = 1e-12  # more than this may be an elastic foundation under every node


def row_rounding(K: csr_array, translations: Floats) -> float:
    """Median over i of max_k |K t_k|ᵢ / (|K| |t_k|)ᵢ, t_k the translations (n, 3): relative, 0 if it is none.

    A row that no support touches leaves a translation without force, so that what it does leave is rounding:
    2e-17 where K was summed in double precision, 3e-15 where its entries went through 14 digits.
    """
    force = np.abs(K @ translations)
    size = abs(K) @ np.abs(translations)
    shown = np.divide(force, size, out=np.zeros_like(force), where=size > 0).max(axis=1)
    median = float(np.median(shown))
    return median if median <= ROUNDED else 0.0
