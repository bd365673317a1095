"""The arguments of ``crosscontact fields``."""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterable
from typing import TYPE_CHECKING

from crosscontact.arguments.shared_options import fresh_option, max_steps_option
from crosscontact.arguments.value_types import Names, count, number, resolution

if TYPE_CHECKING:
    from validation.fields.figures.figure_set import FigureSet

_time = number(lambda value: 0.0 <= value < math.inf, "times >= 0")


def _quantity_names() -> Iterable[str]:
    from validation.fields.figures.quantities import QUANTITIES

    return QUANTITIES


def add_arguments(command: argparse.ArgumentParser) -> None:
    """Scene, moments and figures."""
    command.add_argument("scene", metavar="SCENE", help="a TOML file or the name of a built-in scene")
    command.add_argument(
        "--at",
        type=_time,
        nargs="+",
        default=[],
        metavar="T",
        help="times, stepped onto exactly; where the load jumps, the state before",
    )
    command.add_argument("--pull-off", action="store_true", help="the moment of largest tension")
    command.add_argument(
        "--every",
        type=count,
        default=0,
        metavar="N",
        help="every N-th accepted step, the start included; not drawn",
    )
    command.add_argument(
        "--resolution", type=resolution, metavar="N", help="divisions per process zone, as for solve"
    )
    max_steps_option(command)
    command.add_argument("--out", metavar="DIR", help="default: out/fields/SCENE")
    fresh_option(command, keeps_runs=False)
    _add_figures(command)


def _add_figures(command: argparse.ArgumentParser) -> None:
    drawn = command.add_argument_group("figures", "sections are drawn at all moments; where asked for, also")
    drawn.add_argument("--strip", action="store_true", help="the key moments of the run side by side")
    drawn.add_argument(
        "--animate", action="store_true", help="the whole run as an animated GIF; no files for ParaView"
    )
    drawn.add_argument("--revolve", action="store_true", help="the body in three dimensions")
    drawn.add_argument(
        "--show", action="store_true", help="the last moment in a window, where there is a screen"
    )
    drawn.add_argument(
        "--alike",
        action="store_true",
        help="one magnification, view and range of colours for all sections of the run",
    )
    drawn.add_argument(
        "--quantity",
        nargs="+",
        choices=Names(_quantity_names),
        metavar="Q",
        help="what to draw, of %(choices)s; default: von_mises stress_zz dissipation_rate",
    )
    drawn.add_argument("--no-figures", action="store_true", help="files for ParaView only")


def carry_out(options: argparse.Namespace, jobs: int) -> int:
    """Compute, write and draw the fields in the body."""
    from crosscontact.commands import fields

    return fields.run(
        options.scene,
        options.at,
        options.pull_off,
        options.every,
        options.resolution,
        options.out,
        _figures(options),
        max_steps=options.max_steps,
        fresh=options.fresh,
    )


def _figures(options: argparse.Namespace) -> FigureSet | None:
    """The figures that options of the command line request; ``None`` for none.

    Raises
    ------
    SceneError
        If a quantity has no such name, or figures are both requested and excluded.
    """
    from contact_scene import SceneError
    from validation.fields.figures.figure_set import USUAL, FigureSet

    if options.no_figures:
        if (
            options.quantity
            or options.strip
            or options.animate
            or options.revolve
            or options.show
            or options.alike
        ):
            raise SceneError("--no-figures", "figures are asked for beside it", "one or the other")
        return None
    quantities = tuple(dict.fromkeys(options.quantity or USUAL))
    return FigureSet(quantities, options.strip, options.animate, options.revolve, options.show, options.alike)
