"""The modulus with which the surface answers to what differs within a node, as two moduli in series.

In the components ``v = L^-1 u``, ``y = L^T f`` of the surface (see ``surface``) the depth of a part of a node
is ``v/e``, ``e = L^-1 1``; the half-space answers to it with the one modulus that a frictionless surface
knows, ``1/E* = 1/(4 G) + 3/(4 (3 K + G))``, so ``y/e`` follows it as two moduli in series do; as one, ``G``,
where all relax alike. The energies are those of the body: what ``1/(2 G)`` answers to the pressures of the
surface changes no volume, what ``3/(2 (3 K + G))`` answers does, and holds a third of its shear energy beside
it; neither works on the other, and each energy is a multiple of the same form of the pressures (by
Clapeyron's theorem, from the derivatives of ``1/E*`` with respect to G and K).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fem_solver.prony import Increment, Prony, RelaxingField

Array = NDArray[np.float64]

_LEAST_SHARE = 1e-14
"""Modulus of a branch, relative to the glassy one, that is a rounding error."""


class OneModulus:
    """Two moduli that bear the same stress, as one of the sum of their strains.

    The energy of springs and dashpots over the strain ``x`` and those ``q`` of the dashpots of both,
    ``m(0) x^2/2 - x g.q + q.H q/2`` once the strain of the first modulus is eliminated, with the loss
    ``sum_k m_k tau_k q_k'^2``: in the eigenvectors of ``H`` with respect to that loss each internal variable
    goes its own way, as in a Maxwell branch, with the same energies. What no strain reaches is left out.

    Parameters
    ----------
    one, other : Prony

    Attributes
    ----------
    modulus : Prony
    """

    def __init__(self, one: Prony, other: Prony) -> None:
        whole = one.glassy + other.glassy
        self._share = other.glassy / whole  # of the strain, taken by the first modulus in a jump
        self._count = len(one.moduli)
        coupling = np.append(self._share * one.moduli, (1.0 - self._share) * other.moduli)
        self._signed = np.append(one.moduli, -other.moduli) / whole
        stiffness = np.diag(np.append(one.moduli, other.moduli))
        stiffness -= whole * np.outer(self._signed, self._signed)
        root = np.sqrt(np.append(one.moduli * one.times, other.moduli * other.times))
        rates, modes = np.linalg.eigh(stiffness / np.outer(root, root))
        amplitudes = modes.T @ (coupling / root)
        moduli = amplitudes**2 / rates
        reached = moduli > _LEAST_SHARE * one.glassy * self._share
        relaxed = one.relaxed * other.relaxed / (one.relaxed + other.relaxed)
        self.modulus = Prony(relaxed, moduli[reached], 1.0 / rates[reached])
        self._dashpots = (modes[:, reached] * (amplitudes / rates)[reached]) / root[:, None]

    def parts(self, x: Array, branches: Array) -> tuple[StrainedModulus, StrainedModulus]:
        """What both moduli have gone through.

        Parameters
        ----------
        x : ndarray, shape (n,)
            Strain of the one modulus.
        branches : ndarray, shape (branches, n)
            Its branch variables.

        Returns
        -------
        tuple of StrainedModulus
        """
        dashpots = self._dashpots @ (x - branches / self.modulus.moduli[:, None])
        first = self._share * x + self._signed @ dashpots
        own, others = dashpots[: self._count], dashpots[self._count :]
        return StrainedModulus(first, first - own), StrainedModulus(x - first, x - first - others)


@dataclass(frozen=True)
class StrainedModulus:
    """Strain of a modulus, shape (n,), and of the springs of its branches, (branches, n)."""

    whole: Array
    springs: Array


@dataclass(frozen=True)
class SeriesModulus:
    """Moduli that bear the same stress ``y``: the depth is ``sum_j compliance_j x_j`` with ``m_j * x_j = y``.

    Parameters
    ----------
    moduli : tuple of Prony
    compliances : tuple of float
        Dimensionless weights of their strains.
    """

    moduli: tuple[Prony, ...]
    compliances: tuple[float, ...] = (1.0,)

    def at_rest(self) -> tuple[RelaxingField, ...]:
        """One undeformed strip."""
        return tuple(RelaxingField.at_rest(modulus, 1) for modulus in self.moduli)

    def step(self, dt: float) -> SeriesStep:
        """What a step does to states."""
        steps = tuple(modulus.increment(dt) for modulus in self.moduli)
        softness = sum(part / step.modulus for part, step in zip(self.compliances, steps, strict=True))
        return SeriesStep(self, steps, 1.0 / softness)

    def depths(self, parts: tuple[RelaxingField, ...]) -> Array:
        """Depth of each strip; shape (strips,)."""
        return np.asarray(sum(one * part.x for one, part in zip(self.compliances, parts, strict=True)))

    def stored(self, parts: tuple[RelaxingField, ...]) -> Array:
        """Energy of the springs of each strip, per square of ``e``; shape (strips,)."""
        springs = [
            weight
            * (
                part.modulus.relaxed * part.x**2
                + np.sum(part.branches**2 / part.modulus.moduli[:, None], axis=0)
            )
            for weight, part in zip(self.compliances, parts, strict=True)
        ]
        return 0.5 * np.sum(springs, axis=0)


@dataclass(frozen=True)
class SeriesStep:
    """A step of :class:`SeriesModulus`; ``modulus`` is the stress at its end per depth."""

    series: SeriesModulus
    increments: tuple[Increment, ...]
    modulus: float

    def memory_depth(self, parts: tuple[RelaxingField, ...]) -> Array:
        """Depth that would cause, without a past, the stress left at the end at no depth; shape (strips,)."""
        return self._depth_of(self._memories(parts))

    def advanced(self, parts: tuple[RelaxingField, ...], depth: Array) -> tuple[RelaxingField, ...]:
        """State of the strips at the end.

        Parameters
        ----------
        parts : tuple of RelaxingField
            State of each modulus at the begin.
        depth : ndarray, shape (strips,)
            At the end.

        Returns
        -------
        tuple of RelaxingField
        """
        memories = self._memories(parts)
        stress = self.modulus * (depth + self._depth_of(memories))
        reached = (
            (stress - left) / step.modulus for left, step in zip(memories, self.increments, strict=True)
        )
        return tuple(
            RelaxingField(part.modulus, x, step.advance(part.branches, x - part.x))
            for part, x, step in zip(parts, reached, self.increments, strict=True)
        )

    def _memories(self, parts: tuple[RelaxingField, ...]) -> list[Array]:
        return [
            step.decay @ part.branches - float(step.gain.sum()) * part.x
            for part, step in zip(parts, self.increments, strict=True)
        ]

    def _depth_of(self, memories: list[Array]) -> Array:
        depths = (
            weight * stress / step.modulus
            for weight, stress, step in zip(self.series.compliances, memories, self.increments, strict=True)
        )
        return np.asarray(sum(depths))
