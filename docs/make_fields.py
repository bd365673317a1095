"""Draws the figure of the page on fields: the stress under the contact at the key moments of a cycle.

Run ``python docs/make_fields.py``; writes ``docs/fields.png``.
"""

from __future__ import annotations

from pathlib import Path

from matplotlib.figure import Figure

from validation.cases import load
from validation.drawing.export import png
from validation.fields.figures import moment_panels
from validation.fields.figures.moments import key_moments
from validation.fields.figures.quantities import QUANTITIES
from validation.fields.request import FieldRequest, record_fields


def draw() -> Figure:
    """Four panels."""
    scene = load("cycle-v0.002").scene
    recorded = record_fields(scene, FieldRequest(picked=key_moments))
    return moment_panels.figure(list(recorded.states()), scene, QUANTITIES["stress_zz"])


if __name__ == "__main__":
    target = Path(__file__).with_name("fields.png")
    target.write_bytes(png(draw(), 90))
    print(target)
