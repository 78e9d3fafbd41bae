"""Arrays as they come from users."""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from .errors import InputError

Floats = NDArray[np.float64]


def _real(value: ArrayLike, name: str) -> NDArray[Any]:
    """`value` as an array of real numbers, without a copy where it is one."""
    try:
        array = np.asarray(value)
    except (TypeError, ValueError, RuntimeError) as error:
        raise InputError(f"{name} is no array: {error}\n  cure: give numbers in rows of one length") from error
    if array.dtype.kind not in "fiub":
        raise InputError(f"{name} holds {array.dtype}\n  cure: give real numbers")
    return array


def matrix(value: ArrayLike, name: str) -> NDArray[Any]:
    """`value` as an array of two dimensions of float64 or float32, without a copy where it is one. One of one dimension
    is one column: a single photograph."""
    if isinstance(value, np.ma.MaskedArray):
        raise InputError(f"{name} is a masked array\n  cure: give its data, and its mask as left_out=")
    array = _real(value, name)
    if array.ndim == 1:
        array = array[:, np.newaxis]
    if array.ndim != 2:
        cure = "reshape it to pixels × spots, pixel = column + row · columns"
        raise InputError(f"{name} has {array.ndim} dimensions\n  cure: {cure}")
    if array.size == 0:
        raise InputError(f"{name} is empty: {array.shape}\n  cure: give at least one entry")
    if array.dtype not in (np.dtype("=f8"), np.dtype("=f4")) or not array.flags.aligned:
        array = array.astype(np.float64)
    return array


def maybe(value: ArrayLike | None, name: str) -> NDArray[Any] | None:
    """The same where there may be none."""
    return None if value is None else matrix(value, name)


def shaped(array: NDArray[Any], shape: tuple[int, int], name: str) -> NDArray[Any]:
    """`array` if it has this shape."""
    if array.shape == shape:
        return array
    rows, columns = array.shape
    raise InputError(
        f"{name} is {rows} × {columns}, and {shape[0]} × {shape[1]} are expected\n  cure: give pixels × spots"
    )


def vector(value: ArrayLike, name: str) -> Floats:
    """Finite numbers in one row."""
    flat = np.ascontiguousarray(_real(value, name), dtype=np.float64).reshape(-1)
    if not np.isfinite(flat).all():
        raise InputError(f"{name} has an entry that is not finite\n  cure: give finite numbers")
    return flat


def pair(value: Any, name: str) -> tuple[int, int] | None:
    """Two whole numbers from 1 on, or None; one number stands for both."""
    if value is None:
        return None
    try:
        given: list[Any] = [value, value] if np.ndim(value) == 0 else list(value)
        first, second = (int(x) for x in given)
        exact = given == [first, second] and not any(isinstance(x, (bool, np.bool_)) for x in given)
    except (TypeError, ValueError) as error:
        raise InputError(f"{name} is {value!r}\n  cure: give two whole numbers, e.g. (8, 8)") from error
    if not exact or first < 1 or second < 1:
        raise InputError(f"{name} is {value!r}\n  cure: give two whole numbers from 1 on, e.g. (8, 8)")
    return first, second


def whole(value: Any, name: str, least: int = 0, most: int = 2**64 - 1) -> int:
    """A whole number in a range."""
    try:
        number = int(value)
        exact = not isinstance(value, bool) and number == value
    except (TypeError, ValueError, OverflowError) as error:
        raise InputError(f"{name} is {value!r}\n  cure: give a whole number") from error
    if not exact or not least <= number <= most:
        raise InputError(f"{name} is {value!r}\n  cure: give a whole number, {least} to {most}")
    return number


def flag(value: Any, name: str) -> bool:
    """True or False; no other value, of which "no" would be true."""
    if type(value) in (bool, np.bool_):
        return bool(value)
    raise InputError(f"{name} is {value!r}\n  cure: give True or False")


def threads_of(value: Any) -> int | None:
    """How many threads work; None: all cores."""
    return None if value is None else whole(value, "threads", 1, 4096)


def spread(value: ArrayLike, shape: tuple[int, int], name: str) -> NDArray[Any]:
    """`value` as an array of this shape; one number stands for every entry."""
    if np.ndim(value) == 0:
        value = np.full(shape, number(value, name, "from 0 on", lambda x: x >= 0))
    return shaped(matrix(value, name), shape, name)


def without(array: NDArray[Any], flags: NDArray[Any] | None) -> NDArray[Any]:
    """`array` with 0 where `flags` say that it does not count, so that NaN is no matter there."""
    if flags is None or flags.shape != array.shape or np.isfinite(array).all():
        return array
    found: NDArray[Any] = np.where(flags != 0, 0.0, array)
    return found


def chosen(value: Any, name: str, count: int) -> list[tuple[int, int]]:
    """Which of `count` things an index, a slice or indices name, as runs first..end of neighbours."""
    all_of = range(count)
    try:
        if isinstance(value, slice):
            found = list(all_of[value])
        elif np.ndim(value) == 0:
            found = [all_of[operator.index(value)]]
        else:
            found = sorted({all_of[operator.index(k)] for k in value})
    except (TypeError, ValueError, IndexError) as error:
        raise InputError(f"{name} is {value!r}\n  cure: give an index, a slice or indices of 0 to {count - 1}") from error
    if not found:
        raise InputError(f"{name} is {value!r}, which names none\n  cure: give an index, a slice or indices of 0 to {count - 1}")
    found.sort()
    starts = [k for k in found if k - 1 not in found]
    ends = [k + 1 for k in found if k + 1 not in found]
    return list(zip(starts, ends))


def number(value: Any, name: str, fine: str, holds: Callable[[float], bool]) -> float:
    """A finite number for which `holds`; `fine` says in words which."""
    try:
        found = float(value)
    except (TypeError, ValueError) as error:
        raise InputError(f"{name} is {value!r}\n  cure: give a number {fine}") from error
    if not np.isfinite(found) or not holds(found):
        raise InputError(f"{name} is {value!r}\n  cure: give a number {fine}")
    return found


def setting(value: Any, name: str) -> float | None:
    """A number of the range that the setting of that name has, or None."""
    if value is None:
        return None
    return number(value, name, _native.setting_range(name), lambda x: _native.setting_allows(name, x))
