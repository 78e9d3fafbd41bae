"""What users write, for the type checkers: nothing of it is run."""

import numpy as np
from numpy.typing import NDArray

import phicam

scene: phicam.Scene = phicam.Scene("bench").replace({"camera.pixels": (8, 8), "laser.power": 2e-3})
phi: phicam.Phi = phicam.render(scene, samples=64, estimator="shared", seed=1, progress=True)
verdict: phicam.Verdict = phicam.validate(phi, phicam.model(scene))
found: phicam.Recovery = phicam.recover(phi, scene, "joint", bands=0.95, elements=(2, 2))
picture: NDArray[np.float64] = found.picture()
own: phicam.Recovery = phicam.recover(np.ones(9), np.eye(9, 4), method=["joint", "nnls"], noise=0.01)
photographs: phicam.Photographs = phicam.expose(phi, "machine-vision", exposure=0.01)
study: phicam.Study = phicam.study("convergence", scene, samples=[64, 256])
calibration: phicam.Calibration = phicam.calibrate(phi, {"hinge.angle": 0.5, "spots.shift": None})
imported: phicam.Phi = phicam.import_photographs({"frames": "*.png"}, scene, folder=".")
slopes: dict[str, NDArray[np.float64]] = phicam.model(scene).derivatives("hinge.angle")
agrees: bool = verdict.agrees and bool(np.isfinite(picture).all())
