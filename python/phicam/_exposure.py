"""What a sensor makes of Φcam."""

from __future__ import annotations

import json
import warnings
from collections.abc import Sequence
from typing import Any

from . import _native
from ._arrays import Floats, threads_of, whole
from ._finding import Finding
from ._phi import Phi
from ._scene import Scene
from .errors import InputError, Suspicious


class Photographs(Phi):
    """Φcam as a sensor measures it: see :class:`Phi`.

    Attributes
    ----------
    clipped : ndarray, pixels × spots
        1 where an entry is saturated in every exposure, −1 where the converter cut it off below, 0.5 where it is so near to
        either that it is off on average, else 0.
    counts : tuple of ndarrays, pixels × spots
        What the converter gave, for each exposure time.
    summary : Finding
        Electrons, signal over noise, what is saturated.
    """

    counts: tuple[Floats, ...]
    summary: Finding

    @property
    def common(self) -> float:
        """The part of the variance that is that of the dark frames, which all spots of a pixel share."""
        return float(self.summary.values["common"])


def expose(
    phi: Phi,
    sensor: str | None = None,
    *,
    seed: int = 1,
    exposure: float | None = None,
    frames: int | None = None,
    dark_frames: int | None = None,
    brackets: Sequence[float] | None = None,
    noise: float | None = None,
    ambient: float | None = None,
    oracle: bool = False,
    threads: int | None = None,
    **more: Any,
) -> Photographs:
    """Photographs the clean flux: shot noise, read noise, dark current, converter, as ``phicam expose`` does.

    Parameters
    ----------
    sensor : str, optional
        A built-in sensor (:func:`sensors`); the scene's [sensor] unless given.
    exposure, brackets : float, sequence of float
        Exposure time, or several of them, s.
    frames, dark_frames : int
        Frames averaged, and frames without laser that are averaged and subtracted.
    noise : float
        Standard deviation of a factor on each finished entry.
    ambient : float
        Ambient light, W into each pixel.
    oracle : bool
        Whether standard errors are those of the sensor's true figures; else of its own calibration, as in a laboratory.
    more
        Any other key of a scene's [sensor]: ``read_noise``, ``full_well``, ``bits``, ``glare``, …

    Returns
    -------
    Photographs
        `flux` and `stderr`, W.

    >>> import phicam
    >>> scene = phicam.Scene("bench").replace({"laser.spots.per_side": 2})
    >>> phi = phicam.render(scene, samples=64, estimator="factored")
    >>> photographs = phicam.expose(phi, "ideal", exposure=10.0)
    >>> photographs.flux.shape
    (256, 8)
    """
    if not isinstance(phi, Phi) or not phi.is_rendered or phi.stderr is None:
        raise InputError("a sensor photographs clean flux\n  cure: give what phicam.render or phicam.load returns")
    scene = phi.scene
    own: dict[str, Any] = json.loads(scene._core.sensor) or {}
    if sensor is not None:
        kept = ("exposure", "frames", "dark_frames", "brackets", "ambient", "glare")
        own = {key: own[key] for key in kept if own.get(key) is not None} | {"model": sensor}
    if not own:
        raise InputError(
            f"scene {scene.name!r} has no [sensor] table\n  cure: name a built-in sensor: {', '.join(sensors())}"
        )
    if exposure is not None and brackets is None:
        own.pop("brackets", None)
    given = {
        "exposure": exposure,
        "frames": frames,
        "dark_frames": dark_frames,
        "brackets": None if brackets is None else [float(x) for x in brackets],
        "relative_noise": noise,
        "ambient": ambient,
        **more,
    }
    own |= {key: value for key, value in given.items() if value is not None}
    settled: Scene = scene.replace({"sensor": {key: value for key, value in own.items() if value is not None}})
    found = _native.expose(
        settled._core,
        phi.flux,
        phi.stderr,
        blocks=phi.replicates or 32,
        seed=whole(seed, "seed"),
        by_counts=not oracle,
        threads=threads_of(threads),
    )
    made = Photographs(settled, found["flux"], found["stderr"])
    made.clipped, made.counts, made.summary = found["clipped"], tuple(found["counts"]), Finding(found)
    result: dict[str, Any] = made.summary.values
    if result["saturated"] + result["near"] + result["floored"]:
        cure = "expose for a shorter time or in brackets; a larger `offset` keeps counts above 0"
        text = (
            f"{result['saturated']} of {result['entries']} entries are saturated, {result['floored']} cut off below, "
            f"{result['near']} so near to either that they are off on average, see clipped; {cure}"
        )
        warnings.warn(text, Suspicious, stacklevel=2)
    if result["snr_max"] is not None and result["snr_max"] < 1:
        text = "no entry rises above its noise; expose longer or average more frames"
        warnings.warn(text, Suspicious, stacklevel=2)
    if made.errors == "pixel":
        text = (
            f"{result['common']:.1%} of the variance is that of the dark frames, which all spots of a pixel share: recover "
            "states no errors unless background=True takes their part; take more dark_frames"
        )
        warnings.warn(text, Suspicious, stacklevel=2)
    shared = phi.errors != "independent"
    if result["render"] > (1e-3 if shared else 0.1):
        text = f"{result['render']:.1%} of the variance is that of the render itself; render with more samples" + (
            f", or by estimator=\"independent\": those of {phi.settings['estimator']} do not average out" if shared else ""
        )
        warnings.warn(text, Suspicious, stacklevel=2)
    if result["pedestal"] > 0.1 * float(made.stderr.mean()):
        text = (
            f"{result['pedestal']:.2e} W of dark current and ambient light stay in every entry; subtract dark_frames, or "
            "recover with background=True"
        )
        warnings.warn(text, Suspicious, stacklevel=2)
    return made


def sensors() -> dict[str, str]:
    """The built-in sensors, each with what it is.

    >>> import phicam
    >>> "ideal" in phicam.sensors()
    True
    """
    return dict(_native.sensors())
