"""Draws the first scene of the tutorial, as ``crosscontact solve my-scene.toml --plot`` does.

Run ``python docs/make_first_scene.py``; writes ``docs/first-scene.png``.
"""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

from matplotlib.figure import Figure

import crosscontact as cc
from validation.drawing.export import png

HERE = Path(__file__).parent


def draw() -> Figure:
    """Force against penetration and radius against force of the scene in the reference of scene files."""
    page = (HERE / "reference" / "scene-file.md").read_text("utf-8")
    block = re.findall(r"```toml\n(.*?)```", page, flags=re.DOTALL)[0]
    return cc.solve(cc.scene_from_dict(tomllib.loads(block))).figure()


if __name__ == "__main__":
    target = HERE / "first-scene.png"
    target.write_bytes(png(draw(), 90))
    print(target)
