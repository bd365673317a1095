"""Draws the second figure of the README: the stress under the contact at the key moments of a cycle.

Run ``python docs/make_fields.py``; writes ``docs/fields.png``.
"""

from __future__ import annotations

from pathlib import Path

from matplotlib.figure import Figure

from validation.cases import load
from validation.drawing.figures import png
from validation.fields.figures import strip
from validation.fields.figures.moments import key_moments
from validation.fields.figures.quantities import QUANTITIES
from validation.fields.request import Request, answer


def draw() -> Figure:
    """Four panels."""
    scene = load("cycle-v0.002").scene
    answered = answer(scene, Request(picked=key_moments))
    return strip.figure(list(answered.states()), scene, QUANTITIES["stress-zz"])


if __name__ == "__main__":
    target = Path(__file__).with_name("fields.png")
    target.write_bytes(png(draw(), 90))
    print(target)
