"""Python values kept in files: whole or not at all, of a known question, read back bit for bit.

A file is a line of JSON (format, question, digest, seconds of work behind it) and a pickle. The digest tells
damage. Nothing but numbers and classes of this program is read back, so that a file which somebody else put
there cannot make the reader run anything.
"""

from __future__ import annotations

import hashlib
import io
import json
import pickle
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from validation.execution.files import write_whole

FORMAT = 1
OURS = ("contact_scene", "bem_solver", "fem_solver", "meshes", "validation")
_NUMPY = ("_reconstruct", "scalar", "ndarray", "dtype", "_frombuffer")


class Unusable(Exception):
    """The file does not hold what is asked for; says why."""


class _Pickler(pickle.Pickler):
    """Arrays keep the order of their elements in memory: sums over them depend on it."""

    def reducer_override(self, value: Any) -> Any:
        if type(value) is np.ndarray and not (value.flags.c_contiguous or value.flags.f_contiguous):
            return laid_out, (np.ascontiguousarray(value), value.strides)
        return NotImplemented


class _Unpickler(pickle.Unpickler):
    def find_class(self, module: str, name: str) -> Any:
        root = module.partition(".")[0]
        if (module, name) == (__name__, laid_out.__name__):
            return laid_out
        if root == "numpy" and name in _NUMPY:
            return super().find_class(module, name)
        if root in OURS:
            found = super().find_class(module, name)
            if isinstance(found, type) and found.__module__.partition(".")[0] in OURS:
                return found
        raise pickle.UnpicklingError(f"{module}.{name} is nothing that is kept")


def laid_out(values: NDArray[Any], strides: tuple[int, ...]) -> NDArray[Any]:
    """A copy with the given strides, which may leave gaps or run backwards."""
    reach = [(n - 1) * stride for n, stride in zip(values.shape, strides, strict=True)]
    before, beyond = -sum(r for r in reach if r < 0), sum(r for r in reach if r > 0)
    room = bytearray(before + beyond + values.itemsize)
    copy: NDArray[Any] = np.ndarray(values.shape, values.dtype, room, before, strides)
    copy[...] = values
    return copy


def frozen(value: Any) -> bytes:
    """The value as bytes."""
    stream = io.BytesIO()
    _Pickler(stream, protocol=5).dump(value)
    return stream.getvalue()


def thawed(data: bytes) -> Any:
    """The value again.

    Raises
    ------
    Unusable
        If the bytes hold anything but numbers and classes of this program.
    """
    try:
        return _Unpickler(io.BytesIO(data)).load()
    except Exception as error:  # a pickle can fail in any way
        raise Unusable("it cannot be read") from error


def write(path: Path, question: str, value: Any, seconds: float = 0.0) -> None:
    """Keep a value that answers a question, with the seconds of work behind it."""
    data = frozen(value)
    header = {
        "format": FORMAT,
        "question": question,
        "digest": hashlib.sha256(data).hexdigest(),
        "seconds": seconds,
    }
    write_whole(path, json.dumps(header).encode() + b"\n" + data)


def read(path: Path, question: str) -> tuple[Any, float]:
    """The value kept under a question, and the seconds behind it.

    Raises
    ------
    Unusable
        If there is none, it is damaged, or it answers another question.
    """
    try:
        line, _, data = path.read_bytes().partition(b"\n")
        header = json.loads(line)
        known, digest, seconds = header["question"], header["digest"], float(header["seconds"])
    except FileNotFoundError:
        raise Unusable("there is none") from None
    except OSError as error:
        raise Unusable(f"it cannot be read: {error.strerror}") from None
    except (ValueError, KeyError, TypeError):
        raise Unusable("it is damaged") from None
    if header.get("format") != FORMAT or known != question:
        raise Unusable("it belongs to another scene, solver, option or version")
    if hashlib.sha256(data).hexdigest() != digest:
        raise Unusable("it is damaged")
    return thawed(data), seconds
