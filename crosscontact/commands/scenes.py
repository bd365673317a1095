"""``crosscontact scenes``: the built-in scenes."""

from __future__ import annotations

import argparse

from validation import scenes


def run(options: argparse.Namespace, jobs: int) -> int:
    """Print name, quick suite or not, and title of every built-in scene."""
    titles = scenes.titles()
    width = max(map(len, titles))
    quick = set(scenes.suite("quick"))
    for name, title in titles.items():
        print(f"{name:<{width}}  {'quick' if name in quick else '     '}  {title}")
    return 0
