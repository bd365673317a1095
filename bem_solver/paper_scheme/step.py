"""One step on uniform annuli: the equilibrium at its end, and where in it the contact is lost.

Nothing here changes the committed state, only the loop in ``solver`` does.
"""

from __future__ import annotations

from dataclasses import dataclass

from bem_solver.creep import Chain
from bem_solver.loading_intervals import LoadingInterval
from bem_solver.paper_scheme.annuli import AnnuliState, ContactCandidates, UniformAnnuli, equilibrium_contact
from contact_scene import Counters, Outcome, OutcomeKind

_HALVINGS = 8
"""Halvings of the step in which contact is lost: far below its error, which is of first order."""


@dataclass(frozen=True)
class StepEnd:
    """What a step leads to.

    Attributes
    ----------
    surface
        The state to commit; ``None`` if there is none.
    event
        Instability of the state before; ``None`` if there is none.
    outcome
        With which the run ends, unless ``below_zone``; ``None`` if it goes on.
    below_zone
        Whether the contact has become as short as the process zone, with which the run ends.
    """

    surface: AnnuliState | None
    event: str | None = None
    outcome: Outcome | None = None
    below_zone: bool = False


@dataclass(frozen=True)
class UniformStep:
    """Steps of a loading interval from a committed state.

    Attributes
    ----------
    annuli, chain, work, counters
        Of the run; ``work`` of adhesion.
    most
        Annuli in the largest contact allowed for.
    capped
        Whether the indenter has an edge, which a contact cannot pass.
    before
        State at the start.
    interval
        What is prescribed.
    """

    annuli: UniformAnnuli
    chain: Chain
    work: float
    counters: Counters
    most: int
    capped: bool
    before: AnnuliState
    interval: LoadingInterval

    def end(self, parameter: float) -> StepEnd:
        """Where the step to a parameter of the interval leads.

        An edge that travels more than a process zone in a step is recorded as unstable. A contact that would
        become shorter than the zone ends with that length.
        """
        before, interval, zone = self.before, self.interval, self.annuli.zone
        candidates, contact = self._equilibrium(parameter)
        if contact is None:
            reason = "the contact spreads beyond the annuli"
            return StepEnd(None, outcome=Outcome(OutcomeKind.OUT_OF_RANGE, reason, before.time))
        time, value = interval.time(parameter), interval.prescribed(parameter)
        if contact == 0 < before.contact and self.work > 0.0 and not interval.jump:
            last = self._last_contact(parameter)
            if last is not None:
                time, contact = interval.time(last), zone
                candidates, _ = self._equilibrium(last)
        lost = contact == 0 and before.contact > 0
        below_zone = self.work > 0.0 and 0 < contact <= zone
        if below_zone:
            contact = zone
        event = None
        if lost or (self.work > 0.0 and abs(contact - before.contact) > zone and not below_zone):
            event = "snap-in" if contact > before.contact else "pull-off"
        if lost and self.work > 0.0:
            reason = f"no stable contact at {interval.control} {value:.6g}"
            return StepEnd(None, event, Outcome(OutcomeKind.DETACHED, reason, before.time))
        if contact == 0 and not lost and interval.control == "force" and value < 0.0:
            reason = "pulled without contact"
            return StepEnd(None, event, Outcome(OutcomeKind.DETACHED, reason, before.time))
        surface = candidates.state(contact, time)
        outcome = Outcome(OutcomeKind.DETACHED, "the contact area fell to zero", time) if lost else None
        return StepEnd(surface, event, outcome, below_zone)

    def _equilibrium(self, parameter: float) -> tuple[ContactCandidates, int | None]:
        """The contacts possible at a parameter, and the annuli in the stable one, if there is any."""
        before, interval = self.before, self.interval
        duration = 0.0 if interval.jump else interval.time(parameter) - before.time
        candidates = ContactCandidates(
            self.annuli,
            self.chain,
            before,
            duration,
            interval.control,
            interval.prescribed(parameter),
            self.counters,
        )
        return candidates, equilibrium_contact(candidates, before.contact, self.most, self.capped, self.work)

    def _last_contact(self, parameter: float) -> float | None:
        """Where in a step that loses it the contact is last in equilibrium.

        ``None`` if it is longer there than the process zone, by more than the annulus that is the accuracy of
        an edge: then it is lost at a limit point.
        """
        low, high = self.before.time - self.interval.start, parameter
        contact = self.before.contact
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            reached = self._equilibrium(middle)[1]
            if reached:
                low, contact = middle, reached
            else:
                high = middle
        return low if contact <= self.annuli.zone + 1 else None
