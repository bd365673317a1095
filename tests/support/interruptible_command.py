"""The command line with runs that rest at every look and are kept often: something to be stopped.

The version is fixed, so that whoever edits a source meanwhile does not disturb. Run as
``python tests/support/interruptible_command.py REST ARGUMENTS...``.
"""

from __future__ import annotations

import sys
import time

from crosscontact.cli import main
from validation.execution import checkpoints

VERSION = "of the tests"

if __name__ == "__main__":
    rest = float(sys.argv[1])
    look = checkpoints.Keeper.goes_on

    def rest_at_every_look(self, state):
        time.sleep(rest)
        return look(self, state)

    checkpoints.version = lambda: VERSION
    checkpoints.EVERY = checkpoints.SHARE = 0.01
    checkpoints.Keeper.goes_on = rest_at_every_look
    sys.exit(main(sys.argv[2:]))
