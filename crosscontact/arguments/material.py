"""The arguments of ``crosscontact material``."""

from __future__ import annotations

import argparse


def add_arguments(command: argparse.ArgumentParser) -> None:
    """File, how it is read, and what is written and drawn."""
    command.add_argument(
        "file",
        metavar="FILE",
        help="a series (pyvisco, RepTate, columns tau, E) or data (columns t, E or w, E', E'')",
    )
    command.add_argument("--format", metavar="NAME", help="of FILE; default: told by its columns")
    command.add_argument("--poisson", type=float, default=0.5, metavar="NU", help="default: %(default)s")
    command.add_argument(
        "--modulus", type=float, metavar="E0", help="relaxed Young's modulus, where FILE has none"
    )
    command.add_argument(
        "--tolerance",
        type=float,
        metavar="X",
        help="drop branches as long as the misfit (relative, root mean square) stays below X; of data that "
        "scatter by more, as long as Schwarz' criterion prefers the shorter series; default: 0.001",
    )
    command.add_argument("--out", metavar="DIR", help="write material.toml, the table of a scene, there")
    command.add_argument(
        "--plot",
        action="store_true",
        help="draw material.png and material.svg, into --out or the current folder",
    )


def carry_out(options: argparse.Namespace, jobs: int) -> int:
    """Read a series, or fit one to measured moduli."""
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
