"""The exceptions of slcal. They can be pickled, and carry their numbers as attributes."""

from __future__ import annotations

from typing import Any


class Error(ValueError):
    """Base of all errors of slcal: a value, a file or a photograph is not usable.

    The message says what was expected, what was found and what to do. The same is in attributes; those that do not apply
    to an error are None.

    Attributes
    ----------
    what : str or None
        What is wrong, not found or not determined.
    expected, found : str or None
        The accepted values, and the given one.
    seen, advice : str or None
        What was found instead, and what to do about it.
    measure, limit : float or None
        The number that shows that the geometry does not determine the answer, and its limit.
    device : str or None
        "camera" or "projector", whose focal length is imaginary.
    f_squared : float or None
        The negative square of that focal length, px².
    detail : str or None
        Where and how a file violates its schema.
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
    error.__dict__.update(fields)  # Including its notes.
    return error


class DetectionError(Error):
    """The sheet or the checkerboard is not found in the photograph."""


class CalibrationError(Error):
    """The photographs do not determine the rig."""


class DecodeError(Error):
    """The stripes are not found in the photograph, or are not those of the pattern."""


class FormatError(Error):
    """A file or a text does not follow its schema."""
