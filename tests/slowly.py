"""The command line with runs that rest at every look and are kept often: something to be stopped.

The version is fixed, so that whoever edits a source meanwhile does not disturb. Run as
``python tests/slowly.py REST ARGUMENTS...``.
"""

from __future__ import annotations

import sys
import time

from validation import resume
from validation.__main__ import main

VERSION = "of the tests"

if __name__ == "__main__":
    rest = float(sys.argv[1])
    look = resume.Keeper.goes_on

    def slowly(self, state):
        time.sleep(rest)
        return look(self, state)

    resume.version = lambda: VERSION
    resume.EVERY = resume.SHARE = 0.01
    resume.Keeper.goes_on = slowly
    sys.exit(main(sys.argv[2:]))
