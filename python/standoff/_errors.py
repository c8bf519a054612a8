# SPDX-License-Identifier: Apache-2.0
"""The exceptions of standoff, with what programs need to know as attributes."""

from __future__ import annotations

__all__ = [
    "DeviceError",
    "DoubtError",
    "Error",
    "InputError",
    "LimitError",
    "MeshError",
    "OutputError",
    "SignWarning",
    "SurfaceWarning",
    "UsageError",
    "VerifyError",
]


class Error(Exception):
    """What every exception of standoff derives from.

    The message says what is wrong, where, why, and what to do next. Programs use the attributes; each is ``None``
    where it is not known.
    """

    triangle: int | None = None
    """The first triangle of the mesh that cannot be used."""
    file: str | None = None
    """The file that cannot be read or written."""
    line: int | None = None
    """In that file, from 1."""
    byte: int | None = None
    """In that file, from 0."""
    bytes_needed: int | None = None
    """How much memory is needed."""
    bytes_limit: int | None = None
    """The limit, or the memory there is."""


class UsageError(Error, ValueError):
    """An argument, or a combination of arguments, that makes no sense."""


class InputError(Error, ValueError):
    """A file that cannot be used as it is: ``file``, ``line`` and ``byte`` say where."""


class MeshError(InputError):
    """A mesh that cannot be used as it is: ``triangle`` says which triangle is the first such."""


class DoubtError(MeshError):
    """The sign is not certain, and ``Sign(strict=True)`` asked for certainty."""


class OutputError(Error, OSError):
    """A file that cannot be written; what was there before is as it was."""


class LimitError(Error, MemoryError):
    """More memory, or a larger size, than is allowed: see ``bytes_needed`` and ``bytes_limit``."""


class DeviceError(Error, RuntimeError):
    """A GPU that is absent or failed, or an array on another device than it should be."""


class VerifyError(Error, ValueError):
    """A field that does not match its mesh."""


class SignWarning(UserWarning):
    """The sign of a field is not certain, or there is none because the mesh has no inside."""


class SurfaceWarning(UserWarning):
    """Parts of a mesh are too thin for the grid: its surface shows nothing of them."""


# What may be wrong with a mesh among many, whose errors are collected.
OF_A_MESH = (Error, OSError, ValueError, TypeError, MemoryError)


def without_frames(error: Exception) -> Exception:
    """The error without its tracebacks, whose frames would keep all that their callers worked on."""
    for each in (error, error.__cause__, error.__context__):
        if each is not None:
            each.__traceback__ = None
    return error


_CLASSES = {
    "usage": UsageError,
    "input": InputError,
    "output": OutputError,
    "limit": LimitError,
    "device": DeviceError,
    "verify": VerifyError,
    "doubt": DoubtError,
}


def make(
    code: str, message: str, *, triangle: int | None = None, file: str | None = None, **details: int | None
) -> BaseException:
    """The exception for an error of the library; the compiled module calls it."""
    if code == "interrupted":
        return KeyboardInterrupt(message)
    kind = _CLASSES.get(code, Error)
    if kind is InputError and (triangle is not None or file is None):
        kind = MeshError
    error = kind(message)
    for name, value in {"triangle": triangle, "file": file, **details}.items():
        if value is not None:
            setattr(error, name, value)
    return error
