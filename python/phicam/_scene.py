"""Scenes."""

from __future__ import annotations

import os
import tempfile
import types
import warnings
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from . import _native
from ._arrays import Floats, number, whole
from ._toml import toml
from .errors import InputError, Suspicious


def scene_at(value: Any) -> Scene:
    """`value` if it is a Scene."""
    if isinstance(value, Scene):
        return value
    cure = f"phicam.Scene({value!r})" if isinstance(value, (str, os.PathLike)) else "a phicam.Scene"
    raise InputError(f"{value!r} is no Scene\n  cure: give {cure}")


class Scene:
    """A laser, its spots, walls, a hidden surface and a camera.

    Parameters
    ----------
    name : str or path
        Name of a built-in scene (:func:`scenes` lists them), or path of a scene file (TOML). The keys are documented in
        the crate's ``scene::file``; ``phicam scene export bench`` shows a whole scene.
    also_read : paths, optional
        Folders in which the file may name meshes, pictures and materials too; else only in its own and below.

    Raises
    ------
    SceneError
        With file, line, cause and cure.

    Examples
    --------
    >>> import phicam
    >>> scene = phicam.Scene("bench")
    >>> scene
    Scene('bench': 16 × 16 pixels, 120 spots, hidden 'object' 8 × 8)
    >>> scene.spots.shape
    (120, 3)
    """

    __slots__ = ("_core", "_warned")
    _core: _native.Scene
    _warned: bool

    def __init__(self, name: str | os.PathLike[str], *, also_read: Iterable[str | os.PathLike[str]] = ()) -> None:
        self._core = _native.Scene.load(os.fspath(name), [Path(p) for p in also_read])
        self._warned = False

    @classmethod
    def _of(cls, native: _native.Scene) -> Scene:
        scene = cls.__new__(cls)
        scene._core, scene._warned = native, False
        return scene

    @classmethod
    def from_toml(cls, text: str) -> Scene:
        """A scene that is text alone, and names no files.

        >>> import phicam
        >>> phicam.Scene.from_toml(phicam.Scene("bench").text) == phicam.Scene("bench")
        True
        """
        return cls._of(_native.Scene.parse(text))

    @classmethod
    def from_file(
        cls, path: str | os.PathLike[str], *, also_read: Iterable[str | os.PathLike[str]] = ()
    ) -> Scene:
        """The scene in a file, even where the file has the name of a built-in scene.

        >>> import phicam, tempfile, pathlib
        >>> file = pathlib.Path(tempfile.mkdtemp()) / "own.toml"
        >>> _ = file.write_text(phicam.Scene("bench").text)
        >>> phicam.Scene.from_file(file).name
        'bench'
        """
        return cls(os.path.abspath(path), also_read=also_read)

    def replace(self, changes: Mapping[str, Any] | None = None, /, **more: Any) -> Scene:
        """The same scene with other values of some keys of its file.

        Keys are names parted by dots; a surface is named by its name or number: ``camera.pixels``,
        ``laser.spots.per_side``, ``surface.wall.material.lambertian``. Values are numbers, text, booleans, lists and
        dictionaries.

        >>> import phicam
        >>> bench = phicam.Scene("bench")
        >>> bench.replace({"camera.pixels": (8, 4), "laser.power": 2e-3}).pixels
        (8, 4)
        >>> bench.replace(**{"surface.wall.material": {"lambertian": 0.5}}) == bench
        False
        """
        given = {**(changes or {}), **more}
        return self._of(self._core.with_values([(key, toml(value, key)) for key, value in given.items()]))

    def displaced(self, changes: Mapping[str, float] | None = None, /, **more: float) -> Scene:
        """The same scene with its geometry moved: names of parameters (:meth:`parameters`) with degrees, percents or
        lengths in the scene's unit.

        >>> import phicam
        >>> moved = phicam.Scene("bench").displaced({"hinge.angle": 1.0, "spots.x": 0.1})
        >>> moved == phicam.Scene("bench")
        False
        """
        given = {**(changes or {}), **more}
        sizes = [(name, number(size, name, "that is finite", lambda _: True)) for name, size in given.items()]
        return self._of(self._core.displaced(sizes))

    def parameters(self, *names: str) -> dict[str, str]:
        """What of the geometry can be moved below each of `names`, with its unit.

        >>> import phicam
        >>> phicam.Scene("bench").parameters("hinge.angle", "spots.shift")
        {'hinge.angle': 'deg', 'spots.x': 'in', 'spots.y': 'in'}
        """
        return dict(self._core.parameters(list(names)))

    @property
    def name(self) -> str:
        """Its name."""
        return self._core.name

    @property
    def unit(self) -> str:
        """Its length unit."""
        return self._core.unit

    @property
    def text(self) -> str:
        """The scene file that it is."""
        return self._core.text

    @property
    def hash(self) -> str:
        """SHA-256 (hex) of what its light depends on."""
        return self._core.hash

    @property
    def pixels(self) -> tuple[int, int]:
        """Columns and rows of a photograph; pixel p = column + row · columns, row 0 at the view's first edge."""
        return self._core.pixels

    @property
    def shape(self) -> tuple[int, int]:
        """Shape of Φcam: pixels × spots."""
        return self.pixels[0] * self.pixels[1], len(self.spots)

    @property
    def spots(self) -> Floats:
        """Positions of the laser spots, spots × 3, in the scene's unit. One of a scene that shines by itself."""
        return self._core.spots

    @property
    def footprints(self) -> Floats:
        """What the pixels see of the wall: the middles of their footprints, pixels × 3, in the scene's unit."""
        return self._core.footprints

    @property
    def hidden(self) -> dict[str, tuple[int, int]]:
        """The hidden surfaces, each with its elements along u and v."""
        return {name: elements for name, elements, _ in self._core.hidden}

    @property
    def truth(self) -> Floats:
        """True albedo of every element, in the model's order: iu + iv · nu of each hidden surface.

        Raises InputError where the scene does not know it.
        """
        return self._core.truth()

    @property
    def warnings(self) -> list[str]:
        """What is suspicious though not wrong."""
        return self._core.warnings()

    def _warn(self) -> None:
        """Tells once what is suspicious."""
        if not self._warned:
            self._warned = True
            for text in self.warnings:
                warnings.warn(text, Suspicious, stacklevel=3)

    def preview(self, size: tuple[int, int] = (640, 400), *, samples: int = 16) -> Floats:
        """A picture of the scene in ordinary light, for people: rows × columns × 3, from the top, 0 to about 1.

        >>> import phicam
        >>> phicam.Scene("bench").preview((64, 40), samples=1).shape
        (40, 64, 3)
        """
        columns, rows = (whole(n, "size", 1, 8192) for n in size)
        flat = self._core.preview((columns, rows), whole(samples, "samples", 1, 65536))
        return flat.reshape(rows, columns, 3)

    def plot(self, ax: Any = None, *, size: tuple[int, int] = (640, 400)) -> Any:
        """The same picture on Matplotlib's axes `ax`, or on new ones, which are returned.

        >>> import phicam, matplotlib
        >>> matplotlib.use("agg")
        >>> phicam.Scene("bench").plot(size=(64, 40)).get_title()
        'bench'
        """
        if ax is None:
            import matplotlib.pyplot as plt

            _, ax = plt.subplots()
        ax.imshow(np.clip(self.preview(size), 0.0, 1.0) ** (1 / 2.2))
        ax.set_axis_off()
        ax.set_title(self.name)
        return ax

    def mitsuba(self) -> types.ModuleType:
        """A module that renders this scene with Mitsuba 3, which has to be installed and have a variant set.

        ``module.scene(spot)`` is the dictionary for ``mi.load_dict``; ``module.render(spot, spp, seed, max_bounces)`` are
        a column of Φcam, W, and its standard error. Its documentation says how each part is translated. Raises InputError
        for what Mitsuba has not.

        >>> import mitsuba, phicam
        >>> mitsuba.set_variant("llvm_ad_rgb")
        >>> scene = phicam.Scene("bench").replace({"camera.pixels": (4, 4)})
        >>> column, error = scene.mitsuba().render(0, 64, 1, 3)
        >>> column.shape
        (16,)
        """
        module = types.ModuleType("phicam_mitsuba_scene")
        program = self._core.mitsuba_script()
        try:
            exec(compile(program, "<scene for Mitsuba>", "exec"), module.__dict__)
        except SystemExit as error:
            raise ImportError(str(error)) from error
        return module

    def to_mitsuba(self, spot: int = 0) -> dict[str, Any]:
        """The scene while the laser lights `spot`, as a dictionary that ``mitsuba.load_dict`` takes as it is. Call
        ``mitsuba.set_variant`` before. Lengths are scaled to the scene's extent: see :meth:`mitsuba`.

        >>> import mitsuba, phicam
        >>> mitsuba.set_variant("llvm_ad_rgb")
        >>> type(mitsuba.load_dict(phicam.Scene("bench").to_mitsuba(spot=3))).__name__
        'Scene'
        """
        if not 0 <= spot < self.shape[1]:
            raise InputError(f"spot is {spot}\n  cure: there are spots 0 to {self.shape[1] - 1}")
        found: dict[str, Any] = self.mitsuba().scene(spot)
        return found

    def __repr__(self) -> str:
        (columns, rows), spots = self.pixels, self.shape[1]
        hidden = ", ".join(f"{name!r} {nu} × {nv}" for name, (nu, nv) in self.hidden.items())
        return f"Scene({self.name!r}: {columns} × {rows} pixels, {spots} spots, hidden {hidden or 'nothing'})"

    def _repr_html_(self) -> str:
        return self._core.svg()

    def __eq__(self, other: object) -> bool:
        """Whether the light of both is the same."""
        return isinstance(other, Scene) and self.hash == other.hash

    def __hash__(self) -> int:
        return hash(self.hash)

    def __reduce__(self) -> tuple[Any, ...]:
        return _restored, (self.text, self._core.files())


def _restored(text: str, files: list[tuple[str, bytes]]) -> Scene:
    """A scene that was pickled, with the files that it names."""
    if not files:
        return Scene.from_toml(text)
    # Kept as long as the process lives: a scene reads its files again where one of its keys is replaced.
    folder = Path(tempfile.mkdtemp(prefix="phicam-"))
    (folder / "files").mkdir()
    for name, content in files:
        (folder / "files" / Path(name).name).write_bytes(content)
    (folder / "scene.toml").write_text(text, encoding="utf-8")
    return Scene(folder / "scene.toml")


def scenes() -> dict[str, str]:
    """The built-in scenes, each with what it is.

    >>> import phicam
    >>> "bench" in phicam.scenes()
    True
    """
    return dict(_native.builtins())
