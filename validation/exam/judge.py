"""The judgement of a folder of answers: a verdict for every code on every scene."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from enum import StrEnum

from contact_scene import Scene
from validation.cases import Case
from validation.exam.answer_folder import AnswerFolder
from validation.exam.grading import COARSEST, Grade, grade
from validation.exam.griffith_limit import GriffithTrack, tracks
from validation.measure.check import Check
from validation.runs.pool import TellProgress, run_tasks
from validation.runs.run import Run
from validation.runs.solver_tasks import run_of, run_task
from validation.runs.store import Store
from validation.solvers import REFERENCE, SOLVERS

FINER = 2
"""Resolution of the reference that answers are graded against, over its default."""


class VerdictKind(StrEnum):
    """What can be said of a code on a scene."""

    PASSED = "passed"
    FAILED = "failed"
    CONVERGES = "at the Griffith limit"
    DECLINED = "declined"
    NO_ANSWER = "no answer"


@dataclass(frozen=True)
class CodeOnScene:
    """A code on a scene: its graded answers, the best one last, or why it declines; and the verdict.

    ``track`` is that of a code with a finite range of attraction.
    """

    code: str
    scene: str
    answers: tuple[Grade, ...] = ()
    declined: str | None = None
    track: GriffithTrack | None = None

    @property
    def best(self) -> Grade | None:
        """The most accurate answer."""
        return self.answers[-1] if self.answers else None

    @property
    def kind(self) -> VerdictKind:
        """The verdict."""
        if self.best is None:
            return VerdictKind.NO_ANSWER if self.declined is None else VerdictKind.DECLINED
        if self.best.passed:
            return VerdictKind.PASSED
        converges = self.track is not None and self.track.converges
        return VerdictKind.CONVERGES if converges else VerdictKind.FAILED

    @property
    def verdict(self) -> str:
        """The verdict in words."""
        if self.best is not None and self.best.passed:
            return f"passed at 1e-{self.best.decade}"
        if self.kind is VerdictKind.CONVERGES and self.track is not None and self.track.points:
            return "converges to the Griffith limit"
        by_tag = self.kind is VerdictKind.DECLINED and self.reason.startswith("by tag")
        return f"declined {self.reason}" if by_tag else str(self.kind)

    @property
    def reason(self) -> str:
        """Why it failed, declined, or is at the Griffith limit."""
        if self.best is None or self.best.passed:
            return self.declined or "" if self.best is None else ""
        track = [] if self.track is None else [self.track.in_words]
        return "; ".join([*(self.best.faults if self.kind is VerdictKind.FAILED else []), *track])

    @property
    def passed(self) -> bool | None:
        """``None`` where there is nothing to judge."""
        return None if self.best is None else self.kind is not VerdictKind.FAILED


@dataclass(frozen=True)
class SceneJudgement:
    """All codes on one scene, and the run of the reference they are graded against, if any answers."""

    case: Case
    reference: Run | None
    verdicts: tuple[CodeOnScene, ...]


@dataclass(frozen=True)
class Judgement:
    """All scenes; ``remarks`` are lines on files that could not be used."""

    scenes: tuple[SceneJudgement, ...]
    codes: tuple[str, ...]
    remarks: tuple[str, ...]

    @property
    def checks(self) -> list[Check]:
        """A check for every verdict on answers."""
        least = f"passed at 1e-{COARSEST} or better"
        return [
            Check(one.scene, one.code, "verdict", "exam", least, one.verdict, one.passed, note=one.reason)
            for scene in self.scenes
            for one in scene.verdicts
            if one.passed is not None
        ]


def judge_folder(
    folder: AnswerFolder,
    executor: Executor | None = None,
    store: Store | None = None,
    progress: TellProgress | None = None,
) -> Judgement:
    """Judge everything in a folder; the reference is run as of ``run_tasks``."""
    answered = {one.header.scene for one in folder.answers}
    needed = [case for case in folder.cases if case.name in answered]
    runs = reference_runs(needed, executor, store, progress)
    remarks = list(folder.remarks)
    scenes = []
    for case in folder.cases:
        base = runs.get(case.name)
        if base is not None and base.curves is None:
            remarks.append(f"{case.name}: not judged: the reference has no answer: {base.ending}")
            continue
        verdicts = tuple(_verdict(folder, code, case, base) for code in folder.codes)
        scenes.append(SceneJudgement(case, base, verdicts))
    remarks += [remark for one in folder.answers for remark in one.remarks]
    return Judgement(tuple(scenes), folder.codes, tuple(remarks))


def reference_runs(
    cases: Sequence[Case],
    executor: Executor | None = None,
    store: Store | None = None,
    progress: TellProgress | None = None,
) -> dict[str, Run]:
    """Runs of the reference at ``FINER`` times its default resolution, with error estimates, by scene."""
    tasks = [run_task(case, REFERENCE, reference_resolution(case.scene), estimate=True) for case in cases]
    return {one.scene: one for one in map(run_of, run_tasks(tasks, executor, store, progress))}


def reference_resolution(scene: Scene) -> int:
    """Resolution of the reference for answers to a scene."""
    return FINER * SOLVERS[REFERENCE].default_resolution(scene)


def _verdict(folder: AnswerFolder, code: str, case: Case, base: Run | None) -> CodeOnScene:
    graded = [
        Grade(one) if one.problem or base is None else grade(one, case.scene, base)
        for one in folder.answers
        if one.header.code == code and one.header.scene == case.name
    ]
    graded.sort(key=lambda one: (one.decade, -one.counted))
    declined = None if graded else folder.declined.get((code, case.name))
    track = tracks([one.answer for one in graded], case)
    return CodeOnScene(code, case.name, tuple(graded), declined, track)
