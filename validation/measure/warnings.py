"""What a run says of itself beside its numbers: where it is in doubt, and which work it left out."""

from __future__ import annotations

from collections.abc import Mapping

from contact_scene import Scene, Trace
from validation.measure.observables import largest_fall
from validation.measure.scaling import scale
from validation.solvers import SOLVERS
from validation.solvers.base import SKIPPED_WORK


def fall_warnings(scene: Scene, trace: Trace, error: float) -> tuple[str, ...]:
    """A sentence on a loss that falls by more than its ``error``, relative as in ``scaling``."""
    if len(trace) == 0:
        return ()
    fall, begin, end = largest_fall(trace)
    largest = scale("loss_fall", fall, trace)
    if fall <= error * largest:
        return ()
    when = f"from t = {trace.time[begin]:.4g} to {trace.time[end]:.4g}"
    why = "without adhesion that is an error of the solver"
    if scene.adhesion is not None and scene.is_adhesive:
        zone = f"the adhesive closure over a zone of {scene.adhesion.zone:.3g}"
        why = f'{zone} does not balance energies there ("Where the loss falls" in the documentation)'
    return (f"the loss falls by {fall:.3g}, {fall / largest:.2g} of the largest energy, {when}: {why}",)


def left_out(scheme: str, counters: Mapping[str, float | None]) -> list[str]:
    """The parts of its work that a solver or scheme left out, in words; none if a counter is not known."""
    meanings = SOLVERS[scheme].skipped_work if scheme in SOLVERS else SKIPPED_WORK
    return [text for name, text in meanings.items() if counters.get(name) == 0]


def left_out_by_all(work: Mapping[str, Mapping[str, float | None]]) -> str:
    """A sentence on all solvers of a scene, ``work`` being their counters by name."""
    skipped = [f"{name}: {', '.join(parts)}" for name, c in work.items() if (parts := left_out(name, c))]
    if not skipped:
        return "Nothing was left out: by its counters every solver did all kinds of its work."
    return f"Left out because the scene did not need it, by the counters: {'; '.join(skipped)}."
