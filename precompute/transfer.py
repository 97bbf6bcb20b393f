"""The frequency responses H(ω) from every input to every linear output, and their units."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from fmu_src.runtime.kinds import STRESSES, inputs_of, outputs_of
from fmu_src.runtime.model import Port, row_starts

from .arrays import Floats, Ints
from .oscillators import Complexes, Oscillators, amplitudes

OWN_KINDS = {"gravity": "gravity", "base": "base acceleration"}  # of inputs, by their port


@dataclass(frozen=True)
class Lines:
    """The lines of H: outputs that are linear in the motion; von Mises stresses stand as their six parts.

    names, kinds, units: of each line, (p) each; laws: "position", "velocity", "acceleration" or "reaction";
    rows: (p,) its row of C and R, a reaction's first of three, the last of which modes have no part in.
    """

    names: tuple[str, ...]
    kinds: tuple[str, ...]
    units: tuple[str, ...]
    laws: tuple[str, ...]
    rows: Ints

    def of(self, *laws: str) -> Ints:
        """The lines that follow one of these laws."""
        return np.array([i for i, law in enumerate(self.laws) if law in laws], dtype=np.int64)


@dataclass(frozen=True)
class Block:
    """All responses from inputs of one kind to outputs of one kind: they share a unit."""

    output: str
    input: str
    unit: str
    lines: Ints
    columns: Ints


def lines_of(ports: Sequence[Port]) -> Lines:
    """The lines in the order of the ports' outputs."""
    found: list[tuple[str, str, str, str, int]] = []
    listed = [(port.name, key, outputs_of(port.name)[key]) for port in ports for key in port.outputs]
    starts = row_starts([output.law for _, _, output in listed])
    for (port, key, output), row in zip(listed, starts, strict=False):
        name, kind = f"{port}.{key}", key.split(".")[0]
        if output.law == "mises":
            found += [
                (f"{name} ({part})", kind, output.unit, "position", row + i)
                for i, part in enumerate(STRESSES)
            ]
        elif output.law not in ("kinetic", "strain"):
            found.append((name, kind, output.unit, output.law, row))
    names, kinds, units, laws, rows = zip(*found, strict=True) if found else ((), (), (), (), ())
    return Lines(names, kinds, units, laws, np.array(rows, dtype=np.int64))


def input_kinds(ports: Sequence[Port]) -> list[tuple[str, str]]:
    """Kind and unit of each input, the columns of H."""
    return [
        (OWN_KINDS.get(port.name, key.split(".")[0]), inputs_of(port.name)[key].unit)
        for port in ports
        for key in port.inputs
    ]


def blocks_of(ports: Sequence[Port]) -> tuple[Block, ...]:
    """H by kinds of quantities, in the order in which the ports name them."""
    lines, inputs = lines_of(ports), input_kinds(ports)

    def grouped(items: Sequence[tuple[str, str]]) -> Iterator[tuple[str, str, Ints]]:
        for kind, unit in dict.fromkeys(items):
            yield kind, unit, np.array([i for i, item in enumerate(items) if item == (kind, unit)])

    return tuple(
        Block(output, kind, f"{unit}/({per})" if set("./") & set(per) else f"{unit}/{per}", rows, columns)
        for output, unit, rows in grouped(list(zip(lines.kinds, lines.units, strict=True)))
        for kind, per, columns in grouped(inputs)
    )


def measured(lines: Lines, motion: Complexes, R: Floats, alpha: float, omega: Floats) -> Complexes:
    """H (f, p, n_u) from the responses C q (f, s, n_u) of the rows, each line by its law.

    position C q + R u; velocity iω (C q + R u); acceleration −ω² C q + R u;
    reaction (−ω² + iωα) C₁ q + iω C₂ q + R₁ u.
    """
    w = omega[:, None, None]
    H = motion[:, lines.rows] + 0.0
    R_lines = np.broadcast_to(R[lines.rows], H.shape)
    place = {law: lines.of(law) for law in dict.fromkeys(lines.laws)}
    for law, at in place.items():
        if law == "position":
            H[:, at] += R_lines[:, at]
        elif law == "velocity":
            H[:, at] = 1j * w * (H[:, at] + R_lines[:, at])
        else:
            H[:, at] *= -(w**2) + (1j * w * alpha if law == "reaction" else 0.0)
            H[:, at] += R_lines[:, at]
    if "reaction" in place:
        at = place["reaction"]
        H[:, at] += 1j * w * motion[:, lines.rows[at] + 1]
    return H


def transfer(system: Oscillators, lines: Lines, omega: Floats) -> Complexes:
    """H(ω): (f, p, n_u), in the SI units of output per input, omega (f,) in rad/s."""
    motion: Complexes = system.C @ amplitudes(system, omega, system.B)
    return measured(lines, motion, system.R, system.alpha, omega)


def norms(H: Complexes, block: Block) -> Floats:
    """‖H_block‖₂ at every frequency, (f,): the largest gain from its inputs to its outputs."""
    return spectral_norms(H[:, block.lines[:, None], block.columns])


def spectral_norms(A: Complexes) -> Floats:
    """‖A‖₂ of each matrix of a stack, (f,) from (f, p, q); 0 of empty ones."""
    return np.asarray(np.max(np.linalg.svd(A, compute_uv=False), axis=-1, initial=0.0))
