"""The command line with runs that rest at every step and say when they begin: something to be stopped.

The version is fixed, so that whoever edits a source meanwhile does not disturb. Run as
``python tests/support/interruptible_command.py REST ARGUMENTS...``.
"""

from __future__ import annotations

import sys
import time

from crosscontact.cli import main
from validation.runs import process, provenance

VERSION = "of the tests"
BEGUN = "the run has begun"

if __name__ == "__main__":
    rest = float(sys.argv[1])
    monitor, looks = process.GracefulStop.monitor, iter(range(10))

    def rest_at_every_step(self):
        if next(looks, None) == 9:
            print(BEGUN, flush=True)
        time.sleep(rest)
        return monitor(self)

    provenance.version = lambda: VERSION
    process.GracefulStop.monitor = rest_at_every_step
    sys.exit(main(sys.argv[2:]))
