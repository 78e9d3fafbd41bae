"""From the photographs back to the hidden reflectance."""

from __future__ import annotations

import json
import warnings
from collections.abc import Sequence
from functools import partial
from html import escape
from typing import Any, Literal, TypedDict

import numpy as np
from numpy.typing import ArrayLike

from . import _html, _native
from ._arrays import Floats, flag, matrix, pair, setting, shaped, spread, threads_of, vector, whole, without
from ._beside import beside
from ._model import Integration, Kernel, Model, model, model_of
from ._phi import Phi
from ._scene import Scene
from ._verdict import Errors
from .errors import InputError, Suspicious, in_python


class Surface:
    """What was recovered of one hidden surface.

    Arrays are elements in the order iu + iv · nu, or None where they are not known.

    Attributes
    ----------
    reflectance, stderr : ndarray, elements
        The reflectances, and their standard errors: how far the estimate would scatter (linear methods), or how far the
        truth is expected off (``joint-gp``, ``joint-two-valued``). What a linear method drops or damps is not in them: see
        `resolution`, `bias` and `determined`. None under bounds (``joint``, ``nnls``: ask for bands; ``joint-tv``), and
        where errors hang together, as those of ``shared`` and ``factored`` renders do.
    lower, upper : ndarray
        Bands, where they were asked for.
    bias : ndarray
        What the method makes of the truth, less the truth, where it is linear and the truth known.
    light : ndarray
        Probability to be light (``joint-two-valued``).
    alike, alike_stderr : ndarray
        Mean over all patterns where neighbours may be alike, as those of a board or a letter are, and the standard
        deviation about it (``joint-two-valued``, where it is known).
    determined : ndarray
        What the photographs determine of each element by any method, 0 to 1: 1 − (σ/0.5)², σ its standard error after
        them where 0.5 ± 0.5 is known before.
    truth : ndarray
        The true albedos.
    covariance, resolution : ndarray
        Elements × elements of all surfaces.
    values : dict
        All else: fit, choice of parameters, scores, warnings.
    """

    def __init__(self, found: dict[str, Any]) -> None:
        self.values: dict[str, Any] = json.loads(found["json"])
        self.values["warnings"] = [in_python(text) for text in self.values["warnings"]]
        self.name: str = self.values["surface"]
        self.elements: tuple[int, int] = tuple(self.values["elements"])
        self.reflectance: Floats = found["reflectance"]
        self.stderr: Floats | None = found["stderr"]
        self.lower: Floats | None = found["lower"]
        self.upper: Floats | None = found["upper"]
        self.bias: Floats | None = found["bias"]
        self.light: Floats | None = found["light"]
        self.alike: Floats | None = found["alike"]
        self.alike_stderr: Floats | None = found["alike_stderr"]
        self.determined: Floats | None = found["determined"]
        self.truth: Floats | None = found["truth"]
        self.covariance: Floats | None = found["covariance"]
        self.resolution: Floats | None = found["resolution"]
        self._text: str = found["text"]

    def picture(self, values: ArrayLike | None = None) -> Floats:
        """`values` of the elements (the reflectances unless given) as a picture: nv × nu, row 0 the lowest.

        >>> import phicam, numpy
        >>> A = numpy.random.default_rng(1).random((40, 6))
        >>> found = phicam.recover(A @ [1, 0, 0, 0, 0, 1], A, "joint", elements=(3, 2))
        >>> found.surfaces[0].picture().round(6).tolist()
        [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
        """
        nu, nv = self.elements
        flat = self.reflectance if values is None else vector(values, "values")
        if flat.size != nu * nv:
            raise InputError(f"values has {flat.size} numbers\n  cure: give {nu * nv}, one for each element")
        return flat.reshape(nv, nu)

    def to_xarray(self) -> Any:
        """An ``xarray.Dataset`` of all that is known of each element over (v, u), each 0 to 1 in the surface's parameters.

        >>> import phicam, numpy
        >>> found = phicam.recover(numpy.eye(4) @ [1, 0, 0, 1], numpy.eye(4), "joint", elements=(2, 2))
        >>> found.surfaces[0].to_xarray().u.values.tolist()
        [0.25, 0.75]
        """
        import xarray

        named = ("reflectance", "stderr", "lower", "upper", "bias", "light", "alike", "alike_stderr", "determined", "truth")
        known = {name: values for name in named if (values := getattr(self, name)) is not None}
        data = {name: (("v", "u"), self.picture(values)) for name, values in known.items()}
        nu, nv = self.elements
        coords = {"v": (np.arange(nv) + 0.5) / nv, "u": (np.arange(nu) + 0.5) / nu}
        return xarray.Dataset(data, coords, {"surface": self.name, "method": self.values["method"]})


