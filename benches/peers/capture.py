"""mitransient's integrator for light around a corner, set up so that it measures phicam's Φcam.

What is mitransient's own: `transient_nlos_path` with laser sampling and hidden-geometry sampling, `nlos_capture_meter`,
`transient_hdr_film` with one time bin. What is added here, as subclasses, costs no time that the original would not take:

  sensor      the capture grid covers the camera's view, not all of the relay wall; within a pixel the point is drawn uniformly
              (the original measures the centres of the pixels only); a ray weighs A_footprint · A_lens · cos²θ / d², the étendue that
              it stands for
  exhaustive  the laser's points are the scene's spots; the original lights a regular grid of them

A projector of intensity c deposits the flux c cosθ / r² per unit area and solid angle of the reflected light; a laser beam of power P
deposits P whatever the angle. So spot l is scaled by P r² / (c cosθ). c is read off the emitter: nothing is fitted.
"""

import drjit as dr
import mitransient.nlos
import mitsuba as mi
import numpy as np
from mitransient.integrators.transientnlospath import CaptureType, TransientNLOSPath
from mitransient.sensors.nloscapturemeter import NLOSCaptureMeter


class FootprintMeter(NLOSCaptureMeter):
    """`nlos_capture_meter` on the part of the relay wall that the camera sees."""

    scene = None  # the exported program, set before the plugin is made

    def __init__(self, props):
        super().__init__(props)
        s = self.scene
        self.corner, self.u, self.v = (mi.Vector3f(x.tolist()) for x in view(s))
        self.eye = mi.Vector3f(s.place(s.PINHOLE).tolist())
        self.axis = mi.Vector3f(list(s.VIEW["normal"]))
        footprint = np.linalg.norm(np.cross(s.VIEW["u"], s.VIEW["v"])) / (s.COLUMNS * s.ROWS)
        # Φ = A_footprint A_lens cos²θ L / d²; in Mitsuba's coordinates d is SCALE times and L SCALE⁻² times what it is in the scene's.
        self.areas = float(footprint * s.APERTURE_AREA * s.SCALE**4)

    def _sample_direction(self, time, sample, active):
        line = self.corner + self.u * sample.x + self.v * sample.y - self.eye
        distance = dr.norm(line)
        return distance, line / distance

    def sample_ray_differential(self, time, sample1, sample2, sample3, active=True):
        ray, _ = self.sample_ray(time, sample1, sample2, sample3, active)
        distance, direction = self._sample_direction(time, sample2, active)
        return ray, mi.Spectrum(self.areas * dr.square(dr.dot(direction, self.axis) / distance))


class ExhaustivePath(TransientNLOSPath):
    """`transient_nlos_path` that connects each point of the hidden surface to every spot of the scene."""

    scene = None

    def prepare(self, scene, sensor, seed, spp, aovs):
        samplers = super().prepare(scene, sensor, seed, spp, aovs)
        if self.capture_type == CaptureType.Exhaustive:
            points = np.array([self.scene.place(point(spot)) for spot in self.scene.SPOTS], dtype=np.float32).T
            self.laser_targets = mi.Point3f(*(mi.Float(x) for x in points))
        return samplers


def point(spot):
    """Centre of an ideal spot; the peers are run with these only."""
    ((kind, centre, *_),) = spot
    assert kind == "point", "mitransient's laser lights points"
    return np.array(centre)


def relay(scene):
    return scene.SURFACES[0]


def view(scene):
    corner, u, v = (np.array(scene.VIEW[k]) for k in ("corner", "u", "v"))
    return scene.place(corner), u * scene.SCALE, v * scene.SCALE


class Capture:
    """Φcam by mitransient: one render per spot, or all spots in one."""

    def __init__(self, scene, sampler, exhaustive):
        self.scene, self.sampler, self.exhaustive = scene, sampler, exhaustive
        FootprintMeter.scene = ExhaustivePath.scene = scene
        mi.register_sensor("footprint_meter", lambda props: FootprintMeter(props))
        mi.register_integrator("exhaustive_path", lambda props: ExhaustivePath(props))
        self.integrator = mi.load_dict({
            "type": "exhaustive_path",
            "capture_type": "Exhaustive" if exhaustive else "Single",
            "force_equal_illumination_scanning": False,
            "illumination_scan_fov": 1.0,
            "nlos_laser_sampling": True,
            "nlos_hidden_geometry_sampling": True,
            "nlos_hidden_geometry_sampling_includes_relay_wall": False,
            "account_first_and_last_bounces": False,
            "temporal_filter": "box",
            "max_depth": scene.MAX_BOUNCES,
            "rr_depth": 1_000_000,
        })
        self.world = mi.load_dict(self._world())
        self.wall = next(s for s in self.world.shapes() if s.is_sensor())
        self.weights = [self._weight(spot) for spot in scene.SPOTS]

    def _world(self):
        s = self.scene
        film = {
            "type": "transient_hdr_film",
            "width": s.COLUMNS,
            "height": s.ROWS,
            "temporal_bins": 1,
            "start_opl": 0.0,
            "bin_width_opl": 1e9,
            "rfilter": {"type": "box"},
        }
        if self.exhaustive:
            film |= {"exhaustive_scan": True, "laser_scan_width": len(s.SPOTS), "laser_scan_height": 1}
        wall = s.surface(relay(s)) | {
            "sensor": {
                "type": "footprint_meter",
                "sensor_origin": s.place(s.PINHOLE).tolist(),
                "sampler": {"type": self.sampler, "sample_count": 1},
                "film": film,
            }
        }
        laser = {
            "type": "projector",
            "irradiance": 1.0,
            "fov": 1.0,
            "to_world": mi.ScalarTransform4f().look_at(
                origin=s.place(s.PINHOLE).tolist(), target=s.place(point(s.SPOTS[0])).tolist(), up=[0, 1, 0]
            ),
        }
        hidden = {f"hidden{i}": s.surface(x) for i, x in enumerate(s.SURFACES[1:])}
        return {"type": "scene", "wall": wall, "laser": laser} | hidden

    def _weight(self, spot):
        """P r² / (c cosθ) in Mitsuba's coordinates."""
        s = self.scene
        line = s.place(s.PINHOLE) - s.place(point(spot))
        r = np.linalg.norm(line)
        self._focus(spot)
        si = dr.zeros(mi.SurfaceInteraction3f)
        si.p = mi.Point3f(s.place(point(spot)).tolist())
        _, received = self.world.emitters()[0].sample_direction(si, mi.Point2f(0.5, 0.5))
        return s.POWER * r / (float(np.array(received[0])[0]) * (line @ np.array(spot[0][2])))

    def _focus(self, spot):
        target = mi.Point3f(self.scene.place(point(spot)).tolist())
        mitransient.nlos.focus_emitter_at_relay_wall_3dpoint(target, self.wall, self.world.emitters()[0])

    def _image(self, samples, seed):
        _, image = self.integrator.render(self.world, seed=seed, spp=samples)
        return np.array(image, dtype=np.float64)

    def render(self, samples, seed):
        """Φcam with `samples` a pixel (and a spot, where every spot is a render of its own)."""
        s = self.scene
        pixels = s.COLUMNS * s.ROWS
        if self.exhaustive:
            flux = self._image(samples, seed)[:, :, 0, :, 0, 0].reshape(pixels, -1)
        else:
            columns = []
            for l, spot in enumerate(s.SPOTS):
                self._focus(spot)
                columns.append(self._image(samples, seed * len(s.SPOTS) + l)[:, :, 0, 0].reshape(pixels))
            flux = np.stack(columns, axis=1)
        return flux * np.array(self.weights)
