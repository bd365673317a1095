"""The command line: ``crosscontact scenes | solve | compare | study | fields | stability | report | ...``.

Dispatch; the arguments are in ``arguments``, what a command does is in ``commands``, one file each. Exit
codes: 0 all well; 1 a check failed or a run did not finish, interrupted ones included; 2 bad input, reported
in one line. Nothing heavy is imported until a command needs it.
"""

from __future__ import annotations

import argparse
import os
import sys

from crosscontact.arguments import parser
from crosscontact.commands import scenes
from crosscontact.exam_arguments import run_exam, run_judge
from validation.execution.memory import keep_freed
from validation.execution.signals import interrupting

# The dense systems here are small: more threads than one cost time, and results must not depend on them.
for _variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_variable, "1")

ALL_SOLVERS = ("compare", "study", "stability", "report")
"""Commands that run every solver, if none is named."""


def main(arguments: list[str] | None = None) -> int:
    """Run the command line and return the exit code."""
    options = parser().parse_args(arguments)
    if options.command is None:
        parser().print_help()
        return 0
    try:
        with interrupting():
            code = _run(options)
            sys.stdout.flush()
            return code
    except KeyboardInterrupt:
        print("crosscontact: interrupted", file=sys.stderr)
        return 1
    except BrokenPipeError:  # the reader of our output has gone, e.g. `| head`
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        return 0
    except Exception as error:
        from contact_scene.errors import SceneError

        if isinstance(error, SceneError):
            print(f"crosscontact: error: {error}", file=sys.stderr)
            return 2
        if isinstance(error, OSError):
            print(f"crosscontact: error: {' '.join(str(error).split())}", file=sys.stderr)
            return 1
        raise


def _run(options: argparse.Namespace) -> int:
    """Run the command, alone in its folder."""
    if getattr(options, "out", None) is None or getattr(options, "dry_run", False):
        return _command(options)
    from validation.execution.folder_lock import locked_folder

    with locked_folder(options.out):
        return _command(options)


def _command(options: argparse.Namespace) -> int:
    keep_freed()
    jobs = getattr(options, "jobs", None) or _available_cores()
    if options.command == "scenes":
        return scenes.run()
    if options.command == "material":
        from crosscontact.commands import material

        return material.run(
            options.file,
            options.out,
            format=options.format,
            poisson=options.poisson,
            modulus=options.modulus,
            tolerance=options.tolerance,
            plot=options.plot,
        )
    if options.command == "exam":
        return run_exam(options, jobs)
    if options.command == "judge":
        return run_judge(options, jobs)
    from crosscontact import registry

    if options.command == "fit":
        from crosscontact.commands import fit

        return fit.run(
            options.data, options.scene, fit.settings_of(options), options.out, jobs, options.fresh
        )
    if options.command in ALL_SOLVERS and not _named(options):
        registry.usable()  # names those that cannot be loaded
    if options.command == "solve":
        from crosscontact.commands import solve

        return solve.run(
            options.scene,
            options.solver or registry.REFERENCE,
            options.resolution,
            options.out,
            fresh=options.fresh,
            estimate=options.estimate,
            plot=options.plot,
            max_steps=options.max_steps,
        )
    if options.command == "compare":
        from crosscontact.commands import compare

        return compare.run(options.scenes, options.solvers, options.out, jobs, options.fresh)
    if options.command == "study" and options.poisson is not None:
        from crosscontact.commands import poisson

        return poisson.run(options.scenes, options.poisson, options.out, jobs)
    if options.command == "study" and options.zones is not None:
        from crosscontact.commands import zones

        return zones.run(options.scenes, options.zones, options.out)
    if options.command == "study":
        from crosscontact.commands import study

        return study.run(options.scenes, options.out, jobs, options.fresh)
    if options.command == "stability":
        from crosscontact.commands import stability

        return stability.run(options.out, jobs, options.solver, options.only, options.fresh)
    if options.command == "sweep":
        from crosscontact.commands import sweep

        if options.plot is not None:
            return sweep.plot(options.plot)
        if options.plan is None:
            return sweep.list_plans()
        return sweep.run(options.plan, options.out, jobs, options.dask, options.dry_run, options.fresh)
    if options.command == "fields":
        from crosscontact.commands import fields
        from validation.fields.figures.figure_set import of_options

        return fields.run(
            options.scene,
            options.at,
            options.pull_off,
            options.every,
            options.resolution,
            options.out,
            of_options(options),
            max_steps=options.max_steps,
            fresh=options.fresh,
        )
    from crosscontact.commands import report

    return report.run(
        options.suite, options.out, jobs, options.estimates, options.baseline, options.fresh, options.fields
    )


def _named(options: argparse.Namespace) -> bool:
    """Whether the command names the solvers to run."""
    return bool(getattr(options, "solvers", None) or getattr(options, "solver", None))


def _available_cores() -> int:
    """Cores this process may use, not those of the machine."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


if __name__ == "__main__":
    sys.exit(main())
