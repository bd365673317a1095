"""Commands in this process, with stand-ins in place of the solvers."""

from __future__ import annotations

import pytest
from support.spring_solver import FunctionSolver, fake, named

from crosscontact.cli import main
from validation import solvers


def code_of(*arguments: object) -> int:
    """Exit code of a command, whether it returns or leaves."""
    try:
        return main(list(map(str, arguments)))
    except SystemExit as leave:
        return int(leave.code or 0)


def refusal(capsys: pytest.CaptureFixture[str], *arguments: object) -> str:
    """The only line, on stderr, that a command says which is refused as bad input."""
    capsys.readouterr()
    assert code_of(*arguments) == 2
    out, err = capsys.readouterr()
    (line,) = err.splitlines()
    assert (out, err) == ("", f"{line}\n")
    return line


def stand_in(
    monkeypatch: pytest.MonkeyPatch, method: FunctionSolver | None = None, **by_name: FunctionSolver
) -> None:
    """Put a method in place of every solver, by default a spring, or others by the names of solvers."""
    for name in tuple(solvers.SOLVERS):
        monkeypatch.setitem(solvers.SOLVERS, name, named(name, by_name.get(name, method or fake())))
