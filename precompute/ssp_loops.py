"""Algebraic loops: connections on a circle along which every output depends on its input at once.

A master that steps all FMUs side by side breaks such a loop by a delay of one step. Where forces go one way
and motions the other that is an approximation, stable while the loop's gain is below 1. Where only loads go
round, or only motions, it is none: two bodies are joined rigidly and neither is told how to move, or both
are, and at no step size what goes round is the solution of anything.
"""

from collections.abc import Iterable, Mapping, Sequence

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import breadth_first_order, connected_components

from .errors import SspError
from .fmu_face import Face
from .notice import notice
from .ssp_elements import Element
from .ssp_wiring import Wire

JOIN = "put a [[spring_damper]] between them"


def check_loops(wires: Sequence[Wire], elements: Mapping[str, Element]) -> None:
    """Raises SspError for a loop of loads only, or of motions only, between bodies; others get a notice.

    Bodies are the FMUs that this program makes. Another may as well be a controller, which takes a reaction
    and answers with a force: that has a solution. An output whose dependencies the FMU does not tell depends
    on every input, for the notice only.
    """
    bodies = {name for name, element in elements.items() if element.face.is_ours}
    joined = [wire for wire in wires if {wire.source.element, wire.target.element} <= bodies]
    told = {name: _feedthrough(element.face, []) for name, element in elements.items()}
    loop = _loop([wire for wire in joined if wire.unit and wire.unit.is_load], told)
    if loop:
        raise SspError(
            f"{loop[0].where}: a rigid loop without motion, {_path(loop)}: neither side is told how to move; "
            f'give one inputs = ["motion.…"], driven by a motion of the other, or {JOIN}'
        )
    loop = _loop([wire for wire in joined if wire.unit and wire.unit.is_motion], told)
    if loop:
        raise SspError(
            f"{loop[0].where}: a rigid loop without force, {_path(loop)}: both sides are told how to move; "
            f"let one take the action of the other as a force, or {JOIN}"
        )
    loop = _loop(wires, {name: _feedthrough(e.face, e.face.inputs) for name, e in elements.items()})
    if loop:
        notice(
            f"{_path(loop)}: each depends on the one before at once; a master that does not solve such loops "
            f"delays it by a step, which is stable only where the loop's gain is below 1{_joint(loop)}"
        )


def _feedthrough(face: Face, untold: Iterable[str]) -> dict[str, set[str]]:
    """Output → the inputs that it depends on at once; `untold` where the FMU does not say."""
    unknowns = {unknown.variable.name: unknown.dependencies for unknown in face.description.outputs}
    return {
        output: {*untold}
        if unknowns.get(output) is None
        else {v.name for v in unknowns[output] if v.causality == "input"}
        for output in face.outputs
    }


def _loop(wires: Sequence[Wire], through: Mapping[str, Mapping[str, set[str]]]) -> list[Wire]:
    """The wires of a shortest closed path in their order, empty where there is none.

    A wire follows another where the output it comes from depends on the input that the other goes to.
    """
    leaving: dict[str, list[int]] = {}
    for j, wire in enumerate(wires):
        leaving.setdefault(wire.source.element, []).append(j)
    after = [
        (i, j)
        for i, wire in enumerate(wires)
        if wire.target.element
        for j in leaving.get(wire.target.element, ())
        if wire.target.connector in through[wire.target.element][wires[j].source.connector]
    ]
    if not after:
        return []
    rows, columns = np.array(after).T
    graph = csr_array((np.ones(len(after)), (rows, columns)), shape=(len(wires), len(wires)))
    count, label = connected_components(graph, connection="strong")
    for k in range(count):
        members = np.flatnonzero(label == k)
        if len(members) > 1:
            return [wires[i] for i in _circle(graph, int(members[0]))]
        if graph[members[0], members[0]]:
            return [wires[members[0]]]
    return []


def _circle(graph: csr_array, start: int) -> list[int]:
    """A shortest closed path from `start`, which is on one."""
    order, before = breadth_first_order(graph, start)
    last = next(int(i) for i in order if graph[i, start])
    path = [last]
    while path[-1] != start:
        path.append(int(before[path[-1]]))
    return path[::-1]


def _joint(loop: Sequence[Wire]) -> str:
    """What else a loop of loads or motions only would be, if all of its FMUs were bodies."""
    for what, of_one_kind in (
        ("without motion", all(wire.unit and wire.unit.is_load for wire in loop)),
        ("without force", all(wire.unit and wire.unit.is_motion for wire in loop)),
    ):
        if of_one_kind:
            return f"; between bodies, none a controller, this is a rigid loop {what}: {JOIN}"
    return ""


def _path(loop: Sequence[Wire]) -> str:
    """left.a → right.b, right.c → left.d"""
    return ", ".join(f"{wire.source} → {wire.target}" for wire in loop)
