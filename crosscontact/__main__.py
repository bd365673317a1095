"""``python -m crosscontact``: the command line."""

import sys

from crosscontact.cli import program

sys.exit(program())
