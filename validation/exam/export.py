"""Writing an exam: a folder for each scene, with or without the reference's answer."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from contact_scene import Trace, write_scene
from validation.cases import Case, load
from validation.exam.answer import Header
from validation.exam.answer_folder import EXAM
from validation.exam.judge import reference_resolution
from validation.exam.scene_json import expanded
from validation.exam.statement import COLUMNS, HOW_TO_ANSWER, page
from validation.exam.tags import tags
from validation.runs import provenance
from validation.runs.files import to_json, write_whole
from validation.runs.run import Run
from validation.scenes import names
from validation.scenes import suite as of_suite
from validation.solvers import REFERENCE, SOLVERS

FORMAT = 1
ALWAYS = ("adhesionless-force", "elastic-press")
"""Scenes that are in every exam, for codes that answer nothing else."""
README = f"""\
# The exam

{HOW_TO_ANSWER}

What a code does not do it declines by tag, in a file `code.toml` beside its answers:

```toml
code = "my code"
declines = ["adhesive", "oscillation"]
```

Scenes and their tags:

"""


def exam_cases(suite: str) -> list[Case]:
    """Scenes of a suite that the reference has an answer to, and those of every exam."""
    chosen = {*of_suite(suite), *ALWAYS}
    cases = [replace(load(name), profile_times=()) for name in names() if name in chosen]
    return [case for case in cases if REFERENCE not in case.refused_by]


def export_scenes(folder: Path, cases: Sequence[Case]) -> None:
    """Write ``exam.json``, ``README.md`` and, for each scene, ``scene.toml``, ``scene.json``, ``page.md``."""
    for case in cases:
        (folder / case.name).mkdir(parents=True, exist_ok=True)
        write_scene(case.scene, folder / case.name / "scene.toml")
        data = {"name": case.name, "tags": tags(case.scene)} | expanded(case.scene)
        write_whole(folder / case.name / "scene.json", to_json(data | {"columns": COLUMNS}))
        write_whole(folder / case.name / "page.md", page(case))
    scenes = "\n".join(f"- `{case.name}`: {', '.join(tags(case.scene))}" for case in cases)
    write_whole(folder / "README.md", f"{README}{scenes}\n")
    listed = [{"name": case.name, "tags": tags(case.scene), "title": case.scene.title} for case in cases]
    write_whole(folder / EXAM, to_json({"format": FORMAT, "program": provenance.version(), "scenes": listed}))


def export_reference(folder: Path, cases: Sequence[Case], runs: Mapping[str, Run]) -> None:
    """Write ``reference.csv`` and ``reference.json`` into the folder of every scene that has a trace."""
    for case in cases:
        run = runs[case.name]
        if run.curves is None:
            continue
        header = header_of(case, run, reference_resolution(case.scene))
        write_whole(folder / case.name / "reference.csv", trace_text(header, run.curves))
        data = {
            "outcome": run.outcome,
            "ends_at": run.curves.outcome.time,
            "measures": {k: v for k, v in run.measures.items() if not k.startswith("counters.")},
            "relative_errors": run.errors,
        }
        write_whole(folder / case.name / "reference.json", to_json(data))


def header_of(case: Case, run: Run, resolution: int | None) -> Header:
    """Header of a run of one of the registered solvers, from which alone it can be computed again."""
    version = SOLVERS.origin(run.solver)
    return Header(
        run.solver,
        version=version or provenance.program_version(),
        author="" if version else "crosscontact",
        resolution="" if resolution is None else str(resolution),
        seconds=max(run.wall_seconds, 1e-6),
        scene=case.name,
        transition=SOLVERS[run.solver].transition(resolution),
        outcome=run.outcome if run.outcome in ("completed", "detached") else "",
        problem=expanded(case.scene),
    )


def trace_text(header: Header, trace: Trace) -> str:
    """The contents of a ``trace.csv`` with its header, numbers with all their digits."""
    columns = {name: getattr(trace, name) for name in SOLVERS[header.code].columns}
    rows = zip(*(column.tolist() for column in columns.values()), strict=True)
    lines = [*header.lines(), ",".join(columns), *(",".join(map(repr, row)) for row in rows)]
    return "\n".join(lines) + "\n"
