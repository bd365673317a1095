"""Single faults in what an edge leaves where it turns, by boundary elements.

No check of a scene sees them: the step control answers to a forgotten kink with up to a quarter more steps,
and no observable of the quick suite moves by more than 1.1e-3, within what it may. What sees them is the heat
of the branches where an edge meets its place of turning again: :mod:`bem.test_bem_turned_edge`.
"""

from __future__ import annotations

from support.faults.injection import gives, table, times

FAULTS = table("bem", "bem_solver", [
    ("no kink where the edge turned", "history:updated_kinks", gives(lambda found: ((), *found[1:]))),
    ("inverse root inside the old edge left out", "surface:EdgeKinks.strengths", times(0.0)),
])  # fmt: skip
