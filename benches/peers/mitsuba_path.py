"""Mitsuba 3's `path` integrator, one render per spot, on the program that `phicam scene export --mitsuba` writes."""

import drjit as dr
import mitsuba as mi
import numpy as np


class Path:
    """Φcam by Mitsuba: `scene` is the exported program, imported; its own `sample` shoots the rays.

    The spots are one emitter that is moved, so that Mitsuba compiles its kernel once and not a hundred times.
    """

    def __init__(self, scene, sampler):
        self.scene, self.sampler = scene, sampler
        self.integrator = mi.load_dict(
            {"type": "path", "max_depth": scene.MAX_BOUNCES, "rr_depth": 1_000_000, "hide_emitters": True}
        )
        self.world = mi.load_dict(scene.scene(0))
        self.parameters = mi.traverse(self.world)

    def _light(self, spot):
        (lit,) = self.scene.SPOTS[spot]
        self.parameters["lit0.to_world"] = mi.Transform4f(self.scene.emitter(lit, self.scene.POWER)["to_world"])
        self.parameters.update()

    def render(self, samples, seed):
        """Φcam with `samples` a pixel and spot."""
        pixels, spots = self.scene.COLUMNS * self.scene.ROWS, len(self.scene.SPOTS)
        columns = []
        for spot in range(spots):
            self._light(spot)
            sampler = mi.load_dict({"type": self.sampler, "sample_count": samples})
            sampler.set_samples_per_wavefront(samples)
            sampler.seed(seed * spots + spot, pixels * samples)
            pixel = dr.arange(mi.UInt32, pixels * samples) // dr.opaque(mi.UInt32, samples)
            flux = self.scene.sample(self.world, self.integrator, sampler, pixel)
            columns.append(np.array(flux, dtype=np.float64).reshape(pixels, samples).mean(axis=1))
        return np.stack(columns, axis=1)
