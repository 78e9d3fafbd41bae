"""Photographs of a real camera."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from . import _native
from ._arrays import threads_of
from ._phi import Phi
from ._scene import Scene
from ._toml import toml
from .errors import FileError, InputError


def import_photographs(
    photographs: str | os.PathLike[str] | Mapping[str, Any],
    scene: Scene | None = None,
    *,
    folder: str | os.PathLike[str] | None = None,
    channel: str | None = None,
    threads: int | None = None,
) -> Phi:
    """Φcam of photographs from a real camera, as ``phicam import`` makes it.

    Parameters
    ----------
    photographs : path, or dict
        A list in TOML, or the same keys as a dictionary: ``{"frames": "input_*.png", "dark": "dark.png", …}``. PNG, TIFF,
        JPEG, OpenEXR, NPY and MAT files. The keys are documented in the crate's ``photographs::set``.
    scene : Scene, optional
        Where they were taken; the list's ``scene`` unless given.
    folder : path, optional
        Where the files are: the list's own folder, or the current one, unless given.
    channel : str, optional
        red, green, blue or mean, of photographs in colour.

    Returns
    -------
    Phi
        In W where the list says how many a count is, else in counts, or counts per second where exposure times are known;
        a pixel of the scene has the sum of the photograph's pixels within it. ``account`` says how it came about.

    >>> import numpy, phicam, pathlib, tempfile
    >>> scene = phicam.Scene("bench").replace({"laser.spots.per_side": 2, "camera.pixels": (4, 4)})
    >>> folder = pathlib.Path(tempfile.mkdtemp())
    >>> for spot in range(8):
    ...     numpy.save(folder / f"frame-{spot}.npy", numpy.full((8, 8), 100 + spot, dtype=numpy.uint16))
    >>> phi = phicam.import_photographs({"frames": "frame-*.npy"}, scene, folder=folder)
    >>> phi.flux.mean(axis=0).tolist()
    [400.0, 404.0, 408.0, 412.0, 416.0, 420.0, 424.0, 428.0]
    """
    if isinstance(photographs, Mapping):
        given: dict[str, Any] = {str(key): value for key, value in photographs.items()}
        text = "\n".join(f"{json.dumps(key)} = {toml(value, key)}" for key, value in given.items())
        beside = Path(".")
        named = str(given.get("scene", ""))
    else:
        path = Path(photographs)
        try:
            text = path.read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as error:
            raise FileError(f"cannot read {path}: {error}\n  cure: give a list of photographs in TOML") from error
        beside, named = path.parent, _named(text)
    if scene is None:
        if not named:
            raise InputError("nothing says of which scene the photographs are\n  cure: give scene=, or `scene` in the list")
        own = beside / named
        scene = Scene(own if own.exists() else named)
    where = beside if folder is None else Path(folder)
    found, used = _native.import_photographs(scene._core, text, where, channel, threads=threads_of(threads))
    return Phi(
        Scene._of(used),
        found["flux"],
        found["stderr"],
        left_out=found["left_out"],
        account=json.loads(found["json"]),
    )


def _named(text: str) -> str:
    """The scene that a list names."""
    return _native.scene_named(text)
