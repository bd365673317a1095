"""What random scenes have shown, as Markdown: counts, faults by class, and what became of them since.

``python -m validation.stability.random_report DIR [--again DIR ...]`` reads the folders of
:mod:`random_matrix`: that of a matrix, and those in which its faulty seeds were examined again by later code.
"""

from __future__ import annotations

import argparse
import json
from collections import Counter, defaultdict
from collections.abc import Mapping, Sequence
from pathlib import Path

from validation.solvers import SOLVERS
from validation.stability.random_answers import FAULTS, AnswerFinding, JudgedScene
from validation.stability.random_matrix import read


def counts(judged: Sequence[JudgedScene]) -> str:
    """Number of scenes by finding and solver, and the mean processor time of an answer."""
    answers = [answer for one in judged for answer in one.answers]
    number = Counter((answer.finding, answer.solver) for answer in answers)
    rows = ["| finding | " + " | ".join(SOLVERS) + " |", "|---" * (len(SOLVERS) + 1) + "|"]
    for finding in AnswerFinding:
        if any(number[finding, name] for name in SOLVERS):
            rows.append(f"| {finding} | " + " | ".join(str(number[finding, name]) for name in SOLVERS) + " |")
    means = []
    for name in SOLVERS:
        took = [answer.seconds for answer in answers if answer.solver == name and answer.seconds > 0.0]
        means.append(f"{sum(took) / len(took):.2g}" if took else "")
    return "\n".join([*rows, "| processor time of an answer (s) | " + " | ".join(means) + " |"])


def faults(judged: Sequence[JudgedScene], again: Mapping[tuple[int, str], str]) -> str:
    """The faulty answers by class, most frequent first: seed, how far off, and what later code gave."""
    classes: defaultdict[tuple[str, str, str], list[tuple[int, str]]] = defaultdict(list)
    for one in judged:
        for answer in one.answers:
            if answer.finding not in FAULTS:
                continue
            what = answer.quantity or answer.note
            size = f" {answer.difference:.2g}" if answer.quantity else ""
            later = again.get((one.seed, answer.solver), "")
            words = f"{one.seed}{size}" + (f" ({later})" if later else "")
            if answer.finding is AnswerFinding.OTHER_ENDING:
                what = f"{answer.ending}; {answer.note.partition(' at t =')[0]}"
            classes[answer.finding, answer.solver, what].append((one.seed, words))
    rows = ["| finding | solver | what | scenes | seed, how far off (examined again) |", "|---" * 5 + "|"]
    for key, found in sorted(classes.items(), key=lambda item: (-len(item[1]), item[0])):
        rows.append("| " + " | ".join([*key, str(len(found)), ", ".join(words for _, words in found)]) + " |")
    return "\n".join(rows)


def later_findings(folders: Sequence[Path]) -> dict[tuple[int, str], str]:
    """Finding by seed and solver of the last folder that holds the seed."""
    found = {}
    for folder in folders:
        for one in read(folder / "scenes.jsonl"):
            for answer in one.answers:
                size = f" {answer.difference:.2g}" if answer.finding in FAULTS and answer.quantity else ""
                found[one.seed, answer.solver] = f"{answer.finding}{size}"
    return found


def report(folder: Path, again: Sequence[Path] = ()) -> str:
    """Counts, faults and settings of a matrix."""
    judged = read(folder / "scenes.jsonl")
    settings = json.loads((folder / "settings.json").read_text("utf-8"))
    seeds = [one.seed for one in judged]
    words = ", ".join(f"{name} = {value}" for name, value in settings.items())
    head = f"{len(judged)} scenes of the seeds {min(seeds)} to {max(seeds)}, settings {words}."
    return "\n\n".join([head, counts(judged), faults(judged, later_findings(again))]) + "\n"


def main(arguments: Sequence[str] | None = None) -> int:
    """Command line."""
    parser = argparse.ArgumentParser(description="what a matrix of random scenes has shown, as Markdown")
    parser.add_argument("folder", type=Path, help="of a matrix")
    parser.add_argument("--again", type=Path, nargs="*", default=(), help="folders of later code, in order")
    chosen = parser.parse_args(arguments)
    print(report(chosen.folder, chosen.again), end="")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
