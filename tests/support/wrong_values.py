"""What an argument, or an entry of a scene, cannot be: by a word for each, tried one after the other."""

from __future__ import annotations

import numpy as np

WRONG = {
    "None": None,
    "text": "x",
    "array": np.array([1.0, 2.0]),
    "list": [1.0, 2.0],
    "nan": float("nan"),
    "truth value": True,
    "object": object(),
    "empty array": np.array([]),
    "texts": np.array(["a", "b"]),
    "mapping": {},
    "huge": 10**400,
    "complex": 1j,
}


def refused(error: ValueError) -> None:
    """Check that a refusal is one line that says what is allowed."""
    line = str(error)
    assert line.isprintable()
    assert "; allowed: " in line, line
    assert len(line) < 400, line
