"""Elastic contact whose edge opens at one work of adhesion and closes at a smaller one.

While the edge moves, the contact follows the branch of its direction, JKR (or finite zone) with the work of
that direction; between the two the edge is pinned, and force against penetration is the straight line of a
flat punch, ``dF = 2 E* a dD``. Over a closed loop between two radii the interface spends
``(work - work_closing) pi (a_max^2 - a_min^2)`` and nothing else is lost, unless the edge snaps.
(D. Maugis and M. Barquins, J. Phys. D 11, 1989 (1978), Sec. 3; Y.L. Chen, C.A. Helm, J.N. Israelachvili,
J. Phys. Chem. 95, 10736 (1991).)
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

from validation.reference.jkr import ElasticContact, NoEquilibrium


class EquilibriumBranch(Protocol):
    """Equilibria of an elastic contact at one work of adhesion, as :class:`~validation.reference.jkr.JKR`."""

    def at_penetration(self, penetration: float) -> ElasticContact:
        """The stable state at a given penetration."""
        ...


@dataclass(frozen=True)
class AdhesionHysteresis:
    """The two branches of a body of ``plane_modulus``: ``opening`` and ``closing``."""

    opening: EquilibriumBranch
    closing: EquilibriumBranch
    plane_modulus: float

    def path(self, penetrations: Sequence[float]) -> list[ElasticContact]:
        """States at penetrations that are passed one after the other, from a contact that has closed."""
        states = [self.closing.at_penetration(penetrations[0])]
        for penetration in penetrations[1:]:
            states.append(self._next(states[-1], penetration))
        return states

    def _next(self, state: ElasticContact, penetration: float) -> ElasticContact:
        if penetration > state.penetration:
            moved = self._branch(self.closing, penetration)
            if moved is not None and moved.contact_radius > state.contact_radius:
                return moved
        else:
            moved = self.opening.at_penetration(penetration)
            if moved.contact_radius < state.contact_radius:
                return moved
        force = state.force + 2.0 * self.plane_modulus * state.contact_radius * (
            penetration - state.penetration
        )
        return ElasticContact(state.contact_radius, penetration, force)

    @staticmethod
    def _branch(branch: EquilibriumBranch, penetration: float) -> ElasticContact | None:
        """The stable state of a branch; ``None`` where it has none and the edge is pinned all the same."""
        try:
            return branch.at_penetration(penetration)
        except NoEquilibrium:
            return None
