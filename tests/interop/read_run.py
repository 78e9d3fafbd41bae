"""Reads the folder of a run with the reference tools: NumPy and the OpenEXR package.

usage: python read_run.py DIR

Checks that every frame has FLOAT channels and its attributes, that the frames stacked are Φcam to f32 rounding, that the
bounce channels add up to the flux, and that the published inversion redone in NumPy uses matrices of the right shapes.
"""

import json
import sys
from pathlib import Path

import numpy as np
import OpenEXR

run = Path(sys.argv[1])
record = json.loads((run / "run.json").read_text())
phi = np.load(run / "phi.npy")
stderr = np.load(run / "phi.stderr.npy")
columns, rows = record["pixels"]
assert phi.dtype == np.float64 and phi.shape == (columns * rows, record["spots"]), phi.shape
assert stderr.shape == phi.shape and np.isfinite(phi).all() and (stderr >= 0).all()

attributes = "scene sceneHash seed samples estimator sampler version spotIndex spotCount spotX spotY spotZ lengthUnit fluxUnit"
for spot in range(record["spots"]):
    file = OpenEXR.File(str(run / "frames" / f"spot-{spot:04}.exr"), separate_channels=True)
    header, channels = file.header(), file.channels()
    for name in attributes.split():
        assert f"phicam.{name}" in header, f"spot {spot}: no attribute {name}"
    assert header["phicam.spotIndex"] == spot
    assert int(header["phicam.seed"], 16) == record["seed"]
    for name, channel in channels.items():
        assert channel.pixels.dtype == np.float32, f"{name} is {channel.pixels.dtype}"
        assert channel.pixels.shape == (rows, columns)
    flux = channels["flux"].pixels.reshape(-1)
    assert np.array_equal(flux, phi[:, spot].astype(np.float32)), f"spot {spot} is not its column of phi.npy"
    bounces = sum(c.pixels.astype(float) for n, c in channels.items() if n.startswith("flux.b"))
    assert np.allclose(bounces.reshape(-1), phi[:, spot], rtol=1e-6, atol=0)

print(f"{record['spots']} frames of {columns} × {rows} pixels: FLOAT channels, all attributes, equal to phi.npy")
if (run / "model").is_dir():
    g12, g23 = np.load(run / "model/g12.npy"), np.load(run / "model/g23.npy")
    assert g12.shape[0] == g23.shape[1] and g12.shape[1] == phi.shape[1] and g23.shape[0] == phi.shape[0]
    image = (phi @ np.linalg.pinv(g12) / g23).mean(axis=0)
    print(f"published inversion: {image.size} elements, from {image.min():.3g} to {image.max():.3g} (no scale)")
