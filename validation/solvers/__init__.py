"""The solvers by name, one object each, loaded where it is looked up."""

from validation.solvers.base import REFERENCE, Progress, RunOptions, Solver
from validation.solvers.model_range import out_of_range, scene_warnings, trace_warnings
from validation.solvers.peers import PEERS
from validation.solvers.registry import SOLVERS, register, solver, solvers, unregister

__all__ = [
    "PEERS",
    "REFERENCE",
    "SOLVERS",
    "Progress",
    "RunOptions",
    "Solver",
    "out_of_range",
    "register",
    "scene_warnings",
    "solver",
    "solvers",
    "trace_warnings",
    "unregister",
]