class Recovery:
    """What one method recovered, with how sure it is.

    Attributes
    ----------
    method : str
    surfaces : tuple of Surface
        The hidden surfaces in the order of the scene's file.
    others : tuple of Recovery
        What other methods recovered that were tried, the more trusted first.
    failed : dict
        Methods that could not work, and why.
    """

    def __init__(self, surfaces: Sequence[Surface]) -> None:
        self.surfaces = tuple(surfaces)
        self.method: str = self.surfaces[0].values["method"]
        self.others: tuple[Recovery, ...] = ()
        self.failed: dict[str, str] = {}

    def _all(self, name: str) -> Floats | None:
        parts = [getattr(surface, name) for surface in self.surfaces]
        return None if any(part is None for part in parts) else np.concatenate(parts)

    @property
    def reflectance(self) -> Floats:
        """The reflectances of all elements, surfaces one after the other."""
        return np.concatenate([surface.reflectance for surface in self.surfaces])

    @property
    def stderr(self) -> Floats | None:
        """Their standard errors."""
        return self._all("stderr")

    @property
    def lower(self) -> Floats | None:
        """Lower ends of their bands."""
        return self._all("lower")

    @property
    def upper(self) -> Floats | None:
        """Upper ends of their bands."""
        return self._all("upper")

    @property
    def determined(self) -> Floats | None:
        """What the photographs determine of each by any method, 0 to 1."""
        return self._all("determined")

    @property
    def light(self) -> Floats | None:
        """Their probability to be light (``joint-two-valued``)."""
        return self._all("light")

    @property
    def alike(self) -> Floats | None:
        """Their mean where neighbours may be alike (``joint-two-valued``)."""
        return self._all("alike")

    @property
    def alike_stderr(self) -> Floats | None:
        """Its standard deviations."""
        return self._all("alike_stderr")

    @property
    def truth(self) -> Floats | None:
        """Their true values, where the scene knows them."""
        return self._all("truth")

    @property
    def covariance(self) -> Floats | None:
        """Covariance of the reflectances, elements × elements, of methods that are linear in Φcam."""
        return _stacked([surface.covariance for surface in self.surfaces])

    @property
    def resolution(self) -> Floats | None:
        """What the method makes of the truth: reflectance = resolution · truth on average; elements × elements."""
        return _stacked([surface.resolution for surface in self.surfaces])

    def picture(self, surface: int = 0) -> Floats:
        """The reflectances of a surface as a picture, nv × nu, row 0 the lowest: ``imshow(…, origin="lower")``.

        >>> import phicam, numpy
        >>> phicam.recover(numpy.eye(4) @ [1, 0, 0, 1], numpy.eye(4), "joint", elements=(2, 2)).picture().round(6).tolist()
        [[1.0, 0.0], [0.0, 1.0]]
        """
        return self.surfaces[surface].picture()

    def to_xarray(self, surface: int = 0) -> Any:
        """An ``xarray.Dataset`` of the reflectances of a surface, their errors and all else that is known, over (v, u).

        >>> import phicam
        >>> phi = phicam.render(phicam.Scene("bench"), samples=32)
        >>> phicam.recover(phi, method="tsvd").to_xarray().reflectance.dims
        ('v', 'u')
        """
        return self.surfaces[surface].to_xarray()

    @property
    def fit(self) -> dict[str, Any] | None:
        """How well it explains the photographs: chi2_per_dof, dof, p, fits; None where nothing is known of the noise,
        unless it is of two levels and leaves over more than any noise of one size."""
        found: dict[str, Any] | None = self.surfaces[0].values["fit"]
        return found

    @property
    def is_refuted(self) -> bool:
        """Whether no reflectances between 0 and 1 explain the photographs: then the model is wrong."""
        best = self.surfaces[0].values["best_fit"]
        return best is not None and not best["fits"]

    @property
    def fits(self) -> bool | None:
        """Whether this picture explains the photographs; None where that cannot be judged."""
        return None if self.fit is None else bool(self.fit["fits"])

    @property
    def warnings(self) -> list[str]:
        """What to know before this picture is trusted."""
        return [text for surface in self.surfaces for text in surface.values["warnings"]]

    def __str__(self) -> str:
        return "\n".join(surface._text for surface in self.surfaces)

    def __repr__(self) -> str:
        count = self.reflectance.size
        fit = "" if self.fit is None else f", χ²/dof {self.fit['chi2_per_dof']:.3g}"
        told = ", REFUTED" if self.is_refuted else ", DOES NOT FIT" if self.fits is False else ""
        return f"Recovery({self.method!r}, {count} elements{fit}{told})"

    def _repr_html_(self) -> str:
        parts = [_html.sentence(repr(self), "Bad" if self.is_refuted or self.fits is False else "Plain")]
        for surface in self.surfaces:
            named = [("recovered", surface.reflectance), ("standard error", surface.stderr), ("truth", surface.truth)]
            drawn: list[_html.Panel] = [
                (name, surface.picture(values), ("u", "v"), 2.0) for name, values in named if values is not None
            ]
            parts.append(_html.gallery(surface.name, "reflectance", drawn, reflectance=True))
        parts += [f"<p>{escape(text)}</p>" for text in self.warnings]
        return "\n".join(parts)


