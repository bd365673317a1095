"""The runs of random scenes: a stream through processes that stay, three runs a scene, a fourth where needed.

Half of what a run with an error estimate costs is the second run that the estimate is made from. It decides
nothing where an answer is within the tolerance that its solver keeps at a coarse resolution. So ``screened``
answers are first had without estimates, and asked again where they are farther off.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field, replace

from validation.execution.solver_tasks import run_task
from validation.execution.task_execution import completed_tasks
from validation.execution.tasks import Task, TaskEnding, TaskResult
from validation.solvers import REFERENCE, SOLVERS, solver
from validation.stability.random_answers import AnswerFinding, JudgedScene, examine
from validation.stability.random_compared import examine_compared
from validation.stability.random_scenes import RandomScene

PER_PROCESS = 2
"""Runs that wait or are carried out for each process, so that none is idle between two runs."""
WITH_ESTIMATE = 4.0
"""Time limit of a run with its estimate over that of the run alone: the second run may be twice as fine."""


@dataclass(frozen=True)
class RandomRunSettings:
    """How the runs of random scenes are carried out.

    Parameters
    ----------
    seconds : float
        Processor time (s) after which a run is given up.
    resolution : int or None
        Divisions per process zone; ``None``: each solver's own.
    coarse : bool
        The coarse resolution of each solver instead (``Solver.coarse_resolution``).
    screened : bool
        Estimates only for answers that differ by more than the solver's tolerance at that resolution.
    solvers : sequence of str
        Those asked, the reference among them.
    compared : bool
        Answers are judged by the checks of ``crosscontact compare`` as well.
    """

    seconds: float = 60.0
    resolution: int | None = None
    coarse: bool = False
    screened: bool = False
    solvers: Sequence[str] = field(default_factory=lambda: list(SOLVERS))
    compared: bool = False

    def resolution_of(self, name: str, chosen: RandomScene) -> int | None:
        """Divisions per process zone of a solver in a scene; ``None``: its own."""
        return solver(name).coarse_resolution(chosen.scene.is_adhesive) if self.coarse else self.resolution


class _RunStream(Iterator[tuple[int, Task]]):
    """Numbered runs: first what was asked for anew, then those of the next scene.

    It may be asked again after it had nothing left: a result may have called for another run.
    """

    def __init__(self, scenes: Iterable[RandomScene], settings: RandomRunSettings) -> None:
        self._scenes = iter(scenes)
        self._settings = settings
        self._waiting: deque[tuple[int, Task]] = deque()
        self._count = 0
        self.asked: dict[int, tuple[RandomScene, str]] = {}

    def __next__(self) -> tuple[int, Task]:
        if not self._waiting:
            chosen = next(self._scenes)
            for name in self._settings.solvers:
                self.ask(chosen, name, not self._settings.screened or name == REFERENCE)
        return self._waiting.popleft()

    def ask(self, chosen: RandomScene, name: str, estimate: bool, times: float = 1.0) -> None:
        """Have a scene run by a solver.

        Parameters
        ----------
        chosen : RandomScene
        name : str
            Of the solver.
        estimate : bool
            Whether its errors are estimated.
        times : float
            Time limit of the run, over the usual one.
        """
        task = run_task(chosen.case, name, self._settings.resolution_of(name, chosen), estimate=estimate)
        self.asked[self._count] = chosen, name
        self._waiting.append((self._count, replace(task, time_limit=times * self._settings.seconds)))
        self._count += 1


def judged_scenes(
    scenes: Iterable[RandomScene], settings: RandomRunSettings, executor: Executor | None, jobs: int = 1
) -> Iterator[tuple[RandomScene, JudgedScene]]:
    """Scenes as they are done, which need not be their order.

    Parameters
    ----------
    scenes : iterable of RandomScene
        May be a generator; scenes are taken from it as processes become free.
    settings : RandomRunSettings
    executor : Executor or None
        As of :func:`~validation.execution.task_execution.completed_tasks`.
    jobs : int
        Its processes.

    Yields
    ------
    (RandomScene, JudgedScene)
    """
    stream = _RunStream(scenes, settings)
    judge = examine_compared if settings.compared else examine
    results: dict[int, dict[str, TaskResult]] = {}
    first: dict[int, JudgedScene] = {}
    for number, result in completed_tasks(stream, executor, PER_PROCESS * jobs):
        chosen, name = stream.asked.pop(number)
        collected = results.setdefault(chosen.seed, {})
        if chosen.seed not in first or result.ending is TaskEnding.ANSWERED:
            collected[name] = result
        else:  # the run with its estimate ended otherwise: the run before it stands
            collected[name] = collected.pop(f"{name} alone")
        if not all(each in collected for each in settings.solvers):
            continue
        judged = judge(chosen, {each: collected[each] for each in settings.solvers})
        again = _undecided(judged) if settings.screened and chosen.seed not in first else []
        if again:
            first[chosen.seed] = judged
            for each in again:
                collected[f"{each} alone"] = collected.pop(each)
                stream.ask(chosen, each, estimate=True, times=WITH_ESTIMATE)
            continue
        del results[chosen.seed]
        first.pop(chosen.seed, None)
        yield chosen, judged


def _undecided(judged: JudgedScene) -> Sequence[str]:
    """Solvers whose answers differ by more than they may at a coarse resolution: their estimates decide."""
    return [
        answer.solver
        for answer in judged.answers
        if answer.finding in (AnswerFinding.AGREES, AnswerFinding.WRONG)
        and answer.solver != REFERENCE
        and answer.difference > solver(answer.solver).coarse_tolerance
    ]
