"""``crosscontact scenes``."""

from __future__ import annotations

import argparse

from crosscontact.commands import scenes


def add_arguments(command: argparse.ArgumentParser) -> None:
    """It has none."""


def carry_out(options: argparse.Namespace, jobs: int) -> int:
    """List the built-in scenes."""
    return scenes.run()
