"""Puts the README's table of accuracy and cost there anew: ``python docs/update_readme.py``."""

from __future__ import annotations

from pathlib import Path

from site_pages.readme import update

HERE = Path(__file__).parent

if __name__ == "__main__":
    update(HERE.parent / "README.md", HERE / "data" / "report.zip")
