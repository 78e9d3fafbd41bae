"""The matrix model: Φcam = C · diag(ρ) · D."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from . import _native
from ._arrays import Floats, flag, matrix, pair, vector
from ._scene import Scene, scene_at
from .errors import InputError

Kernel = Literal["physical", "published"]
Integration = Literal["centres", "quadrature"]


class _once:
    """An array that is computed at first use, and can be neither changed nor replaced: a model would not know."""

    def __init__(self, compute: Callable[[Any], Floats]) -> None:
        self._compute, self.__doc__, self._name = compute, compute.__doc__, compute.__name__

    def __get__(self, model: Any, _: Any = None) -> Any:
        if model is None:
            return self
        if self._name not in model.__dict__:
            found = self._compute(model)
            found.flags.writeable = False
            model.__dict__[self._name] = found
        return model.__dict__[self._name]

    def __set__(self, model: Any, _: Any) -> None:
        raise InputError(f"{self._name} follows from the model\n  cure: phicam.model_of(C, D) makes one of other matrices")


class Model:
    """G12, G23 and Φcam of a scene, or of two matrices.

    Φcam[p, l] = Φlaser · E_p · (ρ3/π) · (ρ1/π) · Σ_j G23[p, j] · (ρ2_j/π) · A_j · G12[j, l]

    Made by :func:`model` and :func:`model_of`. Arrays are computed at first use, and read-only; their copies are not.

    >>> import phicam, numpy
    >>> model = phicam.model(phicam.Scene("bench"), elements=(2, 2))
    >>> phi = model.camera_side @ numpy.diag(model.albedo) @ model.laser_side
    >>> bool(numpy.allclose(phi, model.phi(), rtol=1e-12, atol=0))
    True
    """

    def __init__(self, native: _native.Model, made_of: tuple[Any, ...]) -> None:
        self._core, self._made_of = native, made_of

    @property
    def scene(self) -> Scene | None:
        """The scene that it is of; None of matrices."""
        return self._made_of[0] if isinstance(self._made_of[0], Scene) else None

    @property
    def integration(self) -> str | None:
        """``centres`` or ``quadrature``; None of matrices."""
        return str(self._made_of[4]) if self.scene is not None else None

    @property
    def occlusion(self) -> bool:
        """Whether what stands in the way takes its share."""
        return self.scene is None or bool(self._made_of[3])

    @property
    def has_own_elements(self) -> bool:
        """Whether its elements are others than its scene's."""
        return self.scene is not None and self._made_of[2] is not None

    @property
    def kernel(self) -> str:
        """Its kernel."""
        return str(self._made_of[1]) if self.scene is not None else "physical"

    @property
    def shape(self) -> tuple[int, int, int]:
        """Pixels, elements, spots."""
        return self._core.shape

    @property
    def grids(self) -> dict[str, tuple[int, int]]:
        """Each surface with its elements along u and v; element iu + iv · nu, surfaces one after the other."""
        return dict(self._core.grids)

    @_once
    def g12(self) -> Floats:
        """cosθ · cosθ / R² between spots and elements: elements × spots, length⁻²; empty of matrices."""
        return self._core.g12

    @_once
    def g23(self) -> Floats:
        """cosθ · cosθ / R² between elements and what pixels see: pixels × elements, length⁻²; empty of matrices."""
        return self._core.g23

    @_once
    def camera_side(self) -> Floats:
        """C: from elements to pixels, pixels × elements; Φcam = C · diag(ρ) · D.

        By centres, whatever the integration: light that is integrated over areas is a sum of several such products, which
        :meth:`phi` and ``recover(phi, model)`` take.
        """
        return self._core.camera_side

    @_once
    def laser_side(self) -> Floats:
        """D: from spots to elements, elements × spots, W; by centres, as C."""
        return self._core.laser_side

    @_once
    def albedo(self) -> Floats:
        """The scene's own reflectance of each element; ½ of matrices and where the scene does not know it."""
        return np.array(self._core.albedo)

    @_once
    def places(self) -> Floats:
        """Middles of the elements, elements × 3, in the scene's unit; none of matrices."""
        return self._core.places

    def phi(self, rho: ArrayLike | None = None) -> Floats:
        """Φcam of these reflectances (the scene's own unless given), pixels × spots, W.

        >>> import phicam
        >>> model = phicam.model(phicam.Scene("bench"))
        >>> dark = model.phi([0.0] * model.shape[1])
        >>> dark.shape, float(dark.max())
        ((256, 120), 0.0)
        """
        albedo = np.array(self._core.own_albedo()) if rho is None else vector(rho, "rho")
        return self._core.phi(albedo.tolist())

    def converged(self) -> tuple[Floats, Floats]:
        """Φcam of the scene's own reflectances, integrated over elements, footprints and spots until it no longer
        changes, W, and a bound of what is left of each entry.

        >>> import phicam
        >>> scene = phicam.Scene("bench").replace({"laser.spots.per_side": 2, "camera.pixels": (4, 4)})
        >>> phi, bound = phicam.model(scene).converged()
        >>> bool((bound < 1e-3 * phi).all())
        True
        """
        return self._core.converged()

    def derivatives(self, name: str, rho: ArrayLike | None = None) -> dict[str, Floats]:
        """∂Φcam/∂θ, pixels × spots, W per degree, percent or length, of each parameter of the geometry that `name` names
        (:meth:`Scene.parameters`), by centres and without what stands in the way.

        >>> import phicam
        >>> slope = phicam.model(phicam.Scene("bench")).derivatives("hinge.angle")
        >>> slope["hinge.angle"].shape
        (256, 120)
        """
        albedo = np.array(self._core.own_albedo()) if rho is None else vector(rho, "rho")
        if len(albedo) != self.shape[1]:
            raise InputError(f"rho has {len(albedo)} numbers\n  cure: give one for each of {self.shape[1]} elements")
        return dict(self._core.derivatives(name, albedo.tolist()))

    def __repr__(self) -> str:
        pixels, elements, spots = self.shape
        of = f" of {self.scene.name!r}" if self.scene is not None else ""
        return f"Model({pixels} pixels, {elements} elements, {spots} spots{of})"

    def __reduce__(self) -> tuple[Any, ...]:
        return (_of_scene if self.scene is not None else model_of), self._made_of


