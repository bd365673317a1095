"""A document as one HTML page that loads nothing: for screen, phone and paper, light and dark."""

from __future__ import annotations

import base64
from functools import cache

from jinja2 import Environment, PackageLoader, StrictUndefined

from validation.report.document import Document


def text(document: Document) -> str:
    """The whole page, the style sheet inside it."""
    templates = _templates()
    loader = templates.loader
    assert loader is not None
    style = loader.get_source(templates, "style.css")[0]
    return templates.get_template("document.html").render(document=document, style=style)


@cache
def _templates() -> Environment:
    made = Environment(
        loader=PackageLoader("validation.report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    made.filters["data_address"] = _data_address
    return made


def _data_address(picture: bytes) -> str:
    """A PNG or GIF file as part of the page."""
    kind = "gif" if picture.startswith(b"GIF") else "png"
    return f"data:image/{kind};base64,{base64.b64encode(picture).decode('ascii')}"
