"""What can go wrong: cause and cure."""

from __future__ import annotations

import re

_OPTION = re.compile(r"--([a-z]+(?:-[a-z]+)*)(?: (?:FILE|RELATIVE|COLUMNSxROWS|DIR|NUMBER)\b)?")

__all__ = ["Error", "FileError", "InputError", "InternalError", "SceneError", "Stopped", "Suspicious"]


class Error(Exception):
    """Any error of phicam. Its text says what is wrong and, after ``cure:``, what to do.

    >>> import phicam
    >>> try:
    ...     phicam.Scene("bench").replace(**{"camera.pixels": (0, 8)})
    ... except phicam.Error as error:
    ...     print("cure:" in str(error))
    True
    """

    @property
    def cause(self) -> str:
        """What is wrong."""
        return str(self).partition("\n  cure: ")[0]

    @property
    def cure(self) -> str:
        """What to do about it; empty where the cause says so itself."""
        return str(self).partition("\n  cure: ")[2]


class InputError(Error, ValueError):
    """What was given has no meaning: a shape, a number that is not finite, a name, a setting."""


class SceneError(InputError):
    """A scene that cannot be used, with its line."""


class FileError(Error, OSError):
    """A file or folder that cannot be read or written, or is not what it should be."""


class Stopped(Error):
    """A computation was stopped before it was finished."""


class InternalError(Error, RuntimeError):
    """A fault of phicam itself."""


class Suspicious(UserWarning):
    """Something that is no error, and that a result may suffer from."""


def in_python(text: str) -> str:
    """A message of the command with its options as the keywords that they are here: `--free-scale` is `free_scale`."""
    return _OPTION.sub(lambda found: found.group(1).replace("-", "_"), text)