def _of_scene(
    scene: Scene, kernel: Kernel, elements: tuple[int, int] | None, occlusion: bool, integration: Integration
) -> Model:
    native = _native.Model.of_scene(scene._core, kernel, elements, flag(occlusion, "occlusion"), integration)
    return Model(native, (scene, kernel, elements, occlusion, integration))


def model(
    scene: Scene,
    *,
    kernel: Kernel = "physical",
    elements: tuple[int, int] | int | None = None,
    occlusion: bool = True,
    integration: Integration = "centres",
) -> Model:
    """The matrix model of a scene: the same numbers as ``phicam model``.

    It is by centres unless told; :func:`recover` and :func:`validate` of a Scene integrate. A recovery by a model of
    centres does not fit where elements are large for their distance.

    Parameters
    ----------
    kernel : str
        ``physical``, or ``published`` for reproducing the published curves.
    elements : (int, int), optional
        Elements along u and v in place of the scene's.
    occlusion : bool
        Whether what stands in the way takes its share of each entry.
    integration : str
        ``centres`` of elements, pixels and spots; ``quadrature`` integrates the light of each of up to 1024 elements over
        its area, footprints and spots.

    >>> import phicam
    >>> phicam.model(phicam.Scene("bench"), elements=(4, 4))
    Model(256 pixels, 16 elements, 120 spots of 'bench')
    """
    return _of_scene(scene_at(scene), kernel, pair(elements, "elements"), occlusion, integration)


def model_of(
    camera_side: ArrayLike,
    laser_side: ArrayLike | None = None,
    elements: tuple[int, int] | None = None,
) -> Model:
    """The model Φ = C · diag(x) · D of matrices that were measured or computed elsewhere.

    Parameters
    ----------
    camera_side : array, pixels × elements
        C.
    laser_side : array, elements × spots, optional
        D; one column of ones unless given: a single photograph Φ = C · x.
    elements : (int, int), optional
        How the elements lie, along u and v; needed by methods that compare neighbours.

    >>> import phicam, numpy
    >>> phicam.model_of(numpy.eye(3))
    Model(3 pixels, 3 elements, 1 spots)
    """
    camera = matrix(camera_side, "camera_side")
    count = camera.shape[1]
    laser = np.ones((count, 1)) if laser_side is None else matrix(laser_side, "laser_side")
    native = _native.Model.of_sides(camera, laser, pair(elements, "elements") or (count, 1))
    return Model(native, (camera, None if laser_side is None else laser, elements))
