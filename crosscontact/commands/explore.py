"""``crosscontact explore``: a page with sliders for keys of a scene."""

from __future__ import annotations

import argparse

from contact_scene.files import as_target
from contact_scene.value_checks import whole_from
from crosscontact.arguments import option_type
from crosscontact.commands import shared
from crosscontact.commands.shared import say, value
from crosscontact.sweeps import explore
from validation.runs.folder import in_words
from validation.runs.progress import Progress
from validation.sweeps.batch_runs import BATCH

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
    **shared.solver("default: batch if all are retractions that it takes, else the reference", BATCH),
    **shared.resolution(
        "as of solve, by the reference; default: 4, enough for curves to look at, of batch 16"
    ),
    **shared.jobs(),
}


def run(options: argparse.Namespace, jobs: int) -> int:
    """Solve the grid and write the page; a run that does not come to its end is shown as that."""
    page = as_target(options.page)
    with Progress(f"explore {options.scene}", "runs") as progress:
        found = explore(
            options.scene,
            options.vary,
            values=options.values,
            solver=options.solver,
            resolution=options.resolution,
            jobs=jobs,
            progress=lambda share, text: progress(share, detail=text),
        )
    found.save(page)
    if found.unfinished:
        say(f"{found.unfinished} of {len(found.runs)} runs did not reach their end; the page says why")
    print(f"{len(found.runs)} runs of {found.plan.scene.name} by {found.plan.solver}")
    print(f"written to {page} ({in_words(page.stat().st_size)})")
    return 0
