"""``python -m crosscontact``: the command line."""

import sys

from crosscontact.cli import main

sys.exit(main())
