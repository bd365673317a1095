"""Python values in files: whole or not at all, of a known fingerprint, read back bit for bit.

A file is a line of JSON (format, fingerprint, digest, seconds of work) and a pickle. The digest detects
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

FORMAT = 2
OWN_PACKAGES = ("contact_scene", "bem_solver", "fem_solver", "meshes", "validation")
_NUMPY = ("_reconstruct", "scalar", "ndarray", "dtype", "_frombuffer")


class UnusableFile(Exception):
    """The file does not hold the value that is wanted; the message says why."""


class _Pickler(pickle.Pickler):
    """Arrays keep the order of their elements in memory: sums over them depend on it."""

    def reducer_override(self, value: Any) -> Any:
        if type(value) is np.ndarray and not (value.flags.c_contiguous or value.flags.f_contiguous):
            return with_strides, (np.ascontiguousarray(value), value.strides)
        return NotImplemented


class _Unpickler(pickle.Unpickler):
    def find_class(self, module: str, name: str) -> Any:
        root = module.partition(".")[0]
        if (module, name) == (__name__, with_strides.__name__):
            return with_strides
        if root == "numpy" and name in _NUMPY:
            return super().find_class(module, name)
        if root in OWN_PACKAGES:
            content = super().find_class(module, name)
            if isinstance(content, type) and content.__module__.partition(".")[0] in OWN_PACKAGES:
                return content
        raise pickle.UnpicklingError(f"{module}.{name} is neither a number nor a class of this program")


def with_strides(values: NDArray[Any], strides: tuple[int, ...]) -> NDArray[Any]:
    """A copy with the given strides, which may leave gaps or run backwards."""
    reach = [(n - 1) * stride for n, stride in zip(values.shape, strides, strict=True)]
    before, beyond = -sum(r for r in reach if r < 0), sum(r for r in reach if r > 0)
    memory = bytearray(before + beyond + values.itemsize)
    copy: NDArray[Any] = np.ndarray(values.shape, values.dtype, memory, before, strides)
    copy[...] = values
    return copy


def dumps(value: Any) -> bytes:
    """The value as bytes."""
    stream = io.BytesIO()
    _Pickler(stream, protocol=5).dump(value)
    return stream.getvalue()


def loads(data: bytes) -> Any:
    """The value again.

    Raises
    ------
    UnusableFile
        If the bytes hold anything but numbers and classes of this program.
    """
    try:
        return _Unpickler(io.BytesIO(data)).load()
    except Exception as error:  # a pickle can fail in any way
        raise UnusableFile("it cannot be read") from error


def write(path: Path, fingerprint: str, value: Any, seconds: float = 0.0) -> None:
    """Write a value.

    Parameters
    ----------
    path : Path
    fingerprint : str
        Of what the value answers (see ``fingerprints``).
    value : object
    seconds : float
        Wall time of the work behind it.
    """
    data = dumps(value)
    header = {
        "format": FORMAT,
        "fingerprint": fingerprint,
        "digest": hashlib.sha256(data).hexdigest(),
        "seconds": seconds,
    }
    write_whole(path, json.dumps(header).encode() + b"\n" + data)


def read(path: Path, fingerprint: str) -> tuple[Any, float]:
    """The value written under a fingerprint, and the seconds behind it.

    Raises
    ------
    UnusableFile
        If there is none, it is damaged, or it has another fingerprint.
    """
    try:
        line, _, data = path.read_bytes().partition(b"\n")
        header = json.loads(line)
        written_for, digest, seconds = header["fingerprint"], header["digest"], float(header["seconds"])
    except FileNotFoundError:
        raise UnusableFile("there is none") from None
    except OSError as error:
        raise UnusableFile(f"it cannot be read: {error.strerror}") from None
    except (ValueError, KeyError, TypeError):
        raise UnusableFile("it is damaged") from None
    if header.get("format") != FORMAT or written_for != fingerprint:
        raise UnusableFile("it belongs to another scene, solver, option or version")
    if hashlib.sha256(data).hexdigest() != digest:
        raise UnusableFile("it is damaged")
    return loads(data), seconds
