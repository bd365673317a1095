"""``crosscontact explore``: a page with sliders for keys of a scene."""

from __future__ import annotations

import argparse
from pathlib import Path

from contact_scene.files import as_target
from contact_scene.value_checks import whole_from
from crosscontact import arguments
from crosscontact.arguments import option_type
from crosscontact.commands import shared
from crosscontact.commands.shared import say, value
from validation.runs.folder import in_words
from validation.runs.pool import own_engine
from validation.runs.progress import Progress
from validation.sweeps.explorer import check_drawable, explored, sliders_of
from validation.sweeps.plan import builtin_or_file

OPTIONS = {
    **shared.SCENE,
    "--vary": value(
        "PATH[=LOW:HIGH]",
        "up to three numbers of the scene, as adhesion.work or loading.steps[1].rate=1e-6:1e-4; without "
        "bounds a factor of ten either way",
        nargs="+",
        required=True,
    ),
    "--out": value("FILE", "the page, FILE.html", dest="page", required=True),
    "--values": value(
        "N", "of each key; default: 31 of one, 11 of two, 7 of three", type=option_type(whole_from(2))
    ),
    **shared.solver("default: the reference"),
    **shared.resolution("as of solve; default: 4, enough for curves to look at"),
    **shared.jobs(),
}


def run(options: argparse.Namespace, jobs: int) -> int:
    """Solve the grid and write the page; a run that does not come to its end is shown as that."""
    check_drawable()
    page = as_target(options.page)
    table = builtin_or_file(options.scene, Path())
    sliders = sliders_of(table, options.vary, options.values)
    solver = options.solver or arguments.REFERENCE
    with Progress(f"explore {table.name}") as progress, own_engine(jobs) as engine:
        progress.phase("runs")
        found = explored(
            table,
            sliders,
            solver,
            options.resolution or arguments.COARSE,
            engine,
            lambda share, text: progress(share, detail=text),
        )
    found.save(page)
    if found.unfinished:
        say(f"{found.unfinished} of {len(found.runs)} runs did not reach their end; the page says why")
    print(f"{len(found.runs)} runs of {table.name} by {solver}")
    print(f"written to {page} ({in_words(page.stat().st_size)})")
    return 0
