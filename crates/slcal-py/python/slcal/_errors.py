"""What can go wrong, as exceptions that can be caught, pickled and asked for their numbers."""

from __future__ import annotations

from typing import Any


class Error(ValueError):
    """Base of all errors of slcal: a value, a file or a photograph is not what an operation needs.

    The message says what was expected, what was found and what to do. The numbers behind it are attributes; those that
    do not belong to an error are None.

    Attributes
    ----------
    what : str or None
        What is wrong, was not found or is not determined.
    expected, found : str or None
        What values are accepted, and what was given.
    seen, advice : str or None
        What was seen instead of the thing that was looked for, and what to do about it.
    measure, limit : float or None
        The number that shows that the geometry does not determine the answer, and the limit that it missed.
    device : str or None
        "camera" or "projector", where the focal length of one is imaginary.
    f_squared : float or None
        The negative square of that focal length, px².
    detail : str or None
        Where and how a file departs from its schema.
    """

    what: str | None = None
    expected: str | None = None
    found: str | None = None
    seen: str | None = None
    advice: str | None = None
    measure: float | None = None
    limit: float | None = None
    device: str | None = None
    f_squared: float | None = None
    detail: str | None = None

    def __init__(self, message: str = "", /, **fields: Any) -> None:
        super().__init__(message)
        for name, value in fields.items():
            if not hasattr(Error, name):
                raise TypeError(f"{type(self).__name__} has no field {name!r}")
            setattr(self, name, value)

    def __reduce__(self) -> tuple[Any, ...]:
        return _again, (type(self), str(self), dict(self.__dict__))


def _again(kind: type[Error], message: str, fields: dict[str, Any]) -> Error:
    error = kind(message)
    error.__dict__.update(fields)  # With the notes that were added to it.
    return error


class DetectionError(Error):
    """The sheet or the checkerboard is not in the photograph."""


class CalibrationError(Error):
    """The photographs do not determine the rig."""


class DecodeError(Error):
    """The stripes are not in the photograph, or are not those of the pattern."""


class FormatError(Error):
    """A file or a text is not what its schema says."""
