"""Changes between two reports: results, endings, verdicts and work.

Every number of a run is compared with that of an earlier ``report.json``. It *moved* if it differs by more
than round-off, and it moved *beyond tolerance* if

- an observable differs by more than the tolerance for that scene, solver and observable, relative to what its
  check is relative to (see :mod:`validation.measure.scaling`), or can no longer be given;
- a work counter grew by more than ``MORE_WORK``;
- a run ends in another way, a check that passed no longer does or is missing;
- a scene or a solver is missing from a report of the same suite.

Changes of input, tolerances or version are said first (:mod:`validation.runs.provenance`); by themselves they
move nothing. Run times are not compared: they belong to the machine. Exit code rule of ``crosscontact report
--baseline``: 1 if anything moved beyond tolerance or a check fails.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from contact_scene.errors import SceneError
from contact_scene.files import read_text
from validation.cases import Case
from validation.measure.difference import Check, of_numbers, relative
from validation.report import document as doc
from validation.report.report import Chapter
from validation.runs.folder import from_json
from validation.runs.provenance import changes
from validation.runs.run import Run

UNCHANGED = 1e-10
"""Change, relative as for checks, below which a number counts as unchanged."""
MORE_WORK = 0.1
"""Relative growth of a work counter beyond which it counts as moved beyond tolerance."""
LARGEST_REPORT = 100_000_000
"""Bytes of a file that may be an earlier report; the full suite writes a few million."""
MOST = 20
"""Moves that a summary lists, unless more are beyond tolerance."""
_NOT_COMPARED = ("wall_seconds", "cpu_seconds", "estimate_seconds")
_NAMED_BY = ("solver", "quantity", "source")
"""What tells the checks of a scene apart."""
_ALLOWED = "a report.json written by `crosscontact report`"
Data = Mapping[str, Any]


@dataclass(frozen=True)
class Move:
    """One difference between two reports: where, which number, ending or check, and whether it counts."""

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
    """All differences from the earlier report at a ``path``, those that count first.

    ``compared`` are scenes and solvers that both reports hold; ``changes`` other premises, one line each.
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
        source, within = f"baseline {self.path}", "within tolerance"
        moved = {(move.scene, move.solver) for move in self.beyond}
        return [
            Check(move.scene, move.solver, move.what, source, move.before, move.after, False)
            for move in self.beyond
        ] + [
            Check(*run, "all values", source, within, within, True)
            for run in self.compared
            if run not in moved
        ]

    @property
    def verdict(self) -> str:
        """In one sentence."""
        if not self.moves:
            return f"Nothing moved since {self.path}."
        moved = doc.counted(len(self.moves), "value")
        return f"{moved} moved since {self.path}, {len(self.beyond)} of them beyond tolerance."

    def chapter(self) -> Chapter:
        """All moves for a report; in short all that count and the largest of the rest."""
        heading: tuple[doc.Part, ...] = (
            *((doc.Bullets(self.changes),) if self.changes else ()),
            doc.Paragraph(self.verdict),
        )
        shown = self.moves[: max(len(self.beyond), MOST)]
        more = len(self.moves) - len(shown)
        rest = (doc.Paragraph(f"{more} smaller moves are in report.json."),) if more else ()
        title, moves = "Since the baseline", [asdict(move) for move in self.moves]
        return Chapter(
            "baseline",
            self.checks,
            (doc.Section(title, (*heading, *_listed(self.moves))),),
            (doc.Section(title, (*heading, *_listed(shown), *rest)),),
            {"baseline": {"path": self.path, "changes": list(self.changes), "moves": moves}},
        )


def read(path: str) -> dict[str, Any]:
    """An earlier ``report.json``; a SceneError if it is none."""
    try:
        data = from_json(read_text(Path(path), LARGEST_REPORT))
    except SceneError as error:
        raise SceneError("--baseline", f"{path} {error.problem}", _ALLOWED) from None
    except ValueError as error:
        raise SceneError("--baseline", f"{path} cannot be read: {error}", _ALLOWED) from None
    try:
        whole = all(
            isinstance(scene["name"], str)
            and all(isinstance(run, dict) for run in scene["runs"].values())
            and all(isinstance(check["passed"], bool) for check in scene["checks"])
            for scene in data["scenes"]
        )
    except (TypeError, KeyError, AttributeError):
        whole = False
    if not whole:
        raise SceneError("--baseline", f"{path} is no report", _ALLOWED)
    return data


