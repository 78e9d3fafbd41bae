"""Values as TOML."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any, cast

import numpy as np

from .errors import InputError


def toml(value: Any, key: str) -> str:
    """`value` as TOML writes it; `key` names it in errors."""
    if isinstance(value, (np.ndarray, np.generic)):
        return toml(cast("Any", value).tolist(), key)
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float):
        text = repr(value)
        return text if value == value and abs(value) != float("inf") else text.replace("-nan", "nan")
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, Mapping):
        table: Mapping[Any, Any] = value  # pyright: ignore[reportUnknownVariableType]
        pairs = (f"{json.dumps(str(k))} = {toml(v, f'{key}.{k}')}" for k, v in table.items())
        return "{ " + ", ".join(pairs) + " }"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(toml(v, key) for v in cast("list[Any]", value)) + "]"
    raise InputError(f"{key} is {value!r}\n  cure: give a number, text, True or False, a list or a dictionary")
