"""Where things are, by the photographs themselves."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any, cast

import numpy as np
from numpy.typing import ArrayLike

from . import _native
from ._arrays import Floats, flag, maybe, number, pair, setting, threads_of, whole
from ._finding import Finding
from ._model import Integration
from ._phi import Phi
from ._progress import Progress, told
from ._scene import Scene
from .errors import InputError


class Location(Finding):
    """Where something is: see :func:`locate`."""

    def __init__(self, found: dict[str, Any], is_found: bool) -> None:
        super().__init__(found)
        #: Whether it was found, and the photographs do not refute it.
        self.is_found = is_found

    @property
    def size(self) -> float | None:
        """The likeliest size of what was looked for, from what the scene says; None at an end of the range."""
        found: float | None = self.values["size"]
        return found

    @property
    def stderr(self) -> float | None:
        """Its standard error, the larger of two; None where one is not known."""
        both = (self.values["by_curvature"], self.values["by_frames"])
        return None if None in both else max(both)


class Calibration(Finding):
    """The geometry, estimated: see :func:`calibrate`.

    Attributes
    ----------
    scene : Scene
        The calibrated scene.
    """

    def __init__(self, found: dict[str, Any], is_found: bool, scene: Scene) -> None:
        super().__init__(found)
        #: Whether it was found, and the photographs do not refute it.
        self.is_found = is_found
        self.scene = scene

    @property
    def parameters(self) -> dict[str, tuple[float, float]]:
        """What was estimated: value, from what the scene says, and standard error, in its unit."""
        return {each["name"]: (each["value"], each["stderr"]) for each in self.values["found"]}

    def picture(self, surface: int = 0) -> Floats:
        """The picture that the photographs make with that geometry, nv × nu, row 0 the lowest.

        >>> import phicam
        >>> scene = phicam.Scene("bench").replace({"laser.spots.per_side": 6, "camera.pixels": (8, 8)})
        >>> phi = phicam.render(scene, samples=256)
        >>> phicam.calibrate(phi, ["hinge.angle"], elements=(2, 2), starts=1).picture().shape
        (2, 2)
        """
        grid = self.values["grids"][surface]
        nu, nv = grid["count"]
        return np.array(grid["values"]).reshape(nv, nu)


def _photographs(phi: Phi, scene: Scene | None, left_out: ArrayLike | None) -> tuple[Scene, tuple[Any, Any, Any]]:
    if not isinstance(phi, Phi):
        raise InputError("phi is no Phi\n  cure: give what phicam.render, load or import_photographs returns, or Phi(…)")
    if left_out is None:
        phi.refuse_clipped()
    flags = phi.left_out if left_out is None else maybe(left_out, "left_out")
    return (phi.scene if scene is None else scene), (phi.flux, phi.stderr, flags)


def calibrate(
    phi: Phi,
    free: Mapping[str, float | None] | Iterable[str] | None = None,
    scene: Scene | None = None,
    *,
    left_out: ArrayLike | None = None,
    frame_gain: float | None = None,
    free_scale: bool = False,
    error_field: bool = False,
    background: bool = False,
    elements: tuple[int, int] | int | None = None,
    occlusion: bool = True,
    integration: Integration = "quadrature",
    frame_polynomial: int | None = None,
    starts: int = 3,
    spread: float = 1.0,
    seed: int = 1,
    threads: int | None = None,
    progress: Progress = False,
) -> Calibration:
    """Estimates the geometry from the photographs, whatever the picture, as ``phicam calibrate`` does.

    The evidence with the picture averaged out is maximised over the geometry.

    Parameters
    ----------
    phi : Phi
    free : names, or dict of names with standard deviations
        What is not known (:meth:`Scene.parameters`): ``hinge.angle``, ``hidden.normal``, ``spots.shift``, …; with the
        standard deviation to which it was measured, or None: that of the scene's [uncertainty], if it has one. All of
        that table unless given.
    scene : Scene, optional
        What is thought to be the geometry: the scene of `phi` unless given.
    frame_gain : float
        Relative standard deviation of an unknown gain of each frame; that of the photographs' gains unless given.
    free_scale : bool
        Whether the scale of all light is unknown.
    error_field : bool
        Whether what is left over is taken for noise of single pixels and a field of errors that neighbours share; for
        photographs whose noise is not known.
    background : bool
        Whether there is other light that all frames share, unknown in each pixel.
    elements : (int, int)
        Elements in place of the scene's, or of 12 × 12 where those are more than 256.
    starts, spread, seed
        Starts, how many standard deviations those after the first are off, and their seed.

    >>> import phicam
    >>> scene = phicam.Scene("bench").replace({"laser.spots.per_side": 6, "camera.pixels": (8, 8)})
    >>> phi = phicam.render(scene, samples=256)
    >>> found = phicam.calibrate(phi, ["hinge.angle"], elements=(2, 2), starts=1)
    >>> value, error = found.parameters["hinge.angle"]
    >>> abs(value) < 4 * error
    True
    """
    own, (flux, stderr, flags) = _photographs(phi, scene, left_out)
    stated = dict(own._core.uncertainty)
    named: dict[str, float | None]
    if free is None:
        named = dict.fromkeys(stated)
    elif isinstance(free, str):
        named = {free: None}
    elif isinstance(free, Mapping):
        named = {str(name): sigma for name, sigma in cast("Mapping[str, float | None]", free).items()}
    else:
        named = dict.fromkeys(free)
    if not named:
        cure = "name parameters: phicam.calibrate(phi, [\"hinge.angle\"]), or give the scene a table [uncertainty]"
        raise InputError(f"nothing is free\n  cure: {cure}")
    given = [
        (name, stated.get(name) if sigma is None else number(sigma, name, "above 0", lambda x: x > 0))
        for name, sigma in named.items()
    ]
    count = whole(starts, "starts", 1, 1000)
    found, is_found, calibrated = _native.calibrate(
        own._core,
        flux,
        stderr,
        flags,
        free=given,
        frame_gain=setting(phi.frame_gain if frame_gain is None else frame_gain, "frame_gain"),
        free_scale=flag(free_scale, "free_scale"),
        error_field=flag(error_field, "error_field"),
        background=flag(background, "background"),
        known=phi._known(background),
        elements=pair(elements, "elements"),
        considered=flag(occlusion, "occlusion"),
        integration_name=integration,
        frame_polynomial=None if frame_polynomial is None else whole(frame_polynomial, "frame_polynomial", 0, 8),
        starts=count,
        spread=number(spread, "spread", "above 0", lambda x: x > 0),
        seed=whole(seed, "seed"),
        threads=threads_of(threads),
        progress=told(f"calibrate {own.name}", progress, count + 1),
    )
    return Calibration(found, is_found, Scene._of(calibrated))


def locate(
    phi: Phi,
    what: str = "normal",
    between: tuple[float, float] | None = None,
    scene: Scene | None = None,
    *,
    left_out: ArrayLike | None = None,
    steps: int = 17,
    elements: tuple[int, int] | int | None = None,
    occlusion: bool = True,
    integration: Integration = "quadrature",
    frame_polynomial: int | None = None,
    background: bool = False,
    orders: int = 999,
    seed: int = 1,
    threads: int | None = None,
    progress: Progress = False,
) -> Location:
    """Where something is, the reflectances unknown, and whether the photographs belong to their spots, as
    ``phicam locate`` does.

    Parameters
    ----------
    what : str
        ``normal``, of what is not flat ``u`` and ``v``: the hidden surface moved; ``angle``, ``yaw``: turned; ``spots-x``, ``view-x``, …
    between : (float, float)
        Sizes between which it is looked for, in the scene's unit or degrees; ± 15°, or ± 30 % of the distance, unless
        given.
    steps : int
        Sizes tried first.
    background : bool
        Whether there is other light that all frames share, unknown in each pixel.
    orders : int
        Random orders of the spots that are tried; 0 leaves that question out.

    >>> import phicam
    >>> scene = phicam.Scene("bench").replace({"laser.spots.per_side": 3, "camera.pixels": (6, 6)})
    >>> phi = phicam.render(scene, samples=256)
    >>> found = phicam.locate(phi, "angle", (-5, 5), steps=7, elements=(2, 2), orders=0)
    >>> found.title != ""
    True
    """
    own, (flux, stderr, flags) = _photographs(phi, scene, left_out)
    if between is None:
        far = 15.0
        if what not in ("angle", "yaw"):
            from ._model import model

            middle = model(own, elements=(1, 1), occlusion=False).places[0]
            far = 0.3 * math.dist(middle.tolist(), own.footprints.mean(axis=0).tolist())
        between = (-far, far)
    ends: list[Any] = list(between)
    if len(ends) != 2:
        raise InputError(f"between is {between!r}\n  cure: give two sizes")
    low, high = (number(ends[k], "between", "that is finite", lambda _: True) for k in range(2))
    if low >= high:
        raise InputError(f"between is {between}\n  cure: give the smaller size first")
    count, tried = whole(steps, "steps", 3, 1000), whole(orders, "orders", 0, 1_000_000)
    found, is_found = _native.locate(
        own._core,
        flux,
        stderr,
        flags,
        known=phi._known(background),
        what=what,
        range=(low, high),
        steps=count,
        elements=pair(elements, "elements"),
        considered=flag(occlusion, "occlusion"),
        integration_name=integration,
        frame_polynomial=None if frame_polynomial is None else whole(frame_polynomial, "frame_polynomial", 0, 8),
        background=flag(background, "background"),
        orders=tried,
        seed=whole(seed, "seed"),
        threads=threads_of(threads),
        progress=told(f"locate in {own.name}", progress, count + 9 + tried),
    )
    return Location(found, is_found)