def compare(path: str, old: Data, new: Data, cases: list[Case]) -> ReportComparison:
    """Differences of a report from an earlier one at a path, both as in ``report.json``.

    ``cases`` are all scenes of the new one.
    """
    by_name = {case.name: case for case in cases}
    before = {scene["name"]: scene for scene in old["scenes"]}
    after = {scene["name"]: scene for scene in new["scenes"]}
    same_suite = old.get("suite") == new.get("suite")
    moves = [Move(name, "", "scene", "there", None) for name in before if same_suite and name not in after]
    compared = []
    for name, scene in after.items():
        if name not in before:
            moves.append(Move(name, "", "scene", None, "new", beyond=False))
            continue
        runs, earlier = scene["runs"], before[name]["runs"]
        for solver in {**earlier, **runs}:
            if solver in runs and solver in earlier:
                compared.append((name, solver))
                moves += _run(by_name[name], solver, earlier[solver], runs[solver])
            else:
                gone = solver in earlier
                words = ("there", None) if gone else (None, "new")
                moves.append(Move(name, solver, "run", words[0], words[1], beyond=gone))
        moves += _verdicts(name, before[name]["checks"], scene["checks"])
    ordered = sorted(moves, key=lambda m: (not m.beyond, -math.inf if m.change is None else -abs(m.change)))
    return ReportComparison(path, tuple(ordered), tuple(compared), changes(old, new))


def _run(case: Case, solver: str, old: Data, new: Data) -> Iterator[Move]:
    if old.get("outcome") != new.get("outcome"):
        yield Move(case.name, solver, "outcome", old.get("outcome"), new.get("outcome"))
    before, after = _numbers(old), _numbers(new)
    run, base = (Run(case.name, solver, measures=numbers) for numbers in (after, before))
    for one in of_numbers(run, base, dict.fromkeys((*before, *after))):
        name = one.quantity
        first, second, tolerance = before.get(name), after.get(name), case.tolerance(solver, name)
        if one.missing:
            yield Move(case.name, solver, name, first, second, None, tolerance, beyond=second is None)
        elif first != second and abs(one.error) > UNCHANGED:
            beyond = tolerance is not None and abs(one.error) > tolerance
            yield Move(case.name, solver, name, first, second, one.error, tolerance, beyond)
    counts, now = old.get("counters") or {}, new.get("counters") or {}
    for name in {**counts, **now}:
        first, second = counts.get(name, 0), now.get(name, 0)
        more = relative(second - first, first)
        if more:
            what = f"counters.{name}"
            yield Move(case.name, solver, what, first, second, more, MORE_WORK, beyond=more > MORE_WORK)


def _numbers(run: Data) -> dict[str, float | None]:
    """What is compared of a run in a report, by name."""
    return {
        name: value
        for name, value in run.items()
        if isinstance(value, (int, float)) and not isinstance(value, bool) and name not in _NOT_COMPARED
    }


def _verdicts(scene: str, old: list[Data], new: list[Data]) -> Iterator[Move]:
    words = {True: "passed", False: "failed", None: None}
    before, after = (
        {tuple(str(c.get(key)) for key in _NAMED_BY): bool(c["passed"]) for c in checks}
        for checks in (old, new)
    )
    for key in {**before, **after}:
        first, second = before.get(key), after.get(key)
        if first != second:
            what = f"check of {key[1]} ({key[2]})"
            yield Move(scene, key[0], what, words[first], words[second], beyond=second is not True)


def _listed(moves: tuple[Move, ...]) -> tuple[doc.DataTable, ...]:
    rows: Iterator[doc.Record] = (
        {
            "scene": move.scene,
            "solver": move.solver or doc.ABSENT,
            "what": doc.plain(move.what),
            "before": doc.number(move.before, 8),
            "after": doc.number(move.after, 8),
            "change": doc.formatted(move.change, "+.1e"),
            "tolerance": doc.formatted(move.tolerance, ".0e"),
            "beyond": doc.VerdictCell("BEYOND" if move.beyond else "no", not move.beyond),
        }
        for move in moves
    )
    return (doc.DataTable.of(rows),) if moves else ()
