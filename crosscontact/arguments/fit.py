"""The arguments of ``crosscontact fit``."""

from __future__ import annotations

import argparse

from crosscontact.arguments.shared_options import (
    fresh_option,
    jobs_option,
    max_steps_option,
    solver_option,
)
from crosscontact.arguments.value_types import count, resolution


def add_arguments(command: argparse.ArgumentParser) -> None:
    """Curves, first guess, what is fitted and how."""
    command.add_argument("data", metavar="DATA", nargs="+", help="CSV files, or files that afmformats reads")
    command.add_argument("scene", metavar="SCENE", help="the first guess: a TOML file or a built-in name")
    _add_parameters(command)
    command.add_argument("--starts", type=count, default=3, metavar="N", help="default: %(default)s")
    command.add_argument("--seed", type=int, default=0, metavar="N", help="of the starts that are drawn")
    command.add_argument(
        "--profile", nargs="+", default=[], metavar="NAME", help="profile likelihood of these, or all"
    )
    solver_option(command, "default: the reference")
    command.add_argument("--check-solver", default="bem", metavar="NAME", help="or none; default: bem")
    command.add_argument("--resolution", type=resolution, metavar="N", help="default: by the noise")
    command.add_argument("--out", metavar="DIR", help="write page, fit.json, scene.toml and figure there")
    max_steps_option(command)
    jobs_option(command)
    fresh_option(command)


def _add_parameters(command: argparse.ArgumentParser) -> None:
    command.add_argument(
        "--vary",
        nargs="+",
        default=[],
        metavar="PATH[=LOW:HIGH]",
        help="numbers of the scene, as adhesion.work or material.branches[0].time=0.1:10",
    )
    command.add_argument(
        "--per-curve", nargs="+", default=[], metavar="PATH", help="the same, another value for each curve"
    )
    command.add_argument(
        "--tie", nargs="+", default=[], metavar="PATH=OTHER", help="PATH keeps its ratio to OTHER"
    )
    command.add_argument(
        "--free",
        nargs="+",
        default=[],
        metavar="NAME",
        help="of each curve: contact_point, baseline, drift, time_offset",
    )
    command.add_argument(
        "--prony", nargs="+", type=float, default=[], metavar="TIME", help="moduli on these relaxation times"
    )
    command.add_argument(
        "--regularisation",
        type=float,
        metavar="X",
        help="weight of the bending of these moduli; default: 0.1",
    )


def carry_out(options: argparse.Namespace, jobs: int) -> int:
    """Fit numbers of a scene to measured curves."""
    from crosscontact.commands import fit

    return fit.run(options.data, options.scene, fit.settings_of(options), options.out, jobs, options.fresh)
