"""Stand-ins for the schemes of a study: springs whose stiffness converges with a known order."""

from __future__ import annotations

import dataclasses

from support.spring_solver import spring

from contact_scene import Counters

ORDERS = {"bem": 2.0, "paper-scheme": 1.0, "fem": 2.0, "reference": 4.0}


def converging(order: float, resolution_counts: bool = True):
    """A spring whose stiffness converges to 1 with the resolution, and whose work grows with it."""

    def solve(scene, resolution, **options):
        n = resolution if resolution_counts else 1
        trace = spring(1.0 + n**-order)(scene)
        return dataclasses.replace(trace, counters=Counters(steps=n, linear_solves=n * n))

    return solve
