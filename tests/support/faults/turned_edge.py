"""Single faults in what an edge leaves where it turns, by boundary elements.

No check of a scene sees them: the step control answers to a forgotten kink with up to a quarter more steps,
and no observable of the quick suite moves by more than 1.1e-3, within what it may. What sees them is the heat
of the branches where an edge meets its place of turning again: :mod:`bem.test_bem_turned_edge`.
"""

from __future__ import annotations

from support.faults.injection import registry

FAULTS, fault = registry("bem", "bem_solver")


@fault("no kink where the edge turned", "history:updated_kinks")
def _(true):
    return lambda *given: ((), *true(*given)[1:])


@fault("square root at the edge left out of the outer history", "surface:ContactSurface.root_strength")
def _(true):
    return lambda self, reach: 0.0
