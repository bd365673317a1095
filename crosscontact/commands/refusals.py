"""Scenes that solvers refuse, told before anything is run."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from contact_scene import Scene, SceneError
from validation import cases
from validation.cases import Case
from validation.solvers import Solver


def refusals(scene: Scene, methods: Iterable[Solver], resolution: int | None = None) -> dict[str, SceneError]:
    """Why solvers do not take a scene, by their names; those that take it are left out."""
    found = {}
    for method in methods:
        try:
            method.check(scene, resolution)
        except SceneError as error:
            found[method.name] = error
    return found


def load_taken(names: Iterable[str], methods: Callable[[Case], Iterable[Solver]]) -> list[Case]:
    """Load scenes, each of which one of the solvers that are to run it has to take.

    Parameters
    ----------
    names : iterable of str
        Scene files or names of built-in scenes; one named twice counts once.
    methods : callable
        The solvers for a case.

    Returns
    -------
    list of Case

    Raises
    ------
    SceneError
        If a scene cannot be read, or no solver takes it.
    """
    sources = tuple(dict.fromkeys(names))
    loaded = cases.load_all(sources)
    for source, case in zip(sources, loaded, strict=True):
        check_taken(source, case.scene, methods(case))
    return loaded


def check_taken(source: str, scene: Scene, methods: Iterable[Solver], resolution: int | None = None) -> None:
    """Refuse a scene that none of the solvers takes.

    Parameters
    ----------
    source : str
        File or name of the scene, as it was given.
    scene : Scene
    methods : iterable of Solver
    resolution : int or None
        Divisions per process zone; ``None``: the solvers' choice.

    Raises
    ------
    SceneError
        One line with the reason of every solver, once where they agree.
    """
    asked = tuple(methods)
    found = refusals(scene, asked, resolution)
    if len(found) < len(asked) or not found:
        return
    reasons = {str(error): error for error in found.values()}
    if len(reasons) == 1:
        raise next(iter(found.values())).in_file(source)
    problem = ", ".join(f"{name}: {error.key}: {error.problem}" for name, error in found.items())
    raise SceneError("", f"no solver takes it: {problem}", "a scene that one of them takes", source)
