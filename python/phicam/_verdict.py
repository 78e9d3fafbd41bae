"""Traced or measured against modelled."""

from __future__ import annotations

from typing import Any, Literal

from numpy.typing import ArrayLike

from . import _native
from ._arrays import Floats, flag, matrix, number, shaped, spread, threads_of, whole, without
from ._beside import beside
from ._finding import Finding
from ._model import Integration, Kernel, Model
from ._phi import Phi
from ._scene import Scene, scene_at
from .errors import InputError

Errors = Literal["independent", "pixel", "all"]


class Verdict(Finding):
    """Whether Φcam agrees with a model, within its standard errors.

    Attributes
    ----------
    z : ndarray, pixels × spots
        (traced − modelled) over its error, of every entry; nan where it does not count.
    model : ndarray, pixels × spots
        The model that was tested, W.
    """

    def __init__(self, found: dict[str, Any], z: Floats, model: Floats) -> None:
        super().__init__(found)
        self.z, self.model = z, model

    @property
    def agrees(self) -> bool:
        """Whether no test rejects the model; False too where there is no evidence."""
        return bool(self.values["agrees"])

    @property
    def evidence(self) -> bool:
        """Whether anything that counts was lit."""
        return bool(self.values["evidence"])

    @property
    def chi2_per_dof(self) -> float:
        """χ² over its degrees of freedom: 1 on average of a right model."""
        return float(self.values["chi2_per_dof"])

    @property
    def best_scale(self) -> tuple[float, float]:
        """Factor on the model that fits best, and its standard error."""
        return float(self.values["best_scale"]), float(self.values["best_scale_stderr"])

    def __bool__(self) -> bool:
        return self.agrees

    def __repr__(self) -> str:
        word = "agrees" if self.agrees else "no evidence" if not self.evidence else "DISAGREES"
        return f"Verdict({word}, χ²/dof {self.values['chi2_per_dof']})"


def validate(
    phi: Phi | ArrayLike,
    model: Scene | Model | None = None,
    *,
    stderr: ArrayLike | None = None,
    left_out: ArrayLike | None = None,
    integration: Integration = "quadrature",
    kernel: Kernel | None = None,
    occlusion: bool | None = None,
    significance: float = 1e-3,
    errors: Errors | None = None,
    replicates: int | None = None,
    frame_constant: bool = False,
    frame_polynomial: int | None = None,
    frame_patterns: ArrayLike | None = None,
    background: bool = False,
    glare_pattern: ArrayLike | None = None,
    free_scale: bool = False,
    frame_gain: float | None = None,
    scale_error: float | None = None,
    threads: int | None = None,
) -> Verdict:
    """Tests Φcam against the matrix model of a scene, as ``phicam validate`` does.

    Parameters
    ----------
    phi : Phi, or array of pixels × spots, W
        An array needs `stderr` and `model`.
    model : Scene or Model, optional
        What it is tested against: the scene of `phi` unless given. A Model stands for its scene, kernel and occlusion: the
        scene's light is integrated over its surfaces, unless `integration` is ``centres``.
    stderr : array, pixels × spots
        Standard errors in place of those of `phi`.
    left_out : array, pixels × spots
        Not 0 where an entry does not count; those of `phi` unless given.
    integration : str
        ``quadrature`` until nothing changes, or by ``centres``, whose distance from the integral is then allowed for.
    significance : float
        Probability of rejecting a right model.
    errors : str
        How errors hang together: ``independent``, ``pixel`` (those of one pixel), ``all``; that of `phi` unless given.
    replicates : int
        From how many replicates each standard error was estimated; that of `phi`, else as many as one likes. Errors from fewer than 32 are pooled over pixels and spots where these say more.
    frame_constant, frame_polynomial, frame_patterns, background, glare_pattern, free_scale, frame_gain, scale_error
        What else the photographs hold, fitted first, and not seen by the test: a constant, a polynomial of that degree, 0 to
        8, or patterns (pixels × patterns) in each frame; an image that is the same in all frames; strength of glare (pixels
        × spots); a free scale of all light, as of photographs in counts; gains of the frames, or the scale, known to that
        standard deviation, which counts as noise.

    >>> import phicam
    >>> scene = phicam.Scene("bench").replace({"laser.spots.per_side": 2, "camera.pixels": (4, 4)})
    >>> phi = phicam.render(scene, samples=64)
    >>> phicam.validate(phi).agrees
    True
    >>> wrong = scene.displaced({"hinge.angle": 2.0})
    >>> phicam.validate(phi, wrong).agrees
    False
    """
    unknown = 0.0
    if isinstance(phi, Phi):
        if not free_scale:
            phi.refuse_unscaled("the model is in W: say free_scale=True, or")
        if left_out is None:
            phi.refuse_clipped()
        scene, flux = phi.scene, phi.flux
        own = stderr is None
        stderr = phi.stderr if own else stderr
        left_out = phi.left_out if left_out is None else left_out
        if own:
            its_errors, its_replicates, unknown = phi._known(background)
            errors = errors or its_errors  # type: ignore[assignment]
            replicates = its_replicates if replicates is None else replicates
        paths = phi.settings.get("samples") if own and phi.is_rendered else None
        frame_gain = phi.frame_gain if own and frame_gain is None else frame_gain
    elif model is None:
        raise InputError("nothing says of which scene the array is\n  cure: give model=, a Scene or a Model")
    else:
        scene, flux, paths = None, matrix(phi, "phi"), None
    if model is not None and not isinstance(model, Model):
        scene_at(model)
    if isinstance(model, Model):
        if model.scene is None:
            raise InputError("a model of matrices has no scene\n  cure: give phicam.model(scene), or recover by it")
        kernel = kernel or model.kernel  # type: ignore[assignment]
        occlusion = model.occlusion if occlusion is None else occlusion
        if model.has_own_elements:
            cure = "give the model of the scene's own elements, or the scene; recover takes a model of any"
            raise InputError(
                "what is tested is the scene's light, integrated over its surfaces whatever their elements, and this model has "
                f"elements of its own\n  cure: {cure}"
            )
        model = model.scene
    against = model or scene
    assert against is not None
    if stderr is None:
        cure = "give stderr=; of photographs import several of each spot, or state the camera's noise"
        raise InputError(f"nothing is known of the noise\n  cure: {cure}")
    others = beside(
        against.shape,
        against.pixels,
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
    flux = without(shaped(flux, against.shape, "phi"), flags)
    noise = without(spread(stderr, against.shape, "stderr"), flags)
    found, z, modelled = _native.validate(
        against._core,
        flux,
        noise,
        kernel_name=kernel or "physical",
        integration_name=integration,
        considered=occlusion is None or flag(occlusion, "occlusion"),
        significance=number(significance, "significance", "between 0 and 1, e.g. 0.001", lambda x: 0 < x < 1),
        known=(
            errors or "independent",
            None if replicates is None else whole(replicates, "replicates", 2, 2**32 - 1),
            unknown,
        ),
        paths=paths,
        beside=others,
        threads=threads_of(threads),
    )
    return Verdict(found, z, modelled)
