"""The command line with runs that rest at every step and write many checkpoints: something to be stopped.

The version is fixed, so that whoever edits a source meanwhile does not disturb. Run as
``python tests/support/interruptible_command.py REST ARGUMENTS...``.
"""

from __future__ import annotations

import sys
import time

from crosscontact.cli import main
from validation.execution import checkpoints, fingerprints

VERSION = "of the tests"

if __name__ == "__main__":
    rest = float(sys.argv[1])
    continue_run = checkpoints.CheckpointWriter.continue_run

    def rest_at_every_step(self, state):
        time.sleep(rest)
        return continue_run(self, state)

    fingerprints.version = lambda: VERSION
    checkpoints.INTERVAL = checkpoints.INTERVAL_PER_WRITE = 0.01
    checkpoints.CheckpointWriter.continue_run = rest_at_every_step
    sys.exit(main(sys.argv[2:]))
