"""The exam from Python: scenes for other codes to answer, and the judgement of their answers."""

from __future__ import annotations

import os

from contact_scene.value_checks import one_of, true_or_false
from crosscontact.arguments import checked_path
from validation.exam.answer import read_folder
from validation.exam.judge import Judgement, judge_folder, write
from validation.exam.own_answers import export_reference
from validation.exam.question import exam_cases, export_scenes
from validation.runs.folder import claim, output_folder
from validation.runs.store import Store
from validation.scenes import SUITES


def export_exam(
    folder: str | os.PathLike[str], suite: str = "quick", *, with_reference: bool = False
) -> tuple[str, ...]:
    """Write an exam: a folder for each scene, as ``crosscontact exam export`` does.

    Parameters
    ----------
    folder : path
        Is made if it is not there.
    suite : str
        "quick", "paper" or "full".
    with_reference : bool
        Whether the reference's traces and measures are written beside; takes seconds for each scene.

    Returns
    -------
    tuple of str
        Names of the scenes.

    Examples
    --------
    >>> "elastic-press" in cc.export_exam("exam", "quick")
    True
    """
    true_or_false(with_reference, "with_reference")
    target = output_folder(checked_path(folder), "folder")
    cases = exam_cases(one_of(suite, "suite", SUITES))
    claim(target, "an exam", {}, "folder")
    export_scenes(target, cases)
    if with_reference:
        export_reference(target, cases)
    return tuple(case.name for case in cases)


def judge(folder: str | os.PathLike[str], out: str | os.PathLike[str] | None = None) -> Judgement:
    """Judge the answers in a folder, as ``crosscontact judge`` does.

    Parameters
    ----------
    folder : path
        Holds answers: ``SCENE/trace.csv`` at any depth.
    out : path, optional
        Folder of a report as page, Markdown, JSON and JUnit.

    Returns
    -------
    Judgement
        ``scenes``, each with ``verdicts``, one for every code.

    Examples
    --------
    >>> _ = cc.export_exam("exam", "quick")
    >>> _ = Path("exam/elastic-press/trace.csv").write_text("# code: none\\ntime,force\\n0,0\\n1,0\\n")
    >>> sorted({one.verdict for scene in cc.judge("exam").scenes for one in scene.verdicts})
    ['failed', 'no answer']
    """
    store = Store()
    judgement = judge_folder(read_folder(checked_path(folder)))
    if out is not None:
        write(judgement, output_folder(checked_path(out, "out"), "out"), store.seconds)
    return judgement
