"""What an argument, or an entry of a scene, cannot be: by a word for each, tried one after the other."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from contact_scene import SceneError

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


def refusal(call: Callable[..., Any], *given: Any, longest: int = 400, **named: Any) -> SceneError:
    """The error with which a call is refused: one line, not long, that says what is allowed."""
    with pytest.raises(SceneError) as caught:
        call(*given, **named)
    line = str(caught.value)
    assert line.isprintable(), line
    assert "; allowed: " in line, line
    assert len(line) < longest, line
    return caught.value
