"""Reduced models that could be built, from what is known of the full one, at next to no cost."""

from dataclasses import dataclass

import numpy as np

from .arrays import Bools, Floats
from .full_model import SOFTEST, FullModel
from .oscillators import Oscillators
from .residual import NEW, static_rows


@dataclass(frozen=True, eq=False)  # arrays have no one truth value
class MoreVectors:
    """Vectors beside the exact modes kept, in the coordinates of the full model: phi (r, j), y (q, j).

    lam: (j,) in 1/s². They and the modes kept are orthonormal in M and orthogonal in K.
    """

    lam: Floats
    phi: Floats
    y: Floats


def no_more(full: FullModel) -> MoreVectors:
    """The exact modes alone."""
    return MoreVectors(np.zeros(0), np.zeros((len(full.lam), 0)), np.zeros((len(full.M), 0)))


def ritz_vectors(full: FullModel) -> MoreVectors:
    """The modes beyond the exact ones as the ports see them, ascending."""
    mu, S = full.ritz
    massive = mu > SOFTEST
    y = S[:, massive] / np.sqrt(mu[massive])
    return MoreVectors(1 / mu[massive], np.zeros((len(full.lam), y.shape[1])), y)


def residual_vectors(full: FullModel, keep: Bools, further: MoreVectors | None = None) -> MoreVectors:
    """X = (K⁺ − Φ Λ⁻¹ Φᵀ) [b, w] over the modes kept, as modes of their own; as in `with_residual_modes`.

    further: modes beyond the exact ones that are kept too, and are returned with X.
    """
    off = ~keep & (full.lam > 0)
    loads = np.column_stack([full.B, full.W])
    phi, y = (
        np.where(off[:, None], loads, 0.0) / np.where(off, full.lam, 1.0)[:, None],
        np.column_stack([full.B_y, full.W_y]),
    )
    elastic = full.lam > 0
    whole = np.linalg.norm(np.concatenate([loads[elastic] / np.sqrt(full.lam[elastic, None]), y]), axis=0)
    bending = whole > 0
    phi, y = phi[:, bending] / whole[bending], y[:, bending] / whole[bending]
    Q = np.zeros((len(y), 0)) if further is None else further.y / np.sqrt(further.lam)
    y = y - Q @ (Q.T @ y)
    share, Y = np.linalg.eigh(phi.T @ (full.lam[:, None] * phi) + y.T @ y)
    Y = Y[:, share > NEW**2] / np.sqrt(share[share > NEW**2])
    phi, y = np.column_stack([np.zeros((len(phi), Q.shape[1])), phi @ Y]), np.column_stack([Q, y @ Y])
    mu, X = np.linalg.eigh(phi.T @ phi + y.T @ full.M @ y)
    X = X[:, mu > SOFTEST] / np.sqrt(mu[mu > SOFTEST])
    return MoreVectors(1 / mu[mu > SOFTEST], phi @ X, y @ X)


def candidate(full: FullModel, keep: Bools, more: MoreVectors, feed_through: bool) -> Oscillators:
    """The reduced model of the exact modes `keep` (r,) and more vectors.

    feed_through: with the residual flexibility of what is left out, in rows of position and velocity.
    """
    lam = np.concatenate([full.lam[keep], more.lam])
    B = np.concatenate([full.B[keep], more.phi.T @ full.B + more.y.T @ full.B_y])
    C = np.column_stack([full.C[:, keep], full.C @ more.phi + full.C_y @ more.y])
    D_mix = full.D_phi[keep] @ more.phi + full.D_mix[:, keep].T @ more.y
    D_more = (
        more.phi.T @ (full.D_phi @ more.phi + full.D_mix.T @ more.y)
        + more.y.T @ (full.D_mix @ more.phi + full.D_y @ more.y)
        + np.diag(full.alpha + full.beta * more.lam + 2 * full.ratio * np.sqrt(more.lam))
    )
    D = np.block([[full.D[np.ix_(keep, keep)], D_mix], [D_mix.T, D_more]])
    R = full.direct
    if feed_through:
        elastic = lam > 0
        held = C[:, elastic] @ (B[elastic] / lam[elastic, None])
        R = R + np.where(static_rows(full.ports)[:, None], full.static_response - held, 0.0)
    return Oscillators(lam, np.ones_like(lam), D, B, C, R, full.alpha)
