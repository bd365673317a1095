"""Changes between two reports: results, endings, verdicts and work.

Every number of a run is compared with that of an earlier ``report.json``. It *moved* if it differs by more
than round-off, and it moved *beyond tolerance* if

- an observable differs by more than the tolerance for that scene, solver and observable, relative to what its
  check is relative to (see :mod:`validation.measure.scaling`), or can no longer be given;
- a work counter grew by more than ``MORE_WORK``;
- a run ends in another way, a check that passed no longer does or is missing;
- a scene or a solver is missing from a report of the same suite.

Changes of input, tolerances or version are said first (see
:mod:`validation.runs.provenance`); by themselves they move nothing.

Exit code rule of ``crosscontact report --baseline``: 1 if anything moved beyond tolerance or a check fails.
Run times are not compared: they belong to the machine.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeGuard

from contact_scene.errors import SceneError
from contact_scene.files import read_text
from validation.cases import Case
from validation.measure.difference import Check, relative
from validation.measure.scaling import Magnitudes
from validation.runs.folder import from_json
from validation.runs.provenance import changes

ROUND_OFF = 1e-10
"""Change, relative as for checks, below which a number counts as unchanged."""
MORE_WORK = 0.1
"""Relative growth of a work counter beyond which it counts as moved beyond tolerance."""
LARGEST_REPORT = 100_000_000
"""Bytes of a file that may be an earlier report; the full suite writes a few million."""
_NOT_COMPARED = ("wall_seconds", "cpu_seconds", "estimate_seconds")
"""Run times, which belong to the machine."""
_ALLOWED = "a report.json written by `crosscontact report`"
Run = Mapping[str, Any]


@dataclass(frozen=True)
class Move:
    """One difference between two reports.

    Parameters
    ----------
    scene, solver, what : str
        Where, and which number, ending or check.
    before, after : float or str or None
    change : float or None
        Relative, where both are numbers.
    tolerance : float or None
    beyond : bool
        Whether it counts.
    """

    scene: str
    solver: str
    what: str
    before: float | str | None
    after: float | str | None
    change: float | None = None
    tolerance: float | None = None
    beyond: bool = True


@dataclass(frozen=True)
class ReportComparison:
    """All differences from an earlier report.

    Parameters
    ----------
    path : str
        Of the earlier report.
    moves : tuple of Move
        Those that count first.
    compared : tuple of (str, str)
        Scenes and solvers that both reports hold.
    changes : tuple of str
        Other input, tolerances or version, one line each.
    """

    path: str
    moves: tuple[Move, ...]
    compared: tuple[tuple[str, str], ...] = ()
    changes: tuple[str, ...] = ()

    @property
    def beyond(self) -> list[Move]:
        """Differences that count."""
        return [move for move in self.moves if move.beyond]

    @property
    def checks(self) -> list[Check]:
        """A failed check for each difference that counts; a passed one for each run without."""
        source = f"baseline {self.path}"
        failed = [
            Check(move.scene, move.solver, move.what, source, move.before, move.after, False)
            for move in self.beyond
        ]
        moved = {(move.scene, move.solver) for move in self.beyond}
        passed = [
            Check(scene, solver, "all values", source, "within tolerance", "within tolerance", True)
            for scene, solver in self.compared
            if (scene, solver) not in moved
        ]
        return failed + passed

    @property
    def verdict(self) -> str:
        """In one sentence."""
        if not self.moves:
            return f"Nothing moved since {self.path}."
        return (
            f"{len(self.moves)} value{'' if len(self.moves) == 1 else 's'} moved since {self.path}, "
            f"{len(self.beyond)} of them beyond tolerance."
        )


def read(path: str) -> dict[str, Any]:
    """An earlier ``report.json``.

    Raises
    ------
    SceneError
        If it is none.
    """
    try:
        data = from_json(read_text(Path(path), LARGEST_REPORT))
    except SceneError as error:
        raise SceneError("--baseline", f"{path} {error.problem}", _ALLOWED) from None
    except ValueError as error:
        raise SceneError("--baseline", f"{path} cannot be read: {error}", _ALLOWED) from None
    scenes = data.get("scenes") if isinstance(data, dict) else None
    whole = isinstance(scenes, list) and all(
        isinstance(scene, dict)
        and isinstance(scene.get("name"), str)
        and isinstance(scene.get("runs"), dict)
        and all(isinstance(run, dict) for run in scene["runs"].values())
        and isinstance(scene.get("checks"), list)
        and all(isinstance(check, dict) and "passed" in check for check in scene["checks"])
        for scene in scenes
    )
    if not whole:
        raise SceneError("--baseline", f"{path} is no report", _ALLOWED)
    return data


def compare(path: str, old: Mapping[str, Any], new: Mapping[str, Any], cases: list[Case]) -> ReportComparison:
    """Differences of one report from an earlier one.

    Parameters
    ----------
    path : str
        Of the earlier report, for its name.
    old, new : mapping
        Earlier and present report, both as in ``report.json``.
    cases : list of Case
        All scenes of ``new``.

    Returns
    -------
    ReportComparison
    """
    by_name = {case.name: case for case in cases}
    before = {scene["name"]: scene for scene in old["scenes"]}
    after = {scene["name"]: scene for scene in new["scenes"]}
    moves: list[Move] = []
    for name, scene in after.items():
        if name not in before:
            moves.append(Move(name, "", "scene", None, "new", beyond=False))
            continue
        moves += _runs(by_name[name], before[name]["runs"], scene["runs"])
        moves += _verdicts(name, before[name]["checks"], scene["checks"])
    if old.get("suite") == new.get("suite"):
        moves += [Move(name, "", "scene", "there", None) for name in before if name not in after]
    compared = [
        (name, solver)
        for name, scene in after.items()
        if name in before
        for solver in scene["runs"]
        if solver in before[name]["runs"]
    ]
    size = {id(move): abs(move.change) if move.change is not None else math.inf for move in moves}
    ordered = sorted(moves, key=lambda move: (not move.beyond, -size[id(move)]))
    return ReportComparison(path, tuple(ordered), tuple(compared), changes(old, new))


def _runs(case: Case, before: Mapping[str, Run], after: Mapping[str, Run]) -> Iterator[Move]:
    for solver in {**before, **after}:
        if solver not in after:
            yield Move(case.name, solver, "run", "there", None)
        elif solver not in before:
            yield Move(case.name, solver, "run", None, "new", beyond=False)
        else:
            old, new = before[solver], after[solver]
            if old.get("outcome") != new.get("outcome"):
                yield Move(case.name, solver, "outcome", old.get("outcome"), new.get("outcome"))
            yield from _observables(case, solver, old, new)
            yield from _counters(case.name, solver, old, new)


def _observables(case: Case, solver: str, old: Run, new: Run) -> Iterator[Move]:
    largest = Magnitudes.of_measures(old)
    for name in {**old, **new}:
        first, second = old.get(name), new.get(name)
        if name in _NOT_COMPARED or not (_is_number(first) or _is_number(second)):
            continue
        tolerance = case.tolerance(solver, name)
        if not (_is_number(first) and _is_number(second)):
            yield Move(case.name, solver, name, first, second, None, tolerance, beyond=second is None)
            continue
        change = relative(second - first, largest.scale(name, first))
        if first != second and abs(change) > ROUND_OFF:
            beyond = tolerance is not None and abs(change) > tolerance
            yield Move(case.name, solver, name, first, second, change, tolerance, beyond)


def _counters(scene: str, solver: str, old: Run, new: Run) -> Iterator[Move]:
    first, second = old.get("counters") or {}, new.get("counters") or {}
    for name in {**first, **second}:
        before, after = first.get(name, 0), second.get(name, 0)
        if before == after:
            continue
        change = (after - before) / before if before else math.inf
        yield Move(
            scene, solver, f"counters.{name}", before, after, change, MORE_WORK, beyond=change > MORE_WORK
        )


def _verdicts(scene: str, old: list[Run], new: list[Run]) -> Iterator[Move]:
    words = {True: "passed", False: "failed", None: None}
    before = {_key(check): bool(check["passed"]) for check in old}
    after = {_key(check): bool(check["passed"]) for check in new}
    for key in {**before, **after}:
        first, second = before.get(key), after.get(key)
        if first == second:
            continue
        what = f"check of {key[1]} ({key[2]})"
        yield Move(scene, key[0], what, words[first], words[second], beyond=second is not True)


def _key(check: Run) -> tuple[str, str, str]:
    return str(check.get("solver")), str(check.get("quantity")), str(check.get("source"))


def _is_number(value: object) -> TypeGuard[float]:
    return isinstance(value, (int, float)) and not isinstance(value, bool)
