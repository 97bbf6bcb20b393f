"""The maths of the C twin through ctypes: structures and functions of the headers and of native/maths.c."""

import ctypes
from ctypes import POINTER, c_double, c_int, c_size_t, c_uint, c_void_p
from functools import cache

import numpy as np
from native_library import TESTS, native_library

from fmu_src.runtime.coupled import CoupledPropagator
from fmu_src.runtime.model import Floats
from fmu_src.runtime.propagator import Propagator

COEFFICIENTS = ("E11", "E12", "E21", "E22", "G0", "G1", "G2", "G3")
FAST = (
    "-O3",
    "-fno-math-errno",
    "-mcpu=baseline",
    "-Wno-unused-function",
)  # vectors and contraction as in an FMU
Doubles = POINTER(c_double)


class CPropagator(ctypes.Structure):
    """Propagator of propagator.h"""

    _fields_ = (("h", c_double), *((name, Doubles) for name in COEFFICIENTS))


class COutputs(ctypes.Structure):
    """Outputs of kernels.h"""

    _fields_ = (
        ("row", POINTER(Doubles)),
        ("n", c_size_t),
        ("law", POINTER(c_int)),
        ("motion", POINTER(Doubles)),
    )


class Kernels(ctypes.Structure):
    """Kernels of kernels.h: one set of instructions."""

    _fields_ = (
        ("instructions", ctypes.c_char_p),
        ("add", ctypes.CFUNCTYPE(None, Doubles, Doubles, c_double, c_size_t)),
        (
            "step",
            ctypes.CFUNCTYPE(
                c_double,
                POINTER(CPropagator),
                Doubles,
                Doubles,
                POINTER(Doubles),
                Doubles,
                Doubles,
                c_size_t,
            ),
        ),
        (
            "step_cubic",
            ctypes.CFUNCTYPE(
                c_double,
                POINTER(CPropagator),
                Doubles,
                Doubles,
                POINTER(Doubles),
                Doubles,
                Doubles,
                c_size_t,
            ),
        ),
        (
            "step_held",
            ctypes.CFUNCTYPE(
                c_double, POINTER(CPropagator), Doubles, Doubles, Doubles, Doubles, Doubles, c_size_t
            ),
        ),
        (
            "outputs",
            ctypes.CFUNCTYPE(None, POINTER(COutputs), c_size_t, POINTER(c_uint), c_uint, c_size_t, Doubles),
        ),
        ("dot", ctypes.CFUNCTYPE(c_double, Doubles, Doubles, c_size_t)),
        ("coupled", ctypes.CFUNCTYPE(None, *7 * [Doubles], c_size_t, c_size_t)),
        ("multiply", ctypes.CFUNCTYPE(None, *3 * [Doubles], c_size_t, c_size_t)),
    )


class Run(ctypes.Structure):
    """Run of native/maths.c"""

    _fields_ = (
        *((name, c_size_t) for name in ("k", "n", "m", "p", "s", "steps")),
        *((name, c_void_p) for name in ("lam", "D_rest", "B", "C", "R", "R_in", "M_s", "K_s")),
        *((name, c_void_p) for name in ("start", "u", "h", "motions", "laws", "active")),
        ("alpha", c_double),
        ("beta", c_double),
        ("initial_static", c_int),
        ("residual", c_int),
        ("held", c_int),
    )


@cache
def maths() -> ctypes.CDLL:
    library = native_library("maths", (TESTS / "maths.c",), FAST)
    library.coefficients.argtypes = (c_void_p, c_void_p, c_size_t, c_double, c_void_p)
    library.coupled_coefficients_of.argtypes = (
        c_void_p,
        c_void_p,
        c_size_t,
        c_double,
        POINTER(Kernels),
        c_void_p,
    )
    library.coefficients.restype = library.coupled_coefficients_of.restype = None
    library.usable_kernels.restype = library.run_steps.restype = c_size_t
    return library


def native_propagator(lam: Floats, d: Floats, h: float) -> Propagator:
    rows = np.full((8, len(lam)), np.nan)
    lam, d = np.ascontiguousarray(lam), np.ascontiguousarray(d)
    maths().coefficients(lam.ctypes.data, d.ctypes.data, len(lam), h, rows.ctypes.data)
    return Propagator(h, *rows)


def native_coupled(lam: Floats, D: Floats, h: float, kernels: Kernels | None = None) -> CoupledPropagator:
    """In the form of the Python twin: E11 = I − G₀Λ, E21 = −E12 Λ, E22 = I + N."""
    g = len(lam)
    found = np.full((6, g, g), np.nan)
    lam, D = np.ascontiguousarray(lam), np.ascontiguousarray(D)
    table = ctypes.byref(kernels or kernel_tables()[-1])
    maths().coupled_coefficients_of(lam.ctypes.data, D.ctypes.data, g, h, table, found.ctypes.data)
    E12, N, *G = found
    return CoupledPropagator(np.eye(g) - G[0] * lam, E12, -E12 * lam, np.eye(g) + N, *G)


def kernel_tables() -> list[Kernels]:
    pointers = (POINTER(Kernels) * 3)()
    count = maths().usable_kernels(pointers)
    return [pointers[k].contents for k in range(count)]
