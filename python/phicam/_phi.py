"""Φcam: one photograph for each laser spot."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from . import _html, _native
from ._arrays import Floats, chosen, matrix, shaped, threads_of, whole
from ._progress import Progress, told
from ._scene import Scene, scene_at
from .errors import InputError

Estimator = Literal["independent", "shared", "factored"]
Sampler = Literal["sobol", "pcg"]

#: How the errors of the entries hang together, by estimator.
ERRORS = {"independent": "independent", "shared": "pixel", "factored": "all"}


class Phi:
    """Φcam with its standard errors, pixels × spots, W (of photographs whose scale is unknown in counts).

    Made by :func:`render`, :func:`load` and :func:`import_photographs`, or of arrays: ``Phi(scene, flux, stderr)``, pixels ×
    spots or rows × columns × spots, as :meth:`to_xarray` gives them.

    Attributes
    ----------
    scene : Scene
        Where it is from.
    flux : ndarray, pixels × spots
        Φcam, W; pixel p = column + row · columns.
    stderr : ndarray, pixels × spots, or None
        Standard error of each entry; None where nothing is known of the noise.
    left_out : ndarray, pixels × spots, or None
        Not 0 where an entry does not count: of a render where its standard error is not to be trusted (``tails``), of
        photographs why it is left out.
    by_bounces : tuple of ndarrays, or None
        Light that met exactly 1, 2, … surfaces; its sum is `flux`. Of a run that was loaded float32, as its frames are. None
        of photographs, and where there are no frames.
    settings : dict
        Estimator, sampler, seed, samples, blocks, seconds of a render.

    >>> import phicam, numpy
    >>> scene = phicam.Scene("bench").replace({"laser.spots.per_side": 2, "camera.pixels": (4, 3)})
    >>> flux = phicam.model(scene).phi()
    >>> phicam.Phi(scene, flux, stderr=0.01 * flux)
    Phi(12 pixels × 8 spots of 'bench')
    """

    def __init__(
        self,
        scene: Scene,
        flux: ArrayLike,
        stderr: ArrayLike | None = None,
        *,
        left_out: ArrayLike | None = None,
        by_bounces: Iterable[ArrayLike] | None = None,
        settings: Mapping[str, Any] | None = None,
        account: Mapping[str, Any] | None = None,
    ) -> None:
        scene_at(scene)

        def whole_of(array: Any, name: str) -> Any:
            return None if array is None else shaped(array, scene.shape, name)

        def stacked(array: ArrayLike) -> ArrayLike:
            columns, rows = scene.pixels
            if np.shape(array) != (rows, columns, scene.shape[1]):
                return array
            found: ArrayLike = np.asarray(array).reshape(scene.shape)
            return found

        self.scene = scene
        self.flux: Any = whole_of(matrix(stacked(flux), "flux"), "flux")
        self.stderr: Any = whole_of(None if stderr is None else matrix(stacked(stderr), "stderr"), "stderr")
        self.left_out: Any = whole_of(None if left_out is None else matrix(stacked(left_out), "left_out"), "left_out")
        parts = None if by_bounces is None else tuple(matrix(part, "by_bounces") for part in by_bounces)
        self.by_bounces: tuple[Any, ...] | None = parts
        self.settings: dict[str, Any] = dict(settings or {})
        # What was rendered, so that nothing else is written as a render.
        self._rendered: str | None = self._digest() if self.is_rendered else None
        #: Of :func:`phicam.expose`: 1 where an entry is saturated, −1 where it was cut off below, 0.5 near the upper end.
        self.clipped: Any = None
        #: How photographs were imported; empty of a render.
        self.account: dict[str, Any] = dict(account or {})

    @property
    def is_rendered(self) -> bool:
        """Whether its standard errors are those of a render, estimated from so many blocks."""
        return "blocks" in self.settings

    @property
    def shape(self) -> tuple[int, int]:
        """Pixels and spots."""
        return self.flux.shape  # type: ignore[no-any-return]

    @property
    def common(self) -> float:
        """Of photographs: the part of the variance that is that of the dark frames, which all spots of a pixel share."""
        return float(self.account.get("common") or 0.0)

    @property
    def frame_gain(self) -> float | None:
        """Of photographs: the largest relative error of a gain, which all pixels of a frame share; None where gains are exact.

        Recovery, verdict and calibration take it where they are not told another; standard errors leave it out.
        """
        errors = [error / gain for _, gain, error in self.account.get("gains") or ()]
        largest = max(errors, default=0.0)
        return largest if largest > 0.0 else self.account.get("frame_gain")

    def _digest(self) -> str:
        """Of flux and errors."""
        digest = hashlib.blake2b(digest_size=16)
        for array in (self.flux, self.stderr):
            if array is not None:
                digest.update(array.T.tobytes())
        return digest.hexdigest()

    @property
    def replicates(self) -> int | None:
        """Blocks that the standard errors were estimated from; None where they are taken as known."""
        return self.settings.get("blocks")

    @property
    def errors(self) -> str:
        """How the errors of the entries hang together: independent, pixel (those of one pixel), all.

        Those of photographs whose dark frames serve every spot hang together by pixel.
        """
        shared = self.account.get("shares_by_pixel") or _native.shares_by_pixel(self.common, self.flux.shape[1])
        if shared and not self.is_rendered:
            return "pixel"
        return ERRORS.get(self.settings.get("estimator", ""), "independent")

    @property
    def noise_unknown(self) -> float:
        """Of photographs: variance of their variances over the squares of these, which all share; how well repeats tell the noise.

        0 where the noise was given, and of a render. Recovery, verdict and calibration test a fit with it.
        """
        return float(self.account.get("noise_unknown") or self.account.get("unknown") or 0.0)

    def _known(self, background: bool) -> tuple[str, int | None, float]:
        """What is known of its errors: how they hang together, replicates, :attr:`noise_unknown`.

        A background takes what all spots of a pixel of photographs share.
        """
        absorbed = background and not self.is_rendered
        return ("independent" if absorbed else self.errors), self.replicates, self.noise_unknown

    @property
    def unit(self) -> str:
        """Of `flux` and `stderr`: W, or counts (or counts/s) of photographs whose scale is unknown."""
        return str(self.account.get("unit", "W"))

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Any:
        """The flux: ``numpy.asarray(phi)`` is ``phi.flux``."""
        if copy is None:
            return np.asarray(self.flux, dtype)
        return np.array(self.flux, dtype, copy=copy)

    def frame(self, spot: int) -> Floats:
        """The photograph of a spot, rows × columns, W; row 0 is the lowest: ``imshow(…, origin="lower")``.

        >>> import phicam
        >>> phicam.render(phicam.Scene("bench").replace({"laser.spots.per_side": 2}), samples=32).frame(0).shape
        (16, 16)
        """
        if not -self.flux.shape[1] <= spot < self.flux.shape[1]:
            raise InputError(f"spot is {spot}\n  cure: there are spots 0 to {self.flux.shape[1] - 1}")
        columns, rows = self.scene.pixels
        found: Floats = self.flux[:, spot].reshape(rows, columns)
        return found

    def to_xarray(self) -> Any:
        """An ``xarray.Dataset`` of flux and stderr over (row, column, spot), with positions and units.

        >>> import phicam
        >>> phicam.render(phicam.Scene("bench").replace({"laser.spots.per_side": 2}), samples=32).to_xarray().flux.dims
        ('row', 'column', 'spot')
        """
        import xarray

        columns, rows = self.scene.pixels
        shape = (rows, columns, self.flux.shape[1])
        unit = {"units": self.unit}
        data: dict[str, Any] = {"flux": (("row", "column", "spot"), self.flux.reshape(shape), unit)}
        if self.stderr is not None:
            data["stderr"] = (("row", "column", "spot"), self.stderr.reshape(shape), unit)
        if self.left_out is not None:
            data["left_out"] = (("row", "column", "spot"), self.left_out.reshape(shape), {})
        places, spots = self.scene.footprints.reshape(rows, columns, 3), self.scene.spots
        length = {"units": self.scene.unit}
        coords: dict[str, Any] = {f"pixel_{name}": (("row", "column"), places[..., k], length) for k, name in enumerate("xyz")}
        coords |= {f"spot_{name}": (("spot",), spots[:, k], length) for k, name in enumerate("xyz")}
        return xarray.Dataset(data, coords, {"scene": self.scene.name, "hash": self.scene.hash, **self.settings})

    def save(self, folder: str | os.PathLike[str]) -> None:
        """Writes a render into `folder`, which is made, or is empty, as ``phicam render`` does: every command reads it.

        Raises FileError where the folder holds anything, and InputError of what was not rendered here whole.

        >>> import phicam, tempfile
        >>> folder = tempfile.mkdtemp()
        >>> phi = phicam.render(phicam.Scene("bench").replace({"laser.spots.per_side": 2}), samples=32)
        >>> phi.save(folder)
        >>> bool((phicam.load(folder).flux == phi.flux).all())
        True
        """
        if self.by_bounces is None or self.stderr is None or not self.is_rendered or "spots" in self.settings:
            raise InputError(
                "only a whole render can be written as a run\n  cure: numpy.save(…, phi.flux), and phi.stderr beside it"
            )
        if self._digest() != self._rendered:
            raise InputError(
                "flux or stderr is not what was rendered any more, and would be taken for it\n  cure: numpy.save(…, phi.flux); "
                "Phi(scene, flux, stderr) holds arrays of one's own"
            )
        if any(part.dtype != np.float64 for part in self.by_bounces):
            raise InputError("by_bounces is float32, as of a run that was loaded\n  cure: copy the folder of that run")
        own = self.settings
        _native.write_run(
            Path(folder),
            self.scene._core,
            self.flux,
            self.stderr,
            np.zeros_like(self.flux) if self.left_out is None else self.left_out,
            list(self.by_bounces),
            estimator=own["estimator"],
            sampler=own["sampler"],
            seed=own["seed"],
            samples=own["samples"],
            seconds=own["seconds"],
            threads=own["threads"],
        )

    def refuse_unscaled(self, cure: str) -> None:
        """Raises InputError, with this cure before its own, of photographs in counts where those in W are asked for.

        >>> import phicam, numpy
        >>> scene = phicam.Scene("bench").replace({"laser.spots.per_side": 2, "camera.pixels": (4, 4)})
        >>> phi = phicam.Phi(scene, numpy.ones((16, 8)), account={"unit": "counts"})
        >>> try:
        ...     phi.refuse_unscaled("wait, or")
        ... except phicam.InputError as error:
        ...     error.cure
        'wait, or import them with `watts`, what one of these is in W'
        """
        if self.unit != "W":
            raise InputError(
                f"the photographs are in {self.unit}, not in W, so their size says nothing of reflectances\n  cure: {cure} "
                "import them with `watts`, what one of these is in W"
            )

    def refuse_clipped(self) -> None:
        """Raises InputError where entries are saturated or cut off: neither they nor their standard errors mean
        anything.

        >>> import phicam, numpy
        >>> phi = phicam.render(phicam.Scene("bench").replace({"laser.spots.per_side": 2}), samples=32)
        >>> phi.clipped = numpy.eye(256, 8)
        >>> try:
        ...     phi.refuse_clipped()
        ... except phicam.InputError as error:
        ...     error.cause[:41]
        '8 of 2048 entries are saturated or cut of'
        """
        marked = 0 if self.clipped is None else int((np.abs(self.clipped) >= 1).sum())
        if marked:
            raise InputError(
                f"{marked} of {self.flux.size} entries are saturated or cut off: neither their values nor their standard "
                "errors mean anything\n  cure: expose for a shorter time or in brackets; left_out=phi.clipped leaves them "
                "out of the joint methods"
            )

    def __repr__(self) -> str:
        pixels, spots = self.flux.shape
        own = ", ".join(f"{key} {self.settings[key]}" for key in ("estimator", "samples", "seed") if key in self.settings)
        return f"Phi({pixels} pixels × {spots} spots of {self.scene.name!r}{': ' + own if own else ''})"

    def _repr_html_(self) -> str:
        columns, rows = self.scene.pixels
        axes, width = ("x", "y"), 2.0
        panels = [("mean of all spots", self.flux.mean(axis=1), axes), ("spot 0", self.flux[:, 0], axes)]
        if self.stderr is not None:
            panels.append(("its standard error", self.stderr[:, 0], axes))
        drawn = [(name, np.asarray(v, dtype=float).reshape(rows, columns), a, width) for name, v, a in panels]
        return _html.sentence(repr(self)) + _html.gallery("", self.unit, drawn)


def render(
    scene: Scene,
    *,
    samples: int | None = None,
    estimator: Estimator | None = None,
    sampler: Sampler = "sobol",
    seed: int = 1,
    spots: int | slice | Iterable[int] | None = None,
    threads: int | None = None,
    progress: Progress = False,
) -> Phi:
    """Traces Φcam of every spot, or of some: the same bytes as ``phicam render``.

    Parameters
    ----------
    scene : Scene
    samples : int, optional
        Paths per pixel and spot (``independent``), paths per pixel (``shared``) or points between the walls
        (``factored``), rounded up to whole blocks; 512 where only the estimator is given.
    estimator : str, optional
        What paths have in common: ``independent`` errors are independent; ``shared`` paths of a pixel serve all spots;
        ``factored`` points serve all pixels and spots. All are unbiased. ``independent`` where only the samples are
        given. Given neither, it is ``factored`` or ``shared`` where other surfaces than the hidden reflect between the
        walls, with as many samples as a pilot says make the overall standard error 1 %, else ``independent``.
    sampler : str
        ``sobol``: Owen-scrambled Sobol' points; ``pcg``: independent random numbers.
    seed : int
        The same seed gives the same bytes, whatever the threads.
    spots : int, slice or iterable of int, optional
        The spots that are traced; all unless given. The columns of the others are 0 and in `left_out`, so that
        :func:`validate` and :func:`recover` pass over them. Each column is the one that it has with all spots.
    threads : int, optional
        All cores unless given.
    progress : bool or function of (done, of)
        A line on standard error, or a call from the calling thread.

    Returns
    -------
    Phi
        W, absolute.

    Examples
    --------
    >>> import phicam
    >>> scene = phicam.Scene("bench").replace({"laser.spots.per_side": 2})
    >>> some = phicam.render(scene, samples=64, spots=[0, 5])
    >>> some.left_out.all(axis=0).tolist()
    [False, True, True, True, True, False, True, True]
    >>> phi = phicam.render(scene, samples=64, estimator="shared")
    >>> phi
    Phi(256 pixels × 8 spots of 'bench': estimator shared, samples 64, seed 1)
    >>> bool((phi.stderr < 0.2 * phi.flux.max()).all())
    True
    """
    all_spots = scene_at(scene).shape[1]
    if samples is None and estimator is None:
        estimator, samples = _native.aimed(scene._core, sampler=sampler, seed=whole(seed, "seed"))
    estimator = "independent" if estimator is None else estimator
    count = whole(512 if samples is None else samples, "samples", 1, 2**32)
    runs = [(0, all_spots)] if spots is None else chosen(spots, "spots", all_spots)
    paths = count if estimator == "factored" else count * scene.shape[0]
    each = [paths * (end - first if estimator == "independent" else 1) for first, end in runs]
    scene._warn()
    tells = told(f"render {scene.name}", progress, sum(each))
    parts: list[dict[str, Any]] = []
    for run, done in zip(runs, each):
        part = _native.render(
            scene._core,
            estimator=estimator,
            sampler=sampler,
            seed=whole(seed, "seed"),
            samples=count,
            spots=run,
            threads=threads_of(threads),
            progress=tells,
        )
        parts.append(part)
        if tells:
            tells.before += done
    settings: dict[str, Any] = {
        "estimator": estimator,
        "sampler": sampler,
        "seed": int(seed),
        "samples": parts[0]["samples"],
        "blocks": parts[0]["blocks"],
        "seconds": sum(part["seconds"] for part in parts),
        "threads": threads or os.cpu_count() or 1,
    }

    def whole_of(arrays: list[Any], rest: float = 0.0) -> Any:
        if runs == [(0, all_spots)]:
            return arrays[0]
        found = np.full(scene.shape, rest, order="F")
        for (first, end), columns in zip(runs, arrays):
            found[:, first:end] = columns
        return found

    return Phi(
        scene,
        whole_of([part["flux"] for part in parts]),
        whole_of([part["stderr"] for part in parts]),
        left_out=whole_of([part["tails"] for part in parts], 1.0),
        by_bounces=[
            whole_of([part["bounces"][k] for part in parts]) for k in range(len(parts[0]["bounces"]))
        ],
        settings=settings if spots is None else {**settings, "spots": [k for run in runs for k in range(*run)]},
    )


def load(folder: str | os.PathLike[str], *, also_read: Iterable[str | os.PathLike[str]] = ()) -> Phi:
    """The run or import in `folder`, as ``phicam render``, ``run``, ``import`` or :meth:`Phi.save` wrote it.

    Raises FileError where it is no run, unfinished, or not what was written.

    >>> import phicam
    >>> try:
    ...     phicam.load("nowhere")
    ... except phicam.FileError as error:
    ...     error.cause
    'nowhere is not the folder of a run: it has no run.json'
    """
    native, found = _native.read_run(Path(folder), [Path(p) for p in also_read])
    record = json.loads(found["record"])
    keys = ("estimator", "sampler", "seed", "samples", "blocks", "seconds", "threads")
    rendered = "estimator" in record
    return Phi(
        Scene._of(native),
        found["flux"],
        found["stderr"],
        left_out=found["left_out"],
        # What was f32 on disk is exactly that again.
        by_bounces=None if found["bounces"] is None else [part.astype(np.float32) for part in found["bounces"]],
        settings={key: record[key] for key in keys} if rendered else {},
        account={} if rendered else {"unit": record["imported"]["flux_unit"], **record["imported"]},
    )
