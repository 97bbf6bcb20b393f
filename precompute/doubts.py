"""What is legal and probably not meant: a line each, in words that say what to look at."""

from collections.abc import Sequence

import numpy as np

from .arrays import Ints
from .dofs import Dofs
from .mesh import Mesh
from .notice import notice, warning
from .part import Part
from .ports import PortNodes

SOFTEST = 1e6  # Pa: rubber; below it Young's modulus is more often in MPa
LIGHTEST, HEAVIEST = 1.0, 3e4  # kg/m³: foams and osmium; outside, density is more often in t/mm³ or g/cm³
LOCKING = ("tet4", "hex8", "wedge6")
CRITICAL = 1.0  # ζ: from here on a mode does not vibrate; such a ratio is more often in percent
SHIFTING = ("force", "displacement", "velocity", "acceleration")


def doubt_units(part: Part) -> None:
    """Young's modulus below 1 MPa, or a density that no solid has: units other than SI?"""
    for k, material in enumerate(part.materials, start=1):
        key = f"{part.source.name}: material[{k}]"
        if material.young < SOFTEST:
            warning(
                f"{key}.young: {material.young:g} Pa is softer than rubber; is it in MPa? It must be in Pa"
            )
        if not LIGHTEST <= material.density <= HEAVIEST:
            warning(f"{key}.density: no solid has {material.density:g} kg/m³; is it in another unit?")


def doubt_ratios(part: Part) -> None:
    """Damping ratios of 1 and more: percent?"""
    form = part.damping
    asked = {
        "ratio": [] if form.ratio is None else [form.ratio],
        "ratios": [zeta for _, zeta in form.ratios or ()],
        "table": [zeta for _, zeta in form.table or ()],
        "structural": [] if form.structural is None else [form.structural],
    }
    for key, values in asked.items():
        if values and max(values) >= CRITICAL:
            warning(
                f"{part.source.name}: damping.{key}: {max(values):g} is {100 * max(values):g} %; is it in "
                "percent? 2 % is 0.02"
            )


def doubt_linear_cells(mesh: Mesh) -> None:
    """Linear cells bend too stiffly, thin ones by a multiple."""
    linear = {family: len(cells) for family, cells in mesh.cells.items() if family in LOCKING and len(cells)}
    if linear:
        listed = ", ".join(f"{number} {family}" for family, number in linear.items())
        notice(f"{listed}: linear cells bend too stiffly, above all thin ones; quadratic cells do not")


def doubt_held_ports(part: Part, ports: Sequence[PortNodes], fixed: Ints, dofs: Dofs) -> None:
    """Directions of ports in which a support holds every node: nothing can move there."""
    for port, where in zip(part.ports, ports, strict=True):
        keys = [key.split(".") for key in (*port.inputs, *port.outputs)]
        for axis in sorted({key[-1] for key in keys if key[0] in SHIFTING}):
            if np.isin(dofs.find(where.nodes, "xyz".index(axis)), fixed).all():
                warning(
                    f"port {port.name}: a support holds all of its nodes in {axis}; nothing will move there"
                )


def doubt_point_stress(part: Part, ports: Sequence[PortNodes]) -> None:
    """Stress under a force at a single node: the exact one is infinite."""
    for port, where in zip(part.ports, ports, strict=True):
        pushed = any(key.startswith("force.") for key in port.inputs)
        if pushed and len(where.nodes) == 1 and any(key.startswith("stress.") for key in port.outputs):
            notice(
                f"port {port.name}: stress at the one node that takes the force grows without bound as the "
                "mesh is refined; spread the force over a face, or read the stress at another port"
            )
