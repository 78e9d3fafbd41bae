"""Target pictures that are built in."""

from __future__ import annotations

import numpy as np

from . import _native
from ._arrays import Floats, pair


def targets() -> dict[str, str]:
    """The built-in target pictures, each with what it shows.

    >>> import phicam
    >>> "siemens" in phicam.targets()
    True
    """
    return dict(_native.targets())


def target(name: str, size: tuple[int, int] | int | None = None) -> Floats:
    """A target picture as linear reflectances 0 to 1, rows × columns, row 0 the uppermost, as ``phicam target`` draws it.

    Parameters
    ----------
    name : str
        One of :func:`targets`.
    size : (int, int)
        Columns and rows; its own unless given.

    >>> import phicam
    >>> phicam.target("edge", (8, 4)).shape
    (4, 8)
    """
    values, (columns, rows) = _native.target(name, pair(size, "size"))
    return np.asarray(values).reshape(rows, columns)
