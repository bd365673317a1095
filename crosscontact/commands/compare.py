"""``crosscontact compare``: several solvers on the given scenes, one table with error estimates."""

from __future__ import annotations

import argparse

from crosscontact import arguments
from crosscontact.commands import shared
from crosscontact.commands.shared import value
from validation.compare import page
from validation.compare.scene_page import verdicts
from validation.compare.suite import all_pairs, compare_scenes
from validation.report.texts import for_terminal
from validation.runs.pool import processes
from validation.solvers import SOLVERS

_solvers = shared.comma_separated(lambda names: arguments.chosen(names, ""))
OPTIONS = {
    **shared.SCENES,
    "--solvers": value("A,B", "these only, the reference among them; default: all", type=_solvers),
    "--out": value("DIR", "write the report and every run there"),
    **shared.MAX_STEPS,
    **shared.jobs(),
    **shared.FRESH,
}


def run(options: argparse.Namespace, jobs: int) -> int:
    """Compare and print; 2 if all solvers refuse a scene, else 1 if solvers disagree."""
    solvers = options.solvers
    if not solvers:
        arguments.usable()  # names those that cannot be loaded
    loaded = shared.load_taken(
        options.scenes, lambda case: [SOLVERS[name] for _, name in all_pairs([case], solvers)]
    )
    count = len(all_pairs(loaded, solvers))
    with (
        shared.long_work("compare", options, "a report", loaded) as work,
        processes(min(jobs, count)) as executor,
    ):
        settings = {"store": work.store, "solvers": solvers, "max_steps": options.max_steps}
        result = compare_scenes("compare", loaded, executor, work.runs(), **settings)
        refused = [scene for scene in result.scenes if all(run.refused for run in scene.runs.values())]
        for scene in refused:
            shared.say(f"error: {scene.case.name}: {next(iter(scene.runs.values())).failure}")
        if len(refused) == len(result.scenes):
            return 2
        for scene in result.scenes:
            print(for_terminal(verdicts(scene)))
        work.write(lambda folder, writing: page.write(result, folder, executor, writing))
    code = shared.exit_code(result.failures)
    return 2 if refused else code
