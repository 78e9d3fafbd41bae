"""phicam: a physically based renderer for indirect photography, and the laboratory around it.

A laser spot on a matt wall lights a surface that nobody can see; the light comes back to the wall, where a pinhole camera
photographs it. One photograph for each spot, as columns, is the matrix Φcam, pixels × spots, W. Light that meets the hidden
surface once makes it Φcam = C · diag(ρ) · D with the two sides C (pixels × elements) and D (elements × spots) and the
reflectances ρ.

>>> import phicam
>>> scene = phicam.Scene("bench").replace({"camera.pixels": (8, 8), "laser.spots.per_side": 6})
>>> phi = phicam.render(scene, samples=512)
>>> bool(phicam.validate(phi))
True
>>> phicam.recover(phi, method="joint", elements=(2, 2)).picture().round(1).tolist()
[[0.0, 1.0], [1.0, 0.0]]

The names follow the crate's, whose documentation has the physics. The method is that of S. S. Ferrel, *Matrix determination
of reflectance of hidden object by indirect photography*, M.S. thesis, Air Force Institute of Technology.
"""

from ._exposure import Photographs, expose, sensors
from ._finding import Finding
from ._geometry import Calibration, Location, calibrate, locate
from ._model import Model, model, model_of
from ._native import __version__
from ._phi import Phi, load, render
from ._photographs import import_photographs
from ._published import Reproduction, published, reproduce
from ._recovery import Recovery, Surface, methods, recover
from ._scene import Scene, scenes
from ._study import Study, options, studies, study
from ._target import target, targets
from ._verdict import Verdict, validate
from .errors import Error, FileError, InputError, InternalError, SceneError, Stopped, Suspicious

__all__ = [
    "Calibration",
    "Error",
    "FileError",
    "Finding",
    "InputError",
    "InternalError",
    "Location",
    "Model",
    "Phi",
    "Photographs",
    "Recovery",
    "Reproduction",
    "Scene",
    "SceneError",
    "Stopped",
    "Study",
    "Surface",
    "Suspicious",
    "Verdict",
    "__version__",
    "calibrate",
    "expose",
    "import_photographs",
    "load",
    "locate",
    "methods",
    "model",
    "model_of",
    "options",
    "published",
    "recover",
    "render",
    "reproduce",
    "scenes",
    "sensors",
    "studies",
    "study",
    "target",
    "targets",
    "validate",
]
