"""The documentation site: ``python -m sphinx -W -b html docs out/docs``.

Pages that come from the program or from a saved report are written to ``docs/generated`` first; nothing is
run for them. ``CROSSCONTACT_REPORT`` names the folder of another report than ``docs/data/report.zip``.
"""

import os
import sys
from pathlib import Path

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE), str(HERE.parent)]
os.environ.pop("MPLBACKEND", None)  # a notebook then shows its figures by itself
os.environ["COLUMNS"] = "90"  # of the help of the commands
paths = [str(HERE), str(HERE.parent), os.environ.get("PYTHONPATH")]  # of the cells: figures, the program
os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, paths))

import site_pages  # noqa: E402 - found by the path above
from nbclient import NotebookClient  # noqa: E402

import crosscontact  # noqa: E402

project = "crosscontact"
author = "the crosscontact authors"
copyright = "2026, the crosscontact authors"
version = release = crosscontact.__version__
extensions = ["myst_nb", "sphinx.ext.autodoc", "numpydoc", "sphinx_copybutton", "sphinxcontrib.towncrier"]
exclude_patterns = [
    "data",
    "**/.ipynb_checkpoints",
    "generated/accuracy.md",
]  # the last is shown inside other pages

html_theme = "furo"
html_title = "crosscontact"
html_static_path = ["_static"]
html_css_files = ["site.css", "report-parts.css"]
html_js_files = [("report-parts.js", {"defer": "defer"})]
html_copy_source = False
html_show_sourcelink = False
html_math_renderer = "mathml"

towncrier_draft_autoversion_mode = "draft"
towncrier_draft_include_empty = False
towncrier_draft_working_directory = HERE.parent

smartquotes = False  # options begin with two hyphens
myst_enable_extensions = ["dollarmath", "colon_fence", "deflist", "attrs_block"]
myst_heading_anchors = 3
nb_execution_mode = "force"
nb_execution_raise_on_error = True
nb_execution_in_temp = True
nb_execution_timeout = 120
nb_merge_streams = True  # what a loop prints is one box

NotebookClient.startup_timeout.default_value = 300  # seconds, on a busy machine

autodoc_typehints = "none"
autodoc_member_order = "bysource"
numpydoc_show_class_members = False
copybutton_exclude = ".linenos, .gp, .go"


def setup(app):
    """Write the generated pages before Sphinx looks for pages."""
    app.add_html_math_renderer("mathml", (site_pages.formula, None), (site_pages.displayed, None))
    site_pages.write(Path(os.environ.get("CROSSCONTACT_REPORT", site_pages.ARCHIVE)))
