"""Pages of the documentation whose cells are run in tests."""

from __future__ import annotations

import re
from pathlib import Path

EXPLANATION = Path(__file__).parents[2] / "docs/explanation"


def code_cells(name: str) -> list[str]:
    """The code cells of an explanation, in their order."""
    text = (EXPLANATION / f"{name}.md").read_text("utf-8")
    return re.findall(r"```\{code-cell\} python\n(.*?)```", text, re.DOTALL)
