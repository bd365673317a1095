"""A loss that falls: by how much, and what a run says of it.

No material gives back what it has lost. The adhesive closure over a zone of finite length does not balance
energies where an edge sets off from rest (:mod:`validation.reference.starting_edge`), nor in first order of
zone over radius. All solvers share that: ``compare`` holds their falls against each other. Without adhesion
a loss that falls is an error.
"""

from __future__ import annotations

import numpy as np

from contact_scene import Scene, Trace
from validation.measure.scaling import scale


def largest_fall(trace: Trace) -> tuple[float, int, int]:
    """Largest fall of the loss from any row to a later one, and the two rows.

    Parameters
    ----------
    trace : Trace
        With a row at least.

    Returns
    -------
    fall : float
        An energy, not negative.
    begin, end : int
    """
    loss = trace.dissipated_energy
    end = int(np.argmax(np.maximum.accumulate(loss) - loss))
    begin = int(np.argmax(loss[: end + 1]))
    return float(loss[begin] - loss[end]), begin, end


def fall_warnings(scene: Scene, trace: Trace, error: float) -> tuple[str, ...]:
    """A sentence on a loss that falls by more than its error.

    Parameters
    ----------
    scene : Scene
    trace : Trace
    error : float
        Of the fall, relative as in :mod:`validation.measure.scaling`.

    Returns
    -------
    tuple of str
        None or one.
    """
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
