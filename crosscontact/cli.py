"""The command line as a process: streams, interruptions, the folder held, and the exit code.

What a command does is a file of ``commands``. Exit codes: 0 all well; 1 a check failed or a run did not
finish, interrupted ones included; 2 bad input, reported in one line. Nothing heavy is imported until a
command needs it.
"""

from __future__ import annotations

import io
import os
import sys
from contextlib import redirect_stderr, redirect_stdout
from typing import TYPE_CHECKING, Any, TextIO, cast

if TYPE_CHECKING:
    import argparse
    from collections.abc import Callable

# The dense systems here are small: more threads than one cost time, and results must not depend on them.
for _variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_variable, "1")


def program() -> int:
    """Run the command line as a process, and return the exit code, which no further signal changes.

    An interruption ends the command once; one that comes while the process ends, ends it at once.
    """
    try:
        from validation.runs.process import handle_outside

        handle_outside()
        code = main()
    except KeyboardInterrupt:
        code = _interrupted()
    handle_outside(code)
    return code


def main(arguments: list[str] | None = None) -> int:
    """Run the command line and return the exit code."""
    _prepare_streams()
    with (
        redirect_stdout(cast(TextIO, _Printable(sys.stdout))),
        redirect_stderr(cast(TextIO, _Printable(sys.stderr))),
    ):
        return _run_to_its_end(arguments)


class _Printable:
    """A stream, perhaps to a terminal, which titles and names of files are not to steer."""

    def __init__(self, unfiltered: TextIO) -> None:
        self.unfiltered = unfiltered

    def write(self, text: str) -> int:
        if text.replace("\n", "").replace("\t", "").isprintable():
            return self.unfiltered.write(text)
        from contact_scene.errors import printable

        return self.unfiltered.write(printable(text))

    def __getattr__(self, name: str) -> Any:
        return getattr(self.unfiltered, name)


def _run_to_its_end(arguments: list[str] | None) -> int:
    os.environ["MPLBACKEND"] = "agg"  # figures are files; a notebook's backend may be missing here
    try:  # around the imports, too: an interruption in them is told as any other
        from crosscontact.commands import parser
        from validation.runs.process import interrupting

        with interrupting():
            options = parser().parse_args(arguments)  # imports the command
            if options.command is None:
                parser().print_help()
                return 0
            code = _run(options)
            sys.stdout.flush()
            return code
    except KeyboardInterrupt:
        return _interrupted()
    except BrokenPipeError:  # the reader of our output has gone, e.g. `| head`
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        return 0
    except Exception as error:
        from contact_scene.errors import SceneError

        if isinstance(error, SceneError):
            print(f"crosscontact: error: {error}", file=sys.stderr)
            return 2
        if isinstance(error, OSError):
            print(f"crosscontact: error: {' '.join(str(error).split())}", file=sys.stderr)
            return 1
        raise


def _interrupted() -> int:
    # Python ends by the signal, not by our code, if the last text run by exec was interrupted, as it may be
    # where dataclasses are made: run another.
    exec("")
    print("crosscontact: interrupted", file=sys.stderr)
    return 1


def _prepare_streams() -> None:
    """Output may be closed (``>&-``), and may not know Greek letters (another encoding)."""
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None:
            setattr(sys, name, io.TextIOWrapper(io.FileIO(os.devnull, "w"), encoding="utf-8"))
        elif isinstance(stream, io.TextIOWrapper) and stream.errors == "strict":
            stream.reconfigure(errors="replace")


def _run(options: argparse.Namespace) -> int:
    """Run the command, alone in its folder."""
    from validation.runs.process import keep_freed

    keep_freed()
    jobs = getattr(options, "jobs", None) or _available_cores()
    run: Callable[[argparse.Namespace, int], int] = options.run
    if getattr(options, "out", None) is None or getattr(options, "dry_run", False):
        return run(options, jobs)
    from validation.runs.folder import locked_folder

    with locked_folder(options.out):
        return run(options, jobs)


def _available_cores() -> int:
    """Cores this process may use, not those of the machine."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


if __name__ == "__main__":
    sys.exit(program())
