"""What is legal and probably not meant: a warning each, in words that say what to look at."""

from collections.abc import Sequence

import numpy as np

from .arrays import Ints
from .mesh import Mesh
from .notice import notice, warning
from .part import Part
from .ports import PortNodes

SOFTEST = 1e6  # Pa: rubber; below it Young's modulus is more often in MPa
LIGHTEST, HEAVIEST = 1.0, 3e4  # kg/m³: foams and osmium; outside, density is more often in t/mm³ or g/cm³
LOCKING = ("tet4", "hex8", "wedge6")


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


def doubt_linear_cells(mesh: Mesh) -> None:
    """Linear cells bend too stiffly, thin ones by a multiple."""
    linear = {family: len(cells) for family, cells in mesh.cells.items() if family in LOCKING and len(cells)}
    if linear:
        listed = ", ".join(f"{number} {family}" for family, number in linear.items())
        notice(f"{listed}: linear cells bend too stiffly, above all thin ones; quadratic cells do not")


def doubt_held_ports(part: Part, ports: Sequence[PortNodes], fixed: Ints) -> None:
    """Directions of ports in which a support holds every node: nothing can move there."""
    for port, where in zip(part.ports, ports, strict=True):
        for axis in sorted({name[-1] for name in (*port.inputs, *port.outputs)}):
            if np.isin(3 * where.nodes + "xyz".index(axis), fixed).all():
                warning(
                    f"port {port.name}: a support holds all of its nodes in {axis}; nothing will move there"
                )