def _stacked(parts: list[Floats | None]) -> Floats | None:
    found = [part for part in parts if part is not None]
    return np.concatenate(found) if len(found) == len(parts) else None


class _Settings(TypedDict):
    rank: int | None
    damping: float | None
    rule: str | None
    tolerance: float | None
    tv: float | None
    levels: tuple[float, float] | None
    weighting: str | None
    bands: float | None
    error_field: bool


def recover(
    phi: Phi | ArrayLike,
    model: Scene | Model | ArrayLike | tuple[ArrayLike, ArrayLike] | None = None,
    method: str | Sequence[str] | None = None,
    *,
    stderr: ArrayLike | None = None,
    noise: float | None = None,
    left_out: ArrayLike | None = None,
    elements: tuple[int, int] | int | None = None,
    kernel: Kernel = "physical",
    integration: Integration = "quadrature",
    occlusion: bool = True,
    rank: int | None = None,
    damping: float | None = None,
    rule: Literal["discrepancy", "gcv", "l-curve"] | None = None,
    tolerance: float | None = None,
    tv: float | None = None,
    levels: tuple[float, float] | None = None,
    weighting: Literal["noise", "entries", "none"] | None = None,
    bands: float | None = None,
    error_field: bool = False,
    frame_constant: bool = False,
    frame_polynomial: int | None = None,
    frame_patterns: ArrayLike | None = None,
    background: bool = False,
    glare_pattern: ArrayLike | None = None,
    free_scale: bool = False,
    frame_gain: float | None = None,
    scale_error: float | None = None,
    errors: Errors | None = None,
    replicates: int | None = None,
    pixels: tuple[int, int] | None = None,
    threads: int | None = None,
) -> Recovery:
    """Recovers what was hidden, as ``phicam recover`` does.

    Parameters
    ----------
    phi : Phi, or array
        Photographs, pixels × spots; one photograph may be a vector.
    model : Scene, Model, array A, or pair (C, D)
        What they are inverted by: the scene of `phi` unless given; a matrix of one's own, φ = A · x, pixels × elements;
        or the two sides of Φ = C · diag(x) · D.
    method : str or several, optional
        One of :func:`methods`. Unless given the usual ones are tried, and the most trusted is returned with the others as
        ``others``. ``joint-…`` work on all pixels and spots at once: ``joint-unbounded`` least squares, ``joint`` with
        0 ≤ x ≤ 1, ``nnls`` with 0 ≤ x, ``joint-gp`` where neighbours resemble one another, ``joint-tv`` where they are mostly
        equal, ``joint-two-valued`` where there are two reflectances. The others invert the laser side D alone, pixel by
        pixel, and need as many spots that differ as elements: they are not for a single photograph A · x.
    stderr, noise : array or float
        Standard errors, in place of those of `phi`; or relative to each entry. Without either, of an array nothing is
        known of the noise.
    left_out : array
        Not 0 where an entry does not count (joint methods); of photographs their own unless given.
    elements : (int, int)
        Elements along u and v in place of the scene's; of matrices how they lie.
    kernel, integration, occlusion
        As in :func:`phicam.model`, where a scene is given.
    rank, damping, rule, tolerance, tv, levels, weighting
        Parameters of methods; by their own rule unless given.
    bands : float
        Confidence of bands, e.g. 0.95.
    error_field : bool
        Where the noise is not known, ``joint-gp`` takes what it leaves over for noise of single pixels and a field of errors
        that neighbours share, in place of noise that so many pixels share.
    frame_constant, frame_polynomial, frame_patterns, background, glare_pattern, free_scale, frame_gain, scale_error
        What else the photographs hold, estimated with the reflectances (joint methods): a constant, a polynomial of that
        degree, or patterns (pixels × patterns) in each frame; a background of all frames; strength of glare (pixels ×
        spots); a free scale of all light, of which the brightest element is then the unit: 1 ± 0, the others relative to
        it; gains of the frames, or the scale, known to that standard deviation.
    errors, replicates
        As in :func:`phicam.validate`.
    pixels : (int, int)
        Columns and rows of a photograph, where `phi` is an array.

    Raises
    ------
    InputError
        What a method lacks, with how to supply it; matrices that do not fit.

    Examples
    --------
    >>> import numpy, phicam
    >>> A = numpy.random.default_rng(1).random((40, 6))
    >>> x = numpy.array([0.1, 0.9, 0.4, 0.6, 0.2, 0.8])
    >>> found = phicam.recover(A @ x, A, "joint", noise=1e-3)
    >>> bool(numpy.abs(found.reflectance - x).max() < 1e-2)
    True
    """
    own, unknown = False, 0.0
    if isinstance(phi, Phi):
        flux = phi.flux
        if left_out is None:
            phi.refuse_clipped()
        own = stderr is None and noise is None
        if own:
            stderr = phi.stderr
            its_errors, its_replicates, unknown = phi._known(background)
            errors = errors or its_errors  # type: ignore[assignment]
            replicates = its_replicates if replicates is None else replicates
        if left_out is None and "spots" in phi.settings:
            left_out = np.ones(flux.shape)
            left_out[:, phi.settings["spots"]] = 0.0
        elif left_out is None and not phi.is_rendered:
            left_out = phi.left_out
        model = phi.scene if model is None else model
        pixels = phi.scene.pixels
    else:
        flux = matrix(phi, "phi")
    inverse = _inverse(model, (kernel, integration, occlusion), elements)
    count = inverse.shape
    flux = shaped(flux, (count[0], count[2]), "phi")
    if inverse.scene is not None:
        pixels = inverse.scene.pixels
    pixels = pair(pixels, "pixels")
    if pixels is not None and pixels[0] * pixels[1] != count[0]:
        raise InputError(f"pixels is {pixels}\n  cure: give columns and rows of {count[0]} pixels")
    if noise is not None and stderr is not None:
        raise InputError("stderr and noise are both given\n  cure: give one of them")
    relative = setting(noise, "noise")
    named = None if method is None else [method] if isinstance(method, str) else list(method)
    if named is not None and (not named or len(set(named)) < len(named)):
        raise InputError(f"method is {method!r}\n  cure: name one or several methods, each once")
    takers = _native.setting_methods("free_scale")
    if isinstance(phi, Phi) and not free_scale and any(name in takers for name in named or takers):
        phi.refuse_unscaled("give free_scale=True, or")
    takers = _native.setting_methods("frame_gain")
    if isinstance(phi, Phi) and own and frame_gain is None and any(name in takers for name in named or takers):
        frame_gain = phi.frame_gain
    is_grid = inverse.scene is not None or inverse._made_of[2] is not None
    settings = _Settings(
        rank=None if rank is None else whole(rank, "rank", 1),
        damping=setting(damping, "damping"),
        rule=rule,
        tolerance=setting(tolerance, "tolerance"),
        tv=setting(tv, "tv"),
        levels=_levels(levels),
        weighting=weighting,
        bands=setting(bands, "bands"),
        error_field=flag(error_field, "error_field"),
    )
    others = beside(
        flux.shape,
        pixels,
        frame_constant=frame_constant,
        frame_polynomial=frame_polynomial,
        frame_patterns=frame_patterns,
        background=background,
        glare_pattern=glare_pattern,
        free_scale=free_scale,
        frame_gain=frame_gain,
        scale_error=scale_error,
        left_out=left_out,
    )
    flags = others["left_out"]
    flux = without(flux, flags)
    _used({**settings, **others}, named)
    known = None if stderr is None else without(spread(stderr, flux.shape, "stderr"), flags)
    if relative is not None and named is not None and not any(name in takers for name in named):
        # Methods that work pixel by pixel weigh no entry by its error.
        known = relative * np.abs(np.asarray(flux, dtype=np.float64))
    elif relative is not None:
        known = _native.relative_errors(flux, relative, flags)
    recovered = partial(
        _native.recover,
        inverse._core,
        flux,
        known,
        methods=named,
        is_grid=is_grid,
        settings=settings,
        beside=others,
        known=(
            errors or "independent",
            None if replicates is None else whole(replicates, "replicates", 2, 2**32 - 1),
            unknown,
        ),
        trusted=named is None,
        threads=threads_of(threads),
    )
    try:
        found, failed = recovered()
    except InputError as error:
        raise InputError(in_python(str(error))) from None
    if not found:
        why = "\n  ".join(f"{name}: {in_python(reason)}" for name, reason in failed)
        raise InputError(f"no method could recover anything\n  {why}\n  cure: see the reason of each, or name a method")
    groups: dict[str, list[Surface]] = {}
    for surface in map(Surface, found):
        groups.setdefault(surface.values["method"], []).append(surface)
    first, *rest = (Recovery(surfaces) for surfaces in groups.values())
    first.others, first.failed = tuple(rest), {name: in_python(reason) for name, reason in failed}
    if first.fits is False and first.warnings:
        own = inverse.scene is not None and inverse.integration == "centres" and isinstance(model, Model)
        words = "; the model is by centres: phicam.model(scene, integration=\"quadrature\") integrates" if own else ""
        warnings.warn(f"{first.method}: {first.warnings[0]}{words}", Suspicious, stacklevel=2)
    return first


