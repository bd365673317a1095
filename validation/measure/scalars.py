"""Every scalar of a run by name."""

from __future__ import annotations

from contact_scene import Scene, Trace
from validation.measure.cycle_losses import cycle_losses
from validation.measure.falling_loss import largest_fall
from validation.measure.observables import at_last_contact, observe
from validation.measure.windows import cycle_times


def measure(trace: Trace, scene: Scene, wall_seconds: float) -> dict[str, float | None]:
    """Observables, cycle losses, work counters and run time; ``None`` where one does not apply.

    Parameters
    ----------
    trace : Trace
    scene : Scene
    wall_seconds : float
        Run time (s).

    Returns
    -------
    dict of str to float or None
    """
    zone = scene.adhesion.zone if scene.adhesion is not None and scene.is_adhesive else 0.0
    observed = observe(trace, zone, scene.loading, scene.ends_in_a_point)
    values: dict[str, float | None] = dict(observed.as_dict())
    stored = float(trace.stored_energy.max()) if len(trace) else 0.0
    branches, loss = at_last_contact(trace, "branch_dissipation", zone), values["dissipated_energy"]
    values["branch_dissipation"] = branches
    values["zone_excess"] = branches - loss if branches is not None and loss is not None else None
    values["loss_fall"] = largest_fall(trace)[0] if len(trace) else None
    values["loss_share"] = loss / stored if loss is not None and stored > 0.0 else None
    cycles = cycle_losses(trace, cycle_times(scene.loading))
    peak = max(cycles, key=lambda cycle: cycle.loop, default=None)
    values["peak_cycle_loss"] = peak.loop if peak else None
    values["peak_cycle_frequency"] = peak.angular_frequency if peak else None
    values |= {f"counters.{name}": float(count) for name, count in vars(trace.counters).items()}
    values["wall_seconds"] = wall_seconds
    return values
