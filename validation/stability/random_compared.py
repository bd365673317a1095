"""Random scenes as a user sees them: every check of ``crosscontact compare`` on the answers passes.

A check of the comparison that fails is a finding of its own, unless the answer has a worse one, or there is
nothing to compare. Both kinds of judgement are needed: the comparison holds more quantities to closer
limits, and knows neither invariants nor curves relative to their excursion over the whole run.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from validation.compare.against_reference import check_case
from validation.execution.solver_tasks import run_of
from validation.execution.tasks import TaskResult
from validation.measure.check import Check
from validation.stability.random_answers import AnswerFinding, JudgedScene, RandomSceneAnswer, examine
from validation.stability.random_scenes import RandomScene

OTHERWISE_WELL = (AnswerFinding.AGREES, AnswerFinding.LOOSE, AnswerFinding.DECLINED)
"""What is said of an answer that may still fail a check."""


def examine_compared(chosen: RandomScene, runs: Mapping[str, TaskResult]) -> JudgedScene:
    """Judge the runs of one scene as :func:`examine`, and by the checks of the comparison.

    Parameters
    ----------
    chosen : RandomScene
    runs : mapping of str to TaskResult
        By solver, that of the reference among them.

    Returns
    -------
    JudgedScene
    """
    judged = examine(chosen, runs)
    answers = {name: run_of(result) for name, result in runs.items()}
    if all(run.refused for run in answers.values()):
        return judged  # the comparison says so instead of checking
    failed = [check for check in check_case(chosen.case, answers) if not check.passed]
    return replace(
        judged,
        answers=tuple(
            _with_failed(answer, [check for check in failed if check.solver == answer.solver])
            for answer in judged.answers
        ),
    )


def _with_failed(answer: RandomSceneAnswer, failed: Sequence[Check]) -> RandomSceneAnswer:
    """The answer with the checks that it fails, if any, in its note."""
    if not failed:
        return answer
    words = [f"{check.quantity}: {check.note or f'{check.found}, not {check.expected}'}" for check in failed]
    note = "; ".join(filter(None, (answer.note, *words)))
    if answer.finding not in OTHERWISE_WELL:
        return replace(answer, note=note)
    worst = max(failed, key=lambda check: abs(check.difference or 0.0))
    return replace(
        answer,
        finding=AnswerFinding.FAILED,
        quantity=worst.quantity,
        difference=abs(worst.difference or 0.0),
        allowed=worst.limit or 0.0,
        note=note,
    )
