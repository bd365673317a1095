"""Energy densities summed over the body, beside the energies of the trace.

The mesh ends at a finite radius: the trace counts the half-space outside it, the sum over elements does not
(a part of relative size ``a/R_far``). The energy stored in the trace also contains that of the hold on a
partly released node at the edge, which is no density in the body.

The loss in the branches is compared with the column of the trace that is its integral, and with what closes
the balance of the half-space without any such integral: work of the surface forces less stored energy.
Neither holds what a sharp tip makes the branches dissipate within an element, which ``branch_dissipation``
does. The loss of the whole balance ``F dD + dg dA = dU + dL`` is smaller by ``zone_excess`` where a sharp
edge dissipates what a process zone would have held (see ``fem_solver.recorder``). Where the mesh follows the
edge the sum over it is not known.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from contact_scene import Trace

if TYPE_CHECKING:
    from fem_solver import FieldState


@dataclass(frozen=True)
class EnergySums:
    """Sums over the mesh and their counterparts in the trace, at one row.

    Parameters
    ----------
    stored, stored_in_trace : float
        Elastic energy of all springs.
    dissipated_by_branch : dict of str to float, or None
        Energy lost since the start; ``None`` where the mesh follows the edge.
    dissipated : float or None
        Its sum over the branches.
    branch_dissipation, work_less_stored : float
        The trace's integral; what the work put in leaves unaccounted for.
    zone_excess, loss : float
        The named difference at the tip and the loss without it.
    """

    stored: float
    stored_in_trace: float
    dissipated_by_branch: dict[str, float] | None
    dissipated: float | None
    branch_dissipation: float
    work_less_stored: float
    zone_excess: float
    loss: float

    @property
    def error(self) -> float | None:
        """Relative difference of the sum over the mesh from the trace's loss; ``None`` without either."""
        if self.branch_dissipation == 0.0 or self.dissipated is None:
            return None
        return self.dissipated / self.branch_dissipation - 1.0

    @property
    def error_of_balance(self) -> float | None:
        """The same from what work and stored energy leave."""
        if self.work_less_stored == 0.0 or self.dissipated is None:
            return None
        return self.dissipated / self.work_less_stored - 1.0


def balance(state: FieldState, trace: Trace) -> EnergySums:
    """Sum the densities of a state."""
    lost = None
    if state.element_dissipated is not None:
        sums = (state.element_dissipated @ state.element_volumes).tolist()
        lost = dict(zip(state.branches, sums, strict=True))
    at = {name: float(column[state.row]) for name, column in trace.columns().items()}
    return EnergySums(
        stored=float(state.element_stored @ state.element_volumes),
        stored_in_trace=at["stored_energy"],
        dissipated_by_branch=lost,
        dissipated=None if lost is None else sum(lost.values()),
        branch_dissipation=at["volume_dissipation"],
        work_less_stored=at["volume_dissipation"] + at["balance_residual"],
        zone_excess=at["volume_dissipation"] - at["dissipated_energy"],
        loss=at["dissipated_energy"],
    )
