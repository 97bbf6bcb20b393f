"""The certificate of a part: its band, its tolerance, and what to change where that is missed."""

from fmu_src.runtime.model import ReducedModel

from .accuracy import captured_mass, certify, default_band
from .advice import advice
from .certificate import Certificate
from .connection import Connection, damped
from .full_response import Reference, full_response
from .interface import Interface
from .known_modes import KnownModes, rigid_only
from .mode_choice import FINER
from .notice import notice, warning
from .part import Part
from .reduced_basis import ReducedBasis
from .statics import StaticSolver

TOLERANCE = 0.01  # where the part file has none


def certificate_of(
    part: Part,
    connection: Connection,
    interface: Interface,
    basis: ReducedBasis,
    model: ReducedModel,
    solve: StaticSolver,
) -> Certificate | None:
    """The reduced model against the full one; none for a body that can only move rigidly.

    A notice where damping drags a part whose ports are moved: what velocities add is not compared.
    A warning tells what to change where [accuracy] or the error of [modes] is missed.
    """
    band = _band(part, basis)
    if band is None:
        notice("accuracy: got no elastic mode, so there is no band to compare over; give [accuracy] band")
        return None
    if model.drag(model.alpha).any():
        notice(
            "accuracy: responses to prescribed motions are compared for their accelerations alone, without "
            "what alpha, dashpots or a damping matrix add by velocities, most of all below f = alpha/2pi"
        )
    tolerance = _tolerance(part)
    reference = basis.reference
    if reference is None or band != part.modes.band or tolerance < (part.modes.error or 0.0):
        reference = _reference(part, connection, interface, basis, solve, band, tolerance)
    captured = captured_mass(connection.held.system, basis.modes.Phi)
    certificate = certify(reference, model, captured, tolerance)
    if part.accuracy is not None or part.modes.error is not None:
        words = advice(reference, certificate, part.modes.residual, modal=basis.exact is not None)
        if words is not None:
            warning(f"{part.source.name}: {words}")
    return certificate


def _band(part: Part, basis: ReducedBasis) -> tuple[float, float] | None:
    """As the part file says; else by the exact modes, or the lower half of the modes of another basis.

    The upper half of those are rather static shapes than modes of the part, as residual vectors are.
    """
    if part.accuracy is not None and part.accuracy.band is not None:
        return part.accuracy.band
    if part.modes.band is not None:
        return part.modes.band
    if basis.exact is not None:
        return default_band(basis.exact.frequencies)
    elastic = basis.modes.frequencies[basis.modes.rigid :]
    return default_band(elastic[: (len(elastic) + 1) // 2])


def _tolerance(part: Part) -> float:
    if part.accuracy is not None:
        return part.accuracy.tolerance
    return part.modes.error or TOLERANCE


def _reference(
    part: Part,
    connection: Connection,
    interface: Interface,
    basis: ReducedBasis,
    solve: StaticSolver,
    band: tuple[float, float],
    tolerance: float,
) -> Reference:
    dashpots = connection.own_dashpots
    if basis.exact is None:
        known, damping = rigid_only(solve, dashpots), damped(part, connection, basis.modes)
    else:
        damping = damped(part, connection, basis.exact)
        known = KnownModes(basis.exact.lam, basis.exact.Phi, damping.D_rest)
    return full_response(solve, known, damping, interface, band, FINER * tolerance, dashpots)
