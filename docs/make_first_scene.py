"""Draws the README's first scene, as ``crosscontact solve my-scene.toml --plot`` does.

Run ``python docs/make_first_scene.py``; writes ``docs/first-scene.png``.
"""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

from matplotlib.figure import Figure
from validation.drawing.figures import png

import crosscontact as cc

HERE = Path(__file__).parent


def draw() -> Figure:
    """Force against penetration and radius against force of the scene in the README."""
    (block,) = re.findall(
        r"```toml\n(.*?)```", (HERE.parent / "README.md").read_text("utf-8"), flags=re.DOTALL
    )
    return cc.solve(cc.scene_from_dict(tomllib.loads(block))).figure()


if __name__ == "__main__":
    target = HERE / "first-scene.png"
    target.write_bytes(png(draw(), 90))
    print(target)
