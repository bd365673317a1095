"""The examples in the docstrings of the public names, run as a reader would run them."""

from __future__ import annotations

import doctest
from pathlib import Path

import numpy as np
import pytest

import crosscontact as cc

WITHOUT = {"__version__"}
LONG = {"Fit", "fit", "fit_each", "judge", "sweep"}
EXAMPLES = {
    name: found
    for name in cc.__all__
    for found in doctest.DocTestFinder(recurse=False).find(getattr(cc, name), name, globs={})
}


def test_every_public_name_has_an_example():
    assert {name for name in cc.__all__ if name not in EXAMPLES or not EXAMPLES[name].examples} == WITHOUT


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=[pytest.mark.slow] if name in LONG else [])
        for name, found in EXAMPLES.items()
        if found.examples
    ],
)
def test_the_example_of_a_public_name(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    EXAMPLES[name].globs = {"cc": cc, "np": np, "Path": Path}
    said: list[str] = []
    result = doctest.DocTestRunner(verbose=False).run(EXAMPLES[name], out=said.append)
    assert not result.failed, "".join(said)
