"""The arguments of ``crosscontact study``."""

from __future__ import annotations

import argparse

from crosscontact.arguments.shared_options import fresh_option, jobs_option, max_steps_option
from crosscontact.arguments.value_types import number

_bulk = number(lambda value: 2.0 / 3.0 < value < 1e6, "a number above 2/3, below 1e6")
_ratio = number(lambda value: 2e-9 <= value <= 0.2, "a number from 2e-9 to 0.2")


def add_arguments(command: argparse.ArgumentParser) -> None:
    """Scenes, and the study to make of them: refinement, Poisson's ratio, or shorter process zones."""
    command.add_argument("scenes", metavar="SCENE", nargs="+", help="TOML files or built-in names")
    command.add_argument("--out", metavar="DIR", help="write page, Markdown, JSON and figures there")
    max_steps_option(command)
    jobs_option(command, "processes for what is not timed")
    command.add_argument(
        "--poisson",
        type=_bulk,
        nargs="*",
        metavar="K/G",
        help="instead: elastic bulk of these ratios to the relaxed shear modulus (10 to 1000), against a "
        "constant Poisson's ratio",
    )
    command.add_argument(
        "--zones",
        type=_ratio,
        nargs="*",
        metavar="RATIO",
        help="instead: steps, points, time and error of every solver with process zones of these ratios to "
        "the contact radius (5e-2 to 5e-9)",
    )
    fresh_option(command)


def carry_out(options: argparse.Namespace, jobs: int) -> int:
    """Make one of the studies of every solver."""
    from contact_scene import SceneError
    from crosscontact import registry
    from crosscontact.commands import poisson, study, zones

    if options.poisson is not None and options.zones is not None:
        raise SceneError("--zones", "given beside --poisson", "one of the two, each a study of its own")
    registry.usable()  # names those that cannot be loaded
    if options.poisson is not None:
        return poisson.run(
            options.scenes,
            options.poisson,
            options.out,
            jobs,
            fresh=options.fresh,
            max_steps=options.max_steps,
        )
    if options.zones is not None:
        return zones.run(
            options.scenes, options.zones, options.out, options.fresh, max_steps=options.max_steps
        )
    return study.run(options.scenes, options.out, jobs, options.fresh, max_steps=options.max_steps)
