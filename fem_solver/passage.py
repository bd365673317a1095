"""Nodes on their way through a step: in contact, partly released, free, or in reverse.

Each change of a node takes its own time, which follows from the path of the edge (see ``contact_problem``).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fem_solver.components import Components, VariablesOfParts
from fem_solver.node_parts import NodeParts, NodeStrips

Array = NDArray[np.float64]

_LEAST_SHARE = 1e-6
"""Share of a node's contact below which what it would have in full contact is that of one just covered."""


@dataclass(frozen=True)
class PartlyReleased:
    """The node in contact in part where a step begins: its place in a range, share and ``v`` in contact."""

    at: int
    share: float
    contact: float


@dataclass
class NodePassage:
    """Components of a range of nodes on their way through a step; sums up energies if asked to.

    ``held`` are the branch variables of the partly released node if it were in contact: (branches,) those at
    the begin of the step, (branches, 1) those at its end. ``beyond`` is what radii that the edge has passed
    in the step, and those of the same node on their side before, hold beyond the means (see ``borders``);
    ``strips`` those of the partly released node, where they are known.
    """

    solid: Components
    v: Array
    b: Array
    held: Array
    accounts: bool
    dissipated: float = 0.0
    received: float = 0.0
    beyond: VariablesOfParts | None = None
    strips: NodeStrips | None = None

    def towards(self, other: NodePassage, share: float) -> NodePassage:
        """The passage at a share of the way in penetration to another one's, of which all is linear."""
        v, b, held = (
            one + share * (there - one)
            for one, there in ((self.v, other.v), (self.b, other.b), (self.held, other.held))
        )
        return NodePassage(self.solid, v, b, held, self.accounts)

    def linear(self, dt: Array, reached: Array) -> None:
        """``v`` goes linearly to ``reached``."""
        after = self.solid.linear(self.v, self.b, dt, reached)
        if self.accounts:
            mean = 0.5 * (self.solid.force(self.v, self.b) + self.solid.force(reached, after))
            self.received += float(np.sum(mean * (reached - self.v)))
            lossy = (dt > 0.0) & np.isfinite(dt)
            if lossy.any():
                parts = (self.v[lossy], self.b[:, lossy], dt[lossy], reached[lossy])
                self.dissipated += float(np.sum(self.solid.loss(*parts)))
        self.v, self.b = reached, after

    def at_once(
        self, dt: float, share: Array, imposed: Array, free: Array, partly: PartlyReleased | None
    ) -> None:
        """All nodes go linearly to their ends together, in no time or from nothing."""
        reached = share * imposed + (1.0 - share) * free
        top = int(np.count_nonzero(share == 1.0))
        v, b, stays_free = self.v[top : top + 1], self.b[:, top : top + 1], None
        if partly is not None:
            at = partly.at
            reached[at] = self._reached_in_part(partly, float(share[at]), float(imposed[at]))
            if self.accounts:
                contact = self._in_part(at, partly.share, np.array([partly.contact]))
                self._keep(contact.jumped(float(imposed[at]), float(share[at])))
            if at == top and share[at] > partly.share:
                stays_free = (1.0 - share[at]) * self._free_from(at, partly.share, float(share[at]))
            elif at == top:
                v, b = np.array([partly.contact]), self._held_up_to(float(share[at]))[:, None]
        held = self.solid.linear(v, b, dt, imposed[top : top + 1])
        self.linear(np.full(len(self.v), dt), reached)
        if stays_free is not None:  # radii just covered have jumped from elsewhere than those in contact
            held = (self.b[:, top] - stays_free)[:, None] / share[top]
        self.held = held

    def _reached_in_part(self, partly: PartlyReleased, share: float, imposed: float) -> float:
        """Mean of the node in contact in part after a change in no time.

        Its radii in contact follow the indenter, the others stay; the edge releases the former or covers the
        latter.
        """
        at, before, glassy = partly.at, partly.share, self.solid.modulus.glassy
        v, force = self.v[at], self.solid.force(self.v, self.b)[at]
        remaining = self._held_up_to(share)[:, None]
        held = self.solid.force(np.array([partly.contact]), remaining)[0]
        held += glassy * (imposed - partly.contact)
        if share <= before:
            return float(v + (share * held - force) / glassy)
        whole = force + glassy * (imposed - v)  # of the node in full contact
        if share < 1.0:
            free = self._free_from(at, before, share)
            whole -= (1.0 - share) * glassy * (imposed + float(free.sum()) / self.solid.modulus.relaxed)
        return float(v + (whole - force) / glassy)

    def creep(self, dt: Array, force: Array) -> None:
        """The force goes linearly to ``force``."""
        v, b = self.solid.crept(self.v, self.b, dt, force)
        if self.accounts:
            work = self.solid.work_of_creep(self.v, self.b, dt, force, v)
            change = self.solid.stored(v, b) - self.solid.stored(self.v, self.b)
            self.received += float(np.sum(work))
            self.dissipated += float(np.sum(work - change))
        self.v, self.b = v, b

    def recover(self, dt: Array) -> None:
        """Without force, where that takes any time."""
        free = dt > 0.0
        if not free.any():
            return
        v, b = self.v.copy(), self.b.copy()
        v[free], b[:, free] = self.solid.recovered(b[:, free], dt[free])
        if self.accounts:
            self.dissipated += float(np.sum(self.solid.stored(self.v, self.b) - self.solid.stored(v, b)))
        self.v, self.b = v, b

    def release(
        self,
        dt: float,
        share: float,
        first: Array,
        last: Array,
        imposed: Callable[[Array], Array],
        partly: int,
        before: float,
    ) -> None:
        """Nodes left behind from shares ``first`` of the step to ``last``, the first of them in part."""
        begun, reached, length = imposed(first), imposed(last), (last - first) * dt
        self.linear(first * dt, np.where(first > 0.0, begun, self.v))
        contact = self.b.copy()  # of the radii in contact
        if partly < len(first):
            contact[:, partly] = self.held
        lost, beyond = np.zeros(0), None
        if self.accounts:
            shares, remaining, free = np.ones(len(first)), np.zeros(len(first)), np.zeros_like(contact)
            remaining[0] = share
            if partly < len(first):
                shares[partly] = before
                free[:, partly] = self._free_radii(partly, before, begun)
            times, parts = (length, (1.0 - last) * dt), (begun, contact)
            lost, beyond = self.solid.lost_by_release(times, (shares, remaining), parts, reached, free)
        # the node that remains in part, as if it had stayed in contact
        stays = self._held_up_to(share)[:, None] if partly == 0 else contact[:, :1]
        self.held = self.solid.linear(begun[:1], stays, length[:1], reached[:1])
        force, dissipated = np.zeros(len(first)), self.dissipated
        force[0] = share * self.solid.force(reached[:1], self.held)[0]
        self.creep(length, force)
        self._lose(lost, dissipated)
        self._keep(beyond)
        self.recover((1.0 - last) * dt)

    def _held_up_to(self, share: float) -> Array:
        """``b`` of the radii in contact up to a share of the node in contact in part; shape (branches,)."""
        return self.held if self.strips is None else self.strips.mean(0.0, share)

    def _free_from(self, node: int, before: float, share: float) -> Array:
        """``b`` of its free radii beyond a share, of which one part was in contact before; (branches,)."""
        if self.strips is not None and share < 1.0:
            return self.strips.mean(share, 1.0)
        return np.asarray((self.b[:, node] - before * self.held) / (1.0 - before))

    def _free_radii(self, node: int, share: float, imposed: Array) -> Array:
        """``b`` of the free radii of a node in contact in part, to count what they hold: (branches,)."""
        return self._in_part(node, share, imposed[node : node + 1]).free[1][:, 0]

    def _in_part(self, node: int, share: float, imposed: Array) -> NodeParts:
        """A node in contact in part at the begin of the step; ``imposed`` of shape (1,)."""
        mean = self.v[node : node + 1], self.b[:, node : node + 1]
        return NodeParts(self.solid, share, mean, (imposed, self.held[:, None]))

    def _keep(self, beyond: VariablesOfParts | None) -> None:
        """Keep what radii hold beyond the means, which the surface has received beside what these have."""
        if beyond is not None:
            self.received += float(np.sum(self.solid.stored(*beyond)))
            self.beyond = beyond

    def _lose(self, lost: Array, before: float) -> None:
        """Count what the parts of the nodes lose instead of what their means have lost.

        The surface receives the difference.
        """
        if self.accounts:
            beyond = float(lost.sum()) - (self.dissipated - before)
            self.received += beyond
            self.dissipated += beyond

    def cover(
        self,
        dt: float,
        share: Array,
        first: Array,
        last: Array,
        imposed: Callable[[Array], Array],
        before: float,
    ) -> None:
        """Nodes covered from shares ``first`` of the step to ``last``, the last of them in part."""
        self.recover(first * dt)
        length, free, reached = (last - first) * dt, self.b.copy(), imposed(last)
        free[:, 0] = self._free_from(0, before, float(share[0]))
        lost, beyond, dissipated = np.zeros(0), None, self.dissipated
        if self.accounts:
            shares, contact, counted = np.zeros(len(first)), np.zeros_like(free), free.copy()
            shares[0], contact[:, 0] = before, self.held
            counted[:, 0] = self._free_radii(0, before, imposed(first))
            parts = imposed(first), contact
            times = length, (1.0 - last) * dt
            lost, beyond = self.solid.lost_by_cover(times, (shares, share), parts, reached, counted)
        v, free = self.solid.recovered(free, length)
        self.linear(length, share * reached + (1.0 - share) * v)
        self._lose(lost, dissipated)
        self._keep(beyond)
        if share[-1] > _LEAST_SHARE:
            self.held = (self.b[:, -1:] - (1.0 - share[-1]) * free[:, -1:]) / share[-1]
        else:
            self.held = self.solid.linear(v[-1:], free[:, -1:], 0.0, imposed(last)[-1:])
        self.linear((1.0 - last) * dt, np.where(last < 1.0, imposed(np.ones(1)), self.v))