#: Kernel, integration and occlusion unless given.
_HOW: tuple[Kernel, Integration, bool] = ("physical", "quadrature", True)


def _inverse(given: Any, how: tuple[Kernel, Integration, bool], elements: Any) -> Model:
    """The model that photographs are inverted by."""
    kernel, integration, occlusion = how
    if given is None:
        cure = "give model=: a Scene, a Model, a matrix A, or the pair (C, D)"
        raise InputError(f"nothing says what the photographs are inverted by\n  cure: {cure}")
    if isinstance(given, Scene):
        return model(given, kernel=kernel, elements=elements, occlusion=occlusion, integration=integration)
    own = (given.kernel, given.integration, given.occlusion) if isinstance(given, Model) else _HOW
    if not isinstance(given, str) and how not in (_HOW, own):
        what = "a Model, which is made already" if isinstance(given, Model) else "matrices, which have none"
        cure = "make the model with them (phicam.model), or leave them out"
        raise InputError(f"kernel, integration and occlusion are given with {what}\n  cure: {cure}")
    if isinstance(given, Model):
        if elements is not None:
            raise InputError("elements is given with a Model\n  cure: make the model of as many elements")
        return given
    if isinstance(given, str):
        raise InputError(f"model is {given!r}\n  cure: give phicam.Scene({given!r})")
    if isinstance(given, tuple):
        sides: tuple[Any, ...] = given  # pyright: ignore[reportUnknownVariableType]
        if len(sides) != 2:
            raise InputError(f"model is a tuple of {len(sides)}\n  cure: give the pair (C, D)")
        return model_of(sides[0], sides[1], pair(elements, "elements"))
    return model_of(given, None, pair(elements, "elements"))


def _levels(given: Any) -> tuple[float, float] | None:
    """Two reflectances, or None."""
    if given is None:
        return None
    try:
        dark, light = (float(x) for x in given)
    except (TypeError, ValueError) as error:
        raise InputError(f"levels is {given!r}\n  cure: give two reflectances, e.g. (0.1, 0.8)") from error
    return dark, light


def _used(settings: dict[str, Any], methods: Sequence[str] | None) -> None:
    """Refuses settings that none of the methods takes."""
    for name, value in settings.items():
        if value is None or value is False or methods is None or name == "pixels":
            continue
        takers = _native.setting_methods(name)
        if not any(method in takers for method in methods):
            cure = f"ask for one that takes it ({', '.join(takers)}), or leave it out"
            raise InputError(f"{name} means nothing to {', '.join(methods)}\n  cure: {cure}")


def methods() -> list[str]:
    """The names of the methods; :func:`recover` says what they assume.

    >>> import phicam
    >>> "joint-gp" in phicam.methods()
    True
    """
    return list(_native.methods())
