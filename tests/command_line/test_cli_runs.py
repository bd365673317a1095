"""The command line with the real solvers, in processes of their own."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time

import pytest

COMMAND = [sys.executable, "-m", "crosscontact"]


@pytest.mark.slow
def test_compare_in_parallel(tmp_path):
    said = subprocess.run(
        [*COMMAND, "compare", "relaxed-equilibrium", "--jobs", "2", "--out", str(tmp_path)],
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert said.returncode == 0, said.stderr
    assert "compare: runs: 3/3" in said.stderr
    assert "FAIL" not in said.stdout
    data = json.loads((tmp_path / "report.json").read_text())
    assert list(data["scenes"][0]["runs"]) == ["bem", "fem", "reference"]


@pytest.mark.parametrize(
    ("arguments", "seconds"),
    [
        (["solve", "sweep", "--solver", "reference"], 2.0),
        (["report", "--jobs", "2"], 0.3),
        pytest.param(["report", "--jobs", "2"], 2.0, marks=pytest.mark.slow),
    ],
)
def test_interrupt(tmp_path, arguments, seconds):
    """So many seconds after the program has been loaded, before which Python answers by itself."""
    program = "import sys; from crosscontact.cli import main; print('up', flush=True); sys.exit(main())"
    work = subprocess.Popen(
        [sys.executable, "-c", program, *arguments, "--out", str(tmp_path / "out")],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    assert work.stdout is not None
    assert work.stdout.readline() == "up\n"
    time.sleep(seconds)
    os.killpg(work.pid, signal.SIGINT)  # as a terminal does: to the workers too
    out, err = work.communicate(timeout=30)
    assert work.returncode in (1, -signal.SIGINT), (out, err)  # before and after the command is up
    assert err.splitlines()[-1] == "crosscontact: interrupted"
    assert "Traceback" not in err
    assert not (tmp_path / "out" / "report.json").exists()
