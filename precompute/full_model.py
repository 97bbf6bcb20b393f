"""The full model seen from its ports: exact modes and strain-energy coordinates beside them."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fmu_src.runtime.model import Port

from .arrays import Bools, Floats
from .oscillators import Complexes, Oscillators, amplitudes, resonances
from .transfer import Lines, lines_of, measured

SHARP = 1e-5  # |1 − ω²/λ| that samples keep from undamped resonances; less is no bound of theirs
SOFTEST = 1e-30  # of the largest μ: a motion without mass has θ = 1/μ = ∞


@dataclass(frozen=True, eq=False)  # arrays have no one truth value
class FullModel:
    """u = Φ q + Q y: M ü + D u̇ + K u = b u_in in coordinates where ΦᵀKΦ = Λ, QᵀKQ = I, ΦᵀMQ = 0.

    lam: (r,) of exact modes, the lowest, all rigid ones among them, 1/s²; D: (r, r) their damping;
    B: (r, n_u), C: (s, r) their loads and measured rows; alpha, beta, ratio: the damping of all the others;
    M: (q, q) QᵀMQ in s²; D_phi, D_mix, D_y: ΦᵀDΦ (r, r), QᵀDΦ (q, r) and QᵀDQ (q, q) of the damping that is
    neither Rayleigh's nor modal; B_y: (q, n_u), C_y: (s, q) in √J; W: (r, d), W_y: (q, d) the loads of
    dashpots, like B; direct: (s, n_u) the feed-through.
    trial: (q, k) orthonormal, the directions S in which y is sought (Galerkin); with them
    span(Q) holds the static response K⁺ to everything that the solution leaves unbalanced, so that the
    error is known from it (`remainder`).
    """

    ports: tuple[Port, ...]
    lam: Floats
    D: Floats
    B: Floats
    C: Floats
    alpha: float
    beta: float
    ratio: float
    M: Floats
    D_phi: Floats
    D_mix: Floats
    D_y: Floats
    B_y: Floats
    C_y: Floats
    W: Floats
    W_y: Floats
    direct: Floats
    trial: Floats

    @cached_property
    def lines(self) -> Lines:
        """The lines of H."""
        return lines_of(self.ports)

    @cached_property
    def ritz(self) -> tuple[Floats, Floats]:
        """μ (k,) in s², descending, and S (q, k): SᵀS = I, SᵀMS = diag μ; 1/√μ is a frequency in rad/s."""
        mu, X = np.linalg.eigh(self.trial.T @ self.M @ self.trial)
        return np.maximum(mu[::-1], 0.0), self.trial @ X[:, ::-1]

    @cached_property
    def oscillators(self) -> Oscillators:
        """The exact modes, then the Ritz vectors of the trial directions."""
        mu, S = self.ritz
        k = np.concatenate([self.lam, np.ones(len(mu))])
        m = np.concatenate([np.ones(len(self.lam)), mu])
        own = np.diag(self.alpha * mu + self.beta + 2 * self.ratio * np.sqrt(mu))
        D = np.block([[self.D, self.D_mix.T @ S], [S.T @ self.D_mix, S.T @ self.D_y @ S + own]])
        B, C = np.concatenate([self.B, S.T @ self.B_y]), np.column_stack([self.C, self.C_y @ S])
        return Oscillators(k, m, D, B, C, self.direct, self.alpha)

    @cached_property
    def resonances(self) -> tuple[Floats, Floats]:
        """Frequencies in Hz of exact modes and Ritz vectors as damping leaves them, and damping ratios."""
        return resonances(self.oscillators)

    @property
    def lowest_unknown(self) -> float:
        """λ in 1/s² below which no elastic mode answers to what is unbalanced; 0 where none is known.

        That is the highest exact mode, or the lowest elastic one where damping couples them to the others.
        """
        answering = self.lam[self.lam > 0][:1] if self.D_mix.any() else self.lam[-1:]
        return float(np.max(answering, initial=0.0))

    def remainder(self, omega: Floats, modal: Floats, load: Floats) -> Complexes:
        """Qᵀ(load − A(ω) u), (f, q, p): what the Galerkin solution u leaves of a load.

        modal: (r, p) and load: (q, p), Φᵀ and Qᵀ of the load. The Euclidean norm of what is left is
        that of the unbalanced force in K⁻¹, in √J, as span(Q) holds K⁺ of it. By the damping ratio a Ritz
        vector v of eigenvalue θ has D v = 2ζ√θ M v.
        """
        mu, S = self.ritz
        y = amplitudes(self.oscillators, omega, np.concatenate([modal, S.T @ load]))
        theta = 1 / np.maximum(mu, SOFTEST * np.max(mu, initial=1.0))
        MS = self.off_trial(self.M @ S)
        damped = MS * (self.alpha + 2 * self.ratio * np.sqrt(theta)) + self.off_trial(self.D_y @ S)
        damped = np.column_stack([self.off_trial(self.D_mix), damped])
        w, r = omega[:, None, None], len(self.lam)
        left: Complexes = self.off_trial(load) + w**2 * (MS @ y[:, r:]) - 1j * w * (damped @ y)
        return left

    def off_trial(self, A: Floats) -> Floats:
        """What of A (q, p) is orthogonal to the trial directions."""
        return np.asarray(A - self.trial @ (self.trial.T @ A))

    def stiffness(self, omega: Floats) -> Floats:
        """min |x*A(ω)x| / x*Kx of all motions x that may answer to what is unbalanced, (f,).

        With x*Mx = μ x*Kx, 0 < μ ≤ 1/λ of `lowest_unknown`, and damping δ ≥ 0 beyond Rayleigh's, that is
        |1 − ω²μ + iω(β + αμ + δ)|, least for δ = 0 and μ = (1 − αβ)/(ω² + α²) or what is nearest to it.
        With the damping ratio in place of α and β it is |1 − z² + 2iζz|, z ≤ ω/√λ.
        """
        alpha, beta, zeta = self.alpha, self.beta, self.ratio
        with np.errstate(divide="ignore"):
            end = 1 / np.float64(self.lowest_unknown)
        mu = np.clip((1 - alpha * beta) / (omega**2 + alpha**2), 0.0, end)
        z = np.minimum(np.sqrt(max(1 - 2 * zeta**2, 0.0)), omega * np.sqrt(end))
        rayleigh = np.abs(1 - omega**2 * mu + 1j * omega * (beta + alpha * mu))
        return np.asarray(np.maximum(rayleigh, np.abs(1 - z**2 + 2j * zeta * z)))

    def amplification(self, omega: Floats) -> Floats:
        """How much an unbalanced force, measured in K⁻¹, can move the body, measured in K: (f,)."""
        return 1 / np.maximum(self.stiffness(omega), SHARP)

    def proved(self, omega: Floats) -> Bools:
        """Where `amplification`, so the error of the responses, is a bound and no estimate, (f,).

        Not for a damping ratio, which Ritz vectors have in place of the modes that they stand for, nor where
        damping couples rigid modes, which have no stiffness, to the others.
        """
        known = self.ratio == 0 and not self.D_mix[:, self.lam == 0].any()
        return np.asarray(known & (self.stiffness(omega) >= SHARP))

    def unbalanced(self, omega: Floats) -> tuple[Complexes, Complexes]:
        """What the lines of H leave unbalanced, (f, p, q), and what the inputs do, (f, q, n_u)."""
        inputs = self.remainder(omega, self.B, self.B_y)
        rows = self.remainder(omega, self.C.T, self.C_y.T).transpose(0, 2, 1)
        nothing = np.zeros(rows.shape[1:])
        return measured(self.lines, rows, nothing, self.alpha, omega), inputs

    @cached_property
    def static_sizes(self) -> tuple[Floats, Floats]:
        """√(c K⁺cᵀ) of each measured row (s,) and √(bᵀK⁺b) of each input (n_u,)."""
        elastic = self.lam > 0
        omega = np.sqrt(self.lam[elastic])
        rows = np.column_stack([self.C[:, elastic] / omega, self.C_y])
        inputs = np.concatenate([self.B[elastic] / omega[:, None], self.B_y])
        return np.linalg.norm(rows, axis=1), np.linalg.norm(inputs, axis=0)

    @cached_property
    def static_response(self) -> Floats:
        """c K⁺b of the elastic body, (s, n_u)."""
        elastic = self.lam > 0
        modal: Floats = self.C[:, elastic] @ (self.B[elastic] / self.lam[elastic, None])
        return modal + self.C_y @ self.B_y
