"""What a scene did not need and a solver therefore left out, told by counters of work that stayed at zero."""

from __future__ import annotations

from collections.abc import Mapping

LEFT_OUT = {  # counter: what its staying at zero means, and for which schemes (empty: all)
    "closure_evaluations": ("no closure was evaluated", ()),
    "history_updates": ("no history was carried", ()),
    "volume_solves": ("no solution in the volume within the time loop", ("fem",)),
}


def left_out(scheme: str, counters: Mapping[str, float | None]) -> list[str]:
    """The parts of its work that a scheme left out, in words; none if a counter is not known."""
    return [
        text
        for name, (text, schemes) in LEFT_OUT.items()
        if counters.get(name) == 0 and (not schemes or scheme in schemes)
    ]


def in_words(work: Mapping[str, Mapping[str, float | None]]) -> str:
    """A sentence on all solvers of a scene, ``work`` being their counters by name."""
    said = [f"{solver}: {', '.join(parts)}" for solver, c in work.items() if (parts := left_out(solver, c))]
    if not said:
        return "Nothing was left out: by its counters every solver did all kinds of its work."
    return f"Left out because the scene did not need it, by the counters: {'; '.join(said)}."
