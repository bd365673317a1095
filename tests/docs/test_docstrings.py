"""The examples in the docstrings of the public names, run as a reader would run them."""

from __future__ import annotations

import doctest
from pathlib import Path

import numpy as np
import pytest

import crosscontact as cc

WITHOUT = {"__version__"}
LONG = {"Fit", "fit", "fit_each", "judge", "sweep"}


@pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=[pytest.mark.slow] if name in LONG else []) for name in cc.__all__],
)
def test_the_example_of_a_public_name(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    example = next(iter(doctest.DocTestFinder(recurse=False).find(getattr(cc, name), name, globs={})), None)
    assert (example is None or not example.examples) == (name in WITHOUT)
    if example is not None:
        example.globs = {"cc": cc, "np": np, "Path": Path}
        said: list[str] = []
        result = doctest.DocTestRunner(verbose=False).run(example, out=said.append)
        assert not result.failed, "".join(said)
