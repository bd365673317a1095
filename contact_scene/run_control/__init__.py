"""How a run is controlled, alike for all solvers: where in its loading it is, how it is watched, how it ends.

No numerical method: which step to take, and what a step does, is the solver's own.
"""
