"""A render of Mitsuba 3 held against phicam's model: needs `pip install mitsuba`."""

import mitsuba
import numpy

import phicam

mitsuba.set_variant("llvm_ad_rgb")
scene = phicam.Scene("bench").replace({"laser.spots.per_side": 2, "camera.pixels": (8, 8)})
peer = scene.mitsuba()
columns = [peer.render(spot, 1 << 18, 1, 3) for spot in range(len(scene.spots))]
flux, stderr = (numpy.stack(part, axis=1) for part in zip(*columns))
verdict = phicam.validate(flux, scene, stderr=stderr)
print(verdict)
assert verdict.agrees
assert not phicam.validate(flux, scene.displaced({"hinge.angle": 1.0}), stderr=stderr).agrees
mitsuba.load_dict(scene.to_mitsuba(spot=3))
