"""Nodes on their way through a step, and what radii within a node have been through.

In contact, partly released, free, or in reverse: each change of a node takes its own time, which follows from
the path of the edge (see ``contact_problem``). A node in contact in part is kept by strips, in the order of
their radii (:class:`NodeStrips`). Of the nodes that the edge has left, what radii hold beyond the mean is
kept as an energy: that of one more component without a profile, at the place where a step began
(:class:`NodeBorders`). In contact its ``v`` is zero, outside it bears no force, and the edge releases and
covers it as it passes the place. It is much where an edge that has rested sets off or jumps by less than a
node, and little where it goes on.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fem_solver.components import Components, VariablesOfParts

Array = NDArray[np.float64]

_MOST = 64
"""Strips kept of a node, and borders: an edge that swings leaves one in each step, and few hold much or
differ. The energy of borders that hold least counts as dissipated."""
_LEAST_SHARE = 1e-3
"""Share of a node in contact, or free, below which its mean does not tell what those radii have been through:
mean and radii of the other part agree to the second order of a step, which is divided by this share."""


@dataclass(frozen=True)
class NodeStrips:
    """Strips of the node in contact in part, from the inner to the outer, each with a past of its own.

    What an edge has left last it covers first, and what it has covered last it leaves first. ``shares`` of
    the node are 1 in sum, ``b`` has shape (branches, strips). ``turned``: the edge has begun to recede within
    the node, where the fields jump.
    """

    shares: Array
    b: Array
    turned: bool = False

    @classmethod
    def two(cls, share: float, held: Array, free: Array, turned: bool) -> NodeStrips:
        """A part in contact, and one free; ``held`` and ``free`` have shape (branches,)."""
        return cls(np.array([share, 1.0 - share]), np.stack([held, free], axis=1), turned)

    def within(self, low: float, high: float) -> tuple[Array, Array]:
        """Shares (k,) and branch variables (branches, k) of the strips between two shares of the node."""
        ends = np.cumsum(self.shares)
        shares = np.minimum(ends, high) - np.maximum(ends - self.shares, low)
        kept = shares > 0.0
        return shares[kept], self.b[:, kept]

    def mean(self, low: float, high: float) -> Array:
        """Mean of the branch variables between two shares of the node; shape (branches,)."""
        shares, b = self.within(low, high)
        if shares.size:
            return np.asarray(b @ shares / shares.sum())
        at = int(np.searchsorted(np.cumsum(self.shares), low, side="right"))
        return self.b[:, min(at, len(self.shares) - 1)]

    def few(self) -> NodeStrips:
        """The two neighbours most alike as one, where there are too many."""
        if self.shares.size <= _MOST:
            return self
        one, other = self.shares[:-1], self.shares[1:]
        weights = one * other / (one + other)
        at = int(np.argmin(weights * np.sum(np.diff(self.b, axis=1) ** 2, axis=0)))
        joined = self.b[:, at : at + 2] @ self.shares[at : at + 2] / self.shares[at : at + 2].sum()
        b = np.delete(self.b, at + 1, axis=1)
        b[:, at] = joined
        return NodeStrips(np.concatenate([one[:at], [one[at] + other[at]], other[at + 1 :]]), b, self.turned)


@dataclass(frozen=True)
class NodeParts:
    """A node of which a ``share`` below 1 is in contact: the mean of its radii, and those in contact.

    Each pair is ``v`` of shape (1,) and ``b`` of shape (branches, 1).
    """

    solid: Components
    share: float
    mean: VariablesOfParts
    contact: VariablesOfParts

    @property
    def free(self) -> VariablesOfParts:
        """The free radii; where they are too few for the mean to tell, radii that are released now."""
        if 1.0 - self.share < _LEAST_SHARE:
            return self.released
        (v, b), (imposed, held) = self.mean, self.contact
        return (v - self.share * imposed) / (1.0 - self.share), (b - self.share * held) / (1.0 - self.share)

    @property
    def released(self) -> VariablesOfParts:
        """Radii in contact right after their release."""
        v = self.solid.relieved(*self.contact, 0.0)
        return v, self.solid.linear(*self.contact, 0.0, v)

    @property
    def energy_beyond_mean(self) -> float:
        """What the radii in contact and the free ones hold beyond their mean."""
        if self.share == 0.0:
            return 0.0
        (v, b), (imposed, held) = self.free, self.contact
        apart = self.solid.stored(imposed - v, held - b)
        return self.share * (1.0 - self.share) * float(apart[0])

    def jumped(self, imposed: float, share: float) -> VariablesOfParts:
        """What a load jump leaves beyond the means of the radii in contact, or of the free ones.

        Those on both sides of the place where the edge was have jumped from different states. With shares s
        and t of the node they hold, beyond their mean, what ``sqrt(s t/(s + t))`` of their difference holds.
        """
        before, to = self.share, np.array([imposed])
        (v, b), held = self.free, self.solid.linear(*self.contact, 0.0, to)
        if share > before:
            weight = np.sqrt(before * (share - before) / share)
            return np.zeros(1), weight * (self.solid.linear(v, b, 0.0, to) - held)
        left, released = NodeParts(self.solid, before, self.mean, (to, held)).released
        weight = np.sqrt((1.0 - before) * (before - share) / (1.0 - share))
        return weight * (left - v), weight * (released - b)


@dataclass(frozen=True)
class NodeBorders:
    """What radii hold beyond the means of their nodes, each at the contact radius at which a step began."""

    radii: Array
    v: Array
    b: Array

    @classmethod
    def none(cls, branches: int) -> NodeBorders:
        """No step so far."""
        return cls(np.zeros(0), np.zeros(0), np.zeros((branches, 0)))

    def stored(self, solid: Components) -> float:
        """Energy of the springs."""
        return float(np.sum(solid.stored(self.v, self.b)))

    def with_border(self, radius: float, difference: VariablesOfParts) -> NodeBorders:
        """One more."""
        v, b = difference
        return NodeBorders(np.append(self.radii, radius), np.append(self.v, v), np.hstack([self.b, b]))

    def most_energetic(self, solid: Components) -> NodeBorders:
        """Without those that hold least, where there are too many."""
        if self.radii.size <= _MOST:
            return self
        kept = np.sort(np.argsort(solid.stored(self.v, self.b))[-_MOST:])
        return NodeBorders(self.radii[kept], self.v[kept], self.b[:, kept])

    def after(
        self, solid: Components, dt: float, edge: tuple[float, float], moments: Callable[[Array], Array]
    ) -> tuple[NodeBorders, float, float]:
        """At the end of a step, every one released or covered in its own time."""
        if not self.radii.size:
            return self, 0.0, 0.0
        held, holds = (self.radii < radius for radius in edge)
        share = np.where(held == holds, 1.0, moments(self.radii))
        until = self._relaxed(solid, held, share * dt)
        if np.array_equal(held, holds):
            return until, self.stored(solid) - until.stored(solid), 0.0
        passed = until._passed(solid, holds)
        last = passed._relaxed(solid, holds, (1.0 - share) * dt)
        before, reached, left, after = (one.stored(solid) for one in (self, until, passed, last))
        return last, before - reached + left - after, left - reached

    def _relaxed(self, solid: Components, held: NDArray[np.bool_], time: Array) -> NodeBorders:
        """After times in contact, or without force."""
        v, b = solid.recovered(self.b, time)
        within = solid.linear(self.v, self.b, time, self.v)
        return NodeBorders(self.radii, np.where(held, self.v, v), np.where(held, within, b))

    def _passed(self, solid: Components, holds: NDArray[np.bool_]) -> NodeBorders:
        """Covered and released: what the edge has not passed stays."""
        v = np.where(holds, 0.0, solid.relieved(self.v, self.b, 0.0))
        return NodeBorders(self.radii, v, solid.linear(self.v, self.b, 0.0, v))


@dataclass(frozen=True)
class PartlyReleased:
    """The node in contact in part where a step begins: its place in a range, share and ``v`` in contact."""

    at: int
    share: float
    contact: float


@dataclass
class NodePassage:
    """Components of a range of nodes on their way through a step; sums up energies if asked to.

    Without energies there may be several ``ways``, for as many penetrations: the nodes of one behind those of
    another. ``held`` are the branch variables of the partly released node if it were in contact: (branches,)
    those at the begin of the step, (branches, 1) those at its end, with energies. What stays in
    contact is ``shallower`` than its node was: no strain. ``opening`` is the work of the forces on the gap;
    that of the indenter is counted elsewhere. ``beyond`` is what radii that the edge has passed in the step,
    and those of the same node on their side before, hold beyond the means (see ``borders``); ``strips``
    those of the partly released node, where they are known.
    """

    solid: Components
    v: Array
    b: Array
    held: Array
    accounts: bool
    shallower: Array | float = 0.0
    dissipated: float = 0.0
    opening: float = 0.0
    beyond: VariablesOfParts | None = None
    strips: NodeStrips | None = None
    ways: int = 1

    def _on_each(self, node: int) -> slice:
        """A node on each of the ways."""
        return slice(node, None, len(self.v) // self.ways)

    def between(self, share: float) -> NodePassage:
        """At a share of the way in penetration from the first of two to the second: all is linear in it."""
        count = len(self.v) // 2
        v, b = self.v[:count], self.b[:, :count]
        v, b = v + share * (self.v[count:] - v), b + share * (self.b[:, count:] - b)
        return NodePassage(self.solid, v, b, self.held, False)

    def linear(self, dt: Array, reached: Array, indented: Array | None = None) -> None:
        """``v`` goes linearly to ``reached``, by ``indented`` with the indenter: all the way in contact."""
        after = self.solid.linear(self.v, self.b, dt, reached)
        if self.accounts:
            if indented is not None:
                mean = self.solid.mean_force(self.v, self.b, dt, reached)
                self.opening += float(np.sum(mean * (reached - self.v - indented)))
            lossy = (dt > 0.0) & np.isfinite(dt)
            if lossy.any():
                parts = (self.v[lossy], self.b[:, lossy], dt[lossy], reached[lossy])
                self.dissipated += float(np.sum(self.solid.loss(*parts)))
        self.v, self.b = reached, after

    def at_once(
        self,
        dt: float,
        share: Array,
        begun: Array,
        imposed: Array,
        free: Array,
        partly: PartlyReleased | None,
    ) -> None:
        """All nodes go linearly to their ends together, in no time or from nothing."""
        relaxed = self.solid.modulus.relaxed / self.solid.modulus.glassy
        reached = share * (imposed + (1.0 - relaxed) * self.shallower) + (1.0 - share) * free
        if partly is not None:
            at, here = partly.at, self._on_each(partly.at)
            reached[here] = self._reached_in_part(partly, float(share[at]), imposed[here])
        if self.accounts:
            self.held = self._held_at_once(dt, share, imposed, reached, partly)
        self.linear(np.full(len(self.v), dt), reached, imposed - begun)

    def _held_at_once(
        self, dt: float, share: Array, imposed: Array, reached: Array, partly: PartlyReleased | None
    ) -> Array:
        """``held`` behind :meth:`at_once`, and what that leaves beyond the means."""
        top = int(np.count_nonzero(share == 1.0))
        v, b = self.v[top : top + 1], self.b[:, top : top + 1]
        if partly is not None:
            at, after = partly.at, float(share[partly.at])
            contact = self._in_part(at, partly.share, np.array([partly.contact]))
            self._keep(contact.jumped(float(imposed[at]), after))
            if at == top and after > partly.share:
                # radii just covered jump from elsewhere than those in contact
                b = self.solid.linear(v, b, dt, reached[top : top + 1])
                return (b - (1.0 - after) * self._free_from(at, partly.share, after)[:, None]) / after
            if at == top:
                v, b = np.array([partly.contact]), self._held_up_to(after)[:, None]
                return self.solid.linear(v, b, dt, imposed[top : top + 1])
        return self.solid.linear(v, b, dt, (imposed + self.shallower)[top : top + 1])

    def _reached_in_part(self, partly: PartlyReleased, share: float, imposed: Array) -> Array:
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
            return np.asarray(v + (share * held - force) / glassy)
        whole = force + glassy * (imposed - v)  # of the node in full contact
        if share < 1.0:
            free = self._free_from(at, before, share)
            whole -= (1.0 - share) * glassy * (imposed + float(free.sum()) / self.solid.modulus.relaxed)
        return np.asarray(v + (whole - force) / glassy)

    def creep(self, dt: Array, force: Array, indented: Array) -> None:
        """The force goes linearly to ``force``, the indenter by ``indented``."""
        v, b = self.solid.crept(self.v, self.b, dt, force)
        if self.accounts:
            work = self.solid.work_of_creep(self.v, self.b, dt, force, v)
            change = self.solid.stored(v, b) - self.solid.stored(self.v, self.b)
            mean = 0.5 * (self.solid.force(self.v, self.b) + force)
            self.opening += float(np.sum(work - mean * indented))
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
        self.linear(first * dt, np.where(first > 0.0, begun + self.shallower, self.v))
        contact = self.b.copy()  # of the radii in contact
        if partly < len(first) // self.ways:
            contact[:, self._on_each(partly)] = self.held[:, None]
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
        each = self._on_each(0)
        stays = self._held_up_to(share)[:, None] if partly == 0 else contact[:, each]
        self.held = self.solid.linear(begun[each], stays, length[each], reached[each])
        force, dissipated = np.zeros(len(first)), self.dissipated
        force[each] = share * self.solid.force(reached[each], self.held)
        self.creep(length, force, reached - begun)
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
        """Keep what radii hold beyond the means, which opening has given beside what these have."""
        if beyond is not None:
            self.opening += float(np.sum(self.solid.stored(*beyond)))
            self.beyond = beyond

    def _lose(self, lost: Array, before: float) -> None:
        """Count what the parts of the nodes lose instead of what their means have lost.

        Opening gives the difference.
        """
        if self.accounts:
            beyond = float(lost.sum()) - (self.dissipated - before)
            self.opening += beyond
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
        free[:, self._on_each(0)] = self._free_from(0, before, float(share[0]))[:, None]
        lost, beyond, dissipated = np.zeros(0), None, self.dissipated
        if self.accounts:
            shares, contact, counted = np.zeros(len(first)), np.zeros_like(free), free.copy()
            shares[0], contact[:, 0] = before, self.held
            counted[:, 0] = self._free_radii(0, before, imposed(first))
            parts = imposed(first), contact
            times = length, (1.0 - last) * dt
            lost, beyond = self.solid.lost_by_cover(times, (shares, share), parts, reached, counted)
        v, free = self.solid.recovered(free, length)
        self.linear(length, share * reached + (1.0 - share) * v, reached - imposed(first))
        self._lose(lost, dissipated)
        self._keep(beyond)
        if share[-1] > _LEAST_SHARE:
            self.held = (self.b[:, -1:] - (1.0 - share[-1]) * free[:, -1:]) / share[-1]
        else:
            self.held = self.solid.linear(v[-1:], free[:, -1:], 0.0, imposed(last)[-1:])
        self.linear((1.0 - last) * dt, np.where(last < 1.0, imposed(np.ones(1)), self.v))
