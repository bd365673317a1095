"""``crosscontact compare``: several solvers on the given scenes, one table with error estimates."""

from __future__ import annotations

import argparse

from crosscontact import arguments
from crosscontact.commands import shared
from validation.compare import page
from validation.compare.scene_page import verdicts
from validation.compare.suite import all_pairs, compare_scenes
from validation.report import terminal
from validation.runs.folder import claim, output_folder, scene_question
from validation.runs.pool import processes
from validation.runs.progress import Progress
from validation.runs.store import Store
from validation.solvers import SOLVERS


def _solvers(text: str) -> tuple[str, ...]:
    try:
        return arguments.chosen(shared.comma_separated(text), "")
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def add_arguments(command: argparse.ArgumentParser) -> None:
    """Scenes and solvers."""
    shared.scene_argument(command, many=True)
    command.add_argument(
        "--solvers",
        type=_solvers,
        metavar="A,B",
        help="these only, the reference among them; default: all",
    )
    command.add_argument("--out", metavar="DIR", help="write the report and every run there")
    shared.run_options(command, max_steps=True)


def run(options: argparse.Namespace, jobs: int) -> int:
    """Compare and print; 2 if all solvers refuse a scene, else 1 if solvers disagree."""
    solvers, max_steps = options.solvers, options.max_steps
    if not solvers:
        arguments.usable()  # names those that cannot be loaded
    loaded = shared.load_taken(
        options.scenes, lambda case: [SOLVERS[name] for _, name in all_pairs([case], solvers)]
    )
    folder = None if options.out is None else output_folder(options.out)
    if folder is not None:
        scenes = scene_question(*((case.name, case.scene) for case in loaded))
        claim(folder, "a report", scenes, fresh=options.fresh)
    pairs = all_pairs(loaded, solvers)
    store = Store(folder, options.fresh)
    with shared.telling_what_is_kept(folder, store), processes(min(jobs, len(pairs))) as executor:
        progress = Progress("compare")
        progress.phase("runs")
        result = compare_scenes(
            "compare", loaded, executor, progress, store=store, solvers=solvers, max_steps=max_steps
        )
        refused = [scene for scene in result.scenes if all(run.refused for run in scene.runs.values())]
        for scene in refused:
            shared.say(f"error: {scene.case.name}: {next(iter(scene.runs.values())).failure}")
        if len(refused) == len(result.scenes):
            return 2
        for scene in result.scenes:
            print(terminal.text(verdicts(scene)))
        if folder is not None:
            with Progress("compare") as writing:
                writing.phase("drawing and writing")
                page.write(result, folder, executor, writing)
            store.clear()
            print(f"written to {folder / 'index.html'}")
    code = shared.exit_code(result.failures)
    return 2 if refused else code
