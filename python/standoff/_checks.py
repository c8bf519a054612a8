# SPDX-License-Identifier: Apache-2.0
"""Checks of single arguments: errors name the argument and say what it must be, before the compiled module sees it."""

from __future__ import annotations

import numbers
import os
from collections.abc import Iterable
from typing import Any

import numpy as np

PathLike = str | os.PathLike[str]


def number(value: Any, what: str) -> float:
    if (isinstance(value, numbers.Real) and not isinstance(value, bool)) or (
        getattr(value, "ndim", None) == 0 and hasattr(value, "__float__")  # an array's number
    ):
        try:
            return float(value)
        except OverflowError:
            raise ValueError(f"{what}: is too large for a number of double precision") from None
    raise TypeError(f"{what}: must be a number, not {type(value).__name__}")


def whole_number(value: Any, what: str, *, bits: int = 64) -> int:
    """A whole number that a signed integer of so many bits holds."""
    if not isinstance(value, numbers.Integral) or isinstance(value, bool):
        raise TypeError(f"{what}: must be a whole number, not {value!r}")
    found = int(value)
    if not -(1 << (bits - 1)) <= found < 1 << (bits - 1):
        raise ValueError(f"{what}: must have at most {bits} bits, and {found} has more")
    return found


def threads_of(threads: Any) -> int:
    return whole_number(threads, "threads", bits=32)


def runs_on(threads: Any, device: Any) -> tuple[int, str]:
    """Threads and device, as the compiled module takes them."""
    if not isinstance(device, str):
        raise TypeError(f"device: must be 'auto', 'cpu', 'cuda', 'cuda:N' or 'emulated', not {device!r}")
    return threads_of(threads), text(device, "device")


def flag(value: Any, what: str) -> bool:
    if isinstance(value, (bool, np.bool_)):
        return bool(value)
    raise TypeError(f"{what}: must be True or False, not {value!r}")


def name(value: Any, what: str) -> str:
    """The name of a choice; which there are, the compiled module knows, and its error lists them."""
    if isinstance(value, str):
        return text(value, what)
    raise TypeError(f"{what}: must be one of the names that the documentation lists, as a string, not {value!r}")


def text(value: Any, what: str) -> str:
    if not isinstance(value, str):
        raise TypeError(f"{what}: must be a string, not {value!r}")
    try:
        value.encode()
    except UnicodeEncodeError as error:
        raise ValueError(f"{what}: {value!r} is no text that can be written: {error.reason}") from None
    return value


def path_of(path: Any, what: str = "path") -> str:
    """The name of a file that is to be written."""
    try:
        found = os.fsdecode(path)
    except TypeError:
        raise TypeError(f"{what}: must be a string or a pathlib.Path, not {type(path).__name__}") from None
    if "\0" in found:
        raise ValueError(f"{what}: holds a null character, which no file's name can")
    return found


def triple(value: Any, what: str, *, whole: bool = False) -> tuple[Any, Any, Any]:
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if isinstance(value, (str, bytes)) or not isinstance(value, Iterable):
        raise TypeError(f"{what}: must be three numbers, not {type(value).__name__}")
    three = [(whole_number if whole else number)(v, what) for v in value]
    if len(three) != 3:
        raise ValueError(f"{what}: must be three numbers, one for each axis, not {len(three)}")
    return three[0], three[1], three[2]
