"""Experiments around a scene."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, cast

import numpy as np

from . import _native
from ._arrays import threads_of
from ._finding import Finding
from ._progress import Progress, told
from ._scene import Scene
from .errors import InputError


class Study(Finding):
    """What a study found."""

    def __init__(self, found: dict[str, Any], agrees: bool) -> None:
        super().__init__(found)
        #: Whether traced and modelled agree, where that is what the study asks.
        self.agrees = agrees


def study(
    name: str,
    scene: Scene | None = None,
    *,
    threads: int | None = None,
    progress: Progress = False,
    **options: Any,
) -> Study:
    """Runs a study, as ``phicam study NAME`` does.

    Parameters
    ----------
    name : str
        One of :func:`studies`: ``budget``, ``noise``, ``tolerance``, ``layout``, ``occluder``, …
    scene : Scene, optional
        What is studied; the study's own scene unless given.
    options
        Those of the command, with _ in place of -, lists for several values; ``print(phicam.options(name))`` lists them.

    >>> import phicam
    >>> scene = phicam.Scene("bench").replace({"laser.spots.per_side": 2, "camera.pixels": (4, 4)})
    >>> found = phicam.study("convergence", scene, samples=[64, 256])
    >>> found.tables[0].keys() >= {"estimator"}
    True
    """
    described = {study_name: (default, known) for study_name, _, default, known in _native.studies()}
    if name not in described:
        raise InputError(f"there is no study {name!r}\n  cure: use one of {', '.join(described)}")
    default, known = described[name]
    if scene is None and default is None:
        raise InputError(f"study {name} needs a scene\n  cure: give one: phicam.Scene(…)")
    names = {option[0]: option for option in known}
    given: list[tuple[str, list[str]]] = []
    for key, value in options.items():
        option = key.replace("_", "-")
        if option not in names:
            raise InputError(f"study {name} has no option {key}\n  cure: use one of {', '.join(sorted(names))}")
        values = _spelled(value, key)
        if len(values) > 1 and not names[option][4]:
            raise InputError(f"option {key} takes one value\n  cure: give one of {value!r}")
        given.append((option, values))
    subject = scene if scene is not None else Scene(default or "bench")
    report = told(f"study {name}", progress)
    found, agrees = _native.study(name, subject._core, given, threads=threads_of(threads), progress=report)
    return Study(found, agrees)


def _spelled(value: Any, key: str) -> list[str]:
    """Values as a command line spells them."""
    if value is None:
        return []
    if isinstance(value, (np.ndarray, np.generic)):
        return _spelled(cast("Any", value).tolist(), key)
    alone = isinstance(value, (str, bytes)) or not isinstance(value, Iterable)
    each: list[Any] = [value] if alone else list(cast("Iterable[Any]", value))
    if any(isinstance(x, (dict, list, tuple, bool)) or x is None for x in each):
        raise InputError(f"option {key} is {value!r}\n  cure: give numbers or names")
    return [x if isinstance(x, str) else repr(np.asarray(x).item()) for x in each]


def studies() -> dict[str, str]:
    """Every study, with what it asks.

    >>> import phicam
    >>> "layout" in phicam.studies()
    True
    """
    return {name: about for name, about, _, _ in _native.studies()}


def options(name: str) -> dict[str, str]:
    """The options of a study, each with what it sets and its default.

    >>> import phicam
    >>> "samples" in phicam.options("convergence")
    True
    """
    for study_name, _, _, known in _native.studies():
        if study_name == name:
            return {
                option.replace("-", "_"): help_text + ("" if default is None else f" [{default}]")
                for option, help_text, _, default, _ in known
            }
    raise InputError(f"there is no study {name!r}\n  cure: use one of {', '.join(studies())}")
